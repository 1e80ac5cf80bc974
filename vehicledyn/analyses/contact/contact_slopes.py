"""Derivatives of contact geometry by shift, gauge, inclination and the measures of a wheelset.

On each side the gap is zero and the outline of the wheel is as steep as the rail: two equations
E(u, p) = 0 a side for the places of contact, roll and height. So du/dp = -E_u⁻¹ E_p, and what is
seen moves by Q_u du/dp + Q_p. Both profiles are known with slope and second derivative, through
which steps into the complex plane differentiate all of these; a rail that leans more turns about
the axis of its profile, while crown and gauge face keep their places.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyses.contact.contact_conicity import differences_at
from vehicledyn.base.errors import InputError
from vehicledyn.rail.geometry.conicity import RadiusDifference, conicity_slope, equivalent_conicity
from vehicledyn.rail.geometry.contact_geometry import (
    GapMinima,
    MountedWheel,
    Pose,
    Rail,
    outward_slope,
    silhouette,
)
from vehicledyn.rail.geometry.rail_rates import rail_rates
from vehicledyn.rail.geometry.wheelset_geometry import (
    WheelsetOnTrack,
    WheelsetPosition,
    stand,
    stand_level,
)
from vehicledyn.rail.profiles.profile_pieces import Floats

PARAMETERS = {
    "shift": ("m", "Lateral shift of the wheelset, to the left"),
    "yaw": ("rad", "Yaw of the wheelset"),
    "curvature": ("1/m", "Curvature of the track, positive to the left"),
    "gauge": ("m", "Gauge"),
    "gauge_depth": ("m", "Depth below the top of the rails at which the gauge is measured"),
    "inclination": ("rad", "Inclination of the rails"),
    "back_to_back": ("m", "Distance of the backs of the flanges"),
    "flange_back": ("m", "Distance of the tape circle from the back of the flange"),
    "left_radius": ("m", "Radius of the tape circle of the left wheel"),
    "right_radius": ("m", "Radius of the tape circle of the right wheel"),
}
"""What derivatives are by, with units and meanings."""

SEEN = {
    "radius_difference": ("m", "Rolling radius of the left contact less that of the right"),
    "roll": ("rad", "Roll, positive where the left side is up"),
    "height": ("m", "Height of the middle of the axle over the tops of the rails"),
    **{
        f"{side}.{name}": (unit, f"{text} of the {side} wheel")
        for side in ("left", "right")
        for name, unit, text in (
            ("place", "m", "Place of contact on the profile"),
            ("radius", "m", "Rolling radius"),
            ("angle", "rad", "Contact angle, of the rail, rising outwards"),
        )
    },
}
"""Quantities of a wheelset that stands, with units and meanings."""

_ASIDE = 1e-40
_SIDES = "left", "right"
_NEAR = 1e-7
"""Gap of a second contact at which it as good as bears, so that nothing follows smoothly [m]."""

_BESIDE, _LEAP, _LISTED = 1e-3, 2e-4, 6
"""Shifts beside an amplitude that count, and how far a contact jumps beyond its own rate [m]."""


@dataclass(frozen=True)
class ContactSlopes:
    """A wheelset on its track; ``gauge_depth`` is where its gauge is measured [m]."""

    wheelset: WheelsetOnTrack
    gauge_depth: float
    yaw: float = 0.0

    def at(self, shift: float) -> tuple[Floats, Floats, str]:
        """Return the quantities of :data:`SEEN` at a shift [m], their derivatives, and trouble.

        Shapes (n_seen,) and (n_seen, n_parameters); the trouble is why derivatives do not exist.

        Raises
        ------
        InputError
            If the wheelset does not stand there.
        """
        standing = stand(self.wheelset, shift, self.yaw)
        values, slopes = self._differentiated(standing, level=False)
        return values, slopes, self._corner(standing)

    def conicity(self, amplitude: float, radius: float, base: float) -> tuple[float, Floats, str]:
        """Return the equivalent conicity of an amplitude [m], its derivatives, and trouble.

        Derivatives have the shape (n_parameters,); ``radius`` is that of rolling in the middle,
        ``base`` the distance of the contacts [m].

        Raises
        ------
        InputError
            If there is no motion of this amplitude.
        """

        def is_enough(table: RadiusDifference) -> bool:
            room = min(table.middle - table.shift[0], table.shift[-1] - table.middle)
            return bool(room >= 2.0 * amplitude)

        table = differences_at(self.wheelset, self.yaw, amplitude, stand_level, is_enough)
        found = equivalent_conicity(table, np.array([amplitude]), radius=radius, base=base)
        value = float(found[0])
        if not np.isfinite(value):
            raise InputError(f"there is no motion of an amplitude of {1e3 * amplitude:g} mm")
        inside = np.abs(table.shift - table.middle) <= 2.0 * amplitude + _BESIDE
        row, column = list(SEEN).index("radius_difference"), list(PARAMETERS).index("shift")
        places = [list(SEEN).index(f"{side}.place") for side in _SIDES]
        slopes, touched, rates = [], [], []
        for shift in table.shift[inside]:
            standing = stand_level(self.wheelset, float(shift), self.yaw)
            seen, moved = self._differentiated(standing, level=True)
            slopes.append(moved[row])
            touched.append(seen[places])
            rates.append(moved[places, column])
        near = np.abs(table.shift[inside] - table.middle) <= amplitude + _BESIDE
        trouble = _jumps(table.shift[inside][near], np.array(touched)[near], np.array(rates)[near])
        whole = np.zeros((len(table.shift), len(PARAMETERS)))
        whole[inside] = slopes
        whole[:, column] = 0.0
        return value, conicity_slope(table, whole, amplitude) + 0.0, trouble

    def _corner(self, standing: WheelsetPosition) -> str:
        """Return why nothing follows smoothly where a wheelset stands."""
        for side in _SIDES:
            touch: GapMinima = getattr(standing, side)
            if len(touch.gap) > 1 and touch.gap[1] - touch.gap[0] < _NEAR:
                return f"the {side} wheel touches at two places, between which contact jumps"
            if touch.edge[0]:
                return f"the {side} contact lies where a profile ends"
        return ""

    def _differentiated(self, standing: WheelsetPosition, *, level: bool) -> tuple[Floats, Floats]:
        """Return what is seen and its derivatives; a ``level`` wheelset is kept from rolling."""
        unknowns = ["place_left", "place_right"]
        unknowns += ["height_left", "height_right"] if level else ["roll", "height"]
        columns = [self._moved(standing, {name: _ASIDE}) for name in (*unknowns, *PARAMETERS)]
        jacobian = np.array([rows for rows, _ in columns]).imag.T / _ASIDE
        seen = np.array([values for _, values in columns]).imag.T / _ASIDE
        n = len(unknowns)
        follow = -np.linalg.solve(jacobian[:, :n], jacobian[:, n:])
        value = np.array(self._moved(standing, {})[1]).real
        return value, np.asarray(seen[:, n:] + seen[:, :n] @ follow)

    def _moved(
        self, standing: WheelsetPosition, change: Mapping[str, float]
    ) -> tuple[list[complex], list[complex]]:
        """Return the equations of both sides and what is seen, with a step into the plane."""
        aside = {name: 1j * size for name, size in change.items()}
        get = aside.get
        equations: list[complex] = []
        sides = []
        for side, sign in zip(_SIDES, (1.0, -1.0), strict=True):
            numbers: list[Any] = [
                sign * (standing.lateral + get("shift", 0.0)),
                standing.height + get("height", 0.0) + get(f"height_{side}", 0.0),
                sign * (standing.roll + get("roll", 0.0)),
                sign * (standing.yaw + get("yaw", 0.0)),
                sign * (self.wheelset.curvature + get("curvature", 0.0)),
            ]
            pose = Pose(*numbers)
            place, radius, angle, rows = self._side(standing, side, pose, aside)
            equations += rows
            sides.append((place, radius, angle))
        difference = sides[0][1] - sides[1][1]
        roll, height = standing.roll + get("roll", 0.0), standing.height + get("height", 0.0)
        return equations, [difference, roll, height, *sides[0], *sides[1]]

    def _side(
        self, standing: WheelsetPosition, side: str, pose: Pose, aside: Mapping[str, complex]
    ) -> tuple[complex, complex, complex, list[complex]]:
        """Return place, rolling radius and contact angle of a side, and its two equations."""
        wheel: MountedWheel = getattr(self.wheelset, f"{side}_wheel")
        rail: Rail = getattr(self.wheelset, f"{side}_rail")
        touch: GapMinima = getattr(standing, side)
        moved = aside.get(f"place_{side}", 0.0)
        z, slope, bend = (row[0] for row in wheel.table.values(touch.place[:1]))
        place, height, steep = touch.place[0] + moved, z + slope * moved, slope + bend * moved
        out = 0.5 * aside.get("back_to_back", 0.0) + aside.get("flange_back", 0.0)
        wider = aside.get(f"{side}_radius", 0.0)
        seen = silhouette(
            wheel, pose, np.array([place + out]), np.array([height + wider]), np.array([steep])
        )
        y = seen.y[0]
        r, r_slope, r_bend = (row[0] for row in rail.surface.values(np.array([y.real])))
        beside = 1j * np.imag(y)
        level, rise = r + r_slope * beside, r_slope + r_bend * beside
        given = {n: aside[n] for n in ("gauge", "gauge_depth", "inclination") if n in aside}
        if given:
            rates = rail_rates(rail, self.gauge_depth, float(y.real))
            for name, size in given.items():
                up, turn = rates[name]
                level, rise = level + up * size, rise + turn * size
        outline = outward_slope(seen, pose, np.array([steep]))[0]
        rows = [seen.z[0] - level, outline - rise]
        return place, wheel.radius + wider + height, np.arctan(rise), rows


def _jumps(shifts: Floats, places: Floats, rates: Floats) -> str:
    """Return where contacts jump between shifts, from places (n, 2) and how fast these move."""
    expected = 0.5 * np.diff(shifts)[:, None] * (rates[1:] + rates[:-1])
    leaps = np.abs(np.diff(places, axis=0) - expected)
    where = np.flatnonzero((leaps > 0.25 * np.abs(expected) + _LEAP).any(axis=1))
    if not where.size:
        return ""
    listed = ", ".join(f"{1e3 * shifts[k]:.4g}" for k in where[:_LISTED])
    return (
        f"contact jumps near shifts of {listed} mm, so that the table of rolling radii behind the "
        "conicity has no derivative there"
    )
