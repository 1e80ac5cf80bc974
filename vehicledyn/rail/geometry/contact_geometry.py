"""Where rigid wheels touch rails: every contact point of a wheel, at any shift, roll and yaw.

A rail is the same all along the track (on a curve: all along its circle). Whether a wheel
touches it is therefore seen in the view along the rail: the outline of the wheel in that view,
its lower silhouette, against the profile of the rail. The silhouette is the set of points of
the wheel whose normal has no part along the rail; for each lateral place y on the wheel the
angle θ about the axle at which that happens has a closed form, so that the gap

    f(y) = z of the silhouette - z of the rail below it

is a function of one variable, smooth where the profiles are. Contact is where f is smallest;
every local minimum is a place where contact may jump to, and f there says how far it is.

Axes. Each wheel is seen from its own side: x forward, y outwards to the field side, z up, the
origin in the middle of the track at the height of the rails' highest points. The left side is
the track frame (ISO 8855) itself, the right side its mirror image, in which roll, yaw, lateral
shift and the curvature of the track change sign. Yaw turns about z, then roll about x.

References
----------
Wang (1984), The track of wheel contact points and the calculation of wheel/rail geometric contact
parameters: the silhouette, there called the track of contact points, without curves.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.rail.profiles.profile import Profile, tabulated
from vehicledyn.rail.profiles.profile_pieces import Floats, QuinticTable

SCAN_STEP = 1e-4
"""Distance of the places on a wheel at which minima are looked for [m]."""

RAIL_STEP, FACE_STEP = 1e-4, 2e-6
"""Distance of the places of a rail's table, and of those on a steep gauge face [m]."""

_ITERATIONS = 60
_REFINEMENTS = 12
_SLOPE_ACCURACY = 1e-11
_MARGIN = 2e-3


class Pose(NamedTuple):
    """Where the axle of a wheel is, seen from the wheel's own side.

    ``lateral`` and ``height`` are those of the middle of the axle [m], ``roll`` is positive
    when this side goes up, ``yaw`` when it goes back [rad]; ``curvature`` is that of the track,
    positive when it bends to this side [1/m].
    """

    lateral: float
    height: float
    roll: float
    yaw: float
    curvature: float = 0.0

    def mirrored(self) -> Pose:
        """Return the pose as the other side sees it."""
        return Pose(-self.lateral, self.height, -self.roll, -self.yaw, -self.curvature)


@dataclass(frozen=True)
class MountedWheel:
    """A wheel on its axle: profile, radius of the tape circle, its distance from the middle [m]."""

    profile: Profile
    radius: float
    half_distance: float

    @cached_property
    def table(self) -> QuinticTable:
        """The profile as a table, steep ends left out."""
        return self.profile.sampled(SCAN_STEP)

    @cached_property
    def scan(self) -> tuple[Floats, Floats, Floats]:
        """Places on the profile with height and slope there, shape (n,) each."""
        count = int(np.ceil((self.table.end - self.table.begin) / SCAN_STEP)) + 1
        places = np.linspace(self.table.begin, self.table.end, count)
        height, slope, _ = self.table.values(places)
        return places, height, slope


@dataclass(frozen=True)
class Rail:
    """A rail in its place: the surface z(y) that wheels meet, from the middle of the track.

    ``origin`` is where the axis of the profile meets its crown, (y, z) [m]; ``inclination`` the
    angle by which it leans inwards [rad]; ``surface`` its visible upper side.
    """

    profile: Profile
    inclination: float
    origin: tuple[float, float]
    surface: QuinticTable

    def on_profile(self, y: Floats, z: Floats) -> Floats:
        """Return the lateral coordinate on the profile of places on the rail [m]."""
        c, s = np.cos(self.inclination), np.sin(self.inclination)
        return np.asarray(c * (y - self.origin[0]) + s * (z - self.origin[1]))


class Silhouette(NamedTuple):
    """Points of a wheel seen along the rail, shape (n,).

    ``x``, ``y`` and ``z`` are coordinates [m], ``turn`` the angle θ about the axle, positive
    forward of the lowest point [rad].
    """

    x: Floats
    y: Floats
    z: Floats
    turn: Floats


class GapMinima(NamedTuple):
    """Local minima of the gap between one wheel and its rail, by rising gap, shape (n,).

    ``place`` is the lateral coordinate on the wheel, ``gap`` the vertical distance, ``x``, ``y``
    and ``z`` the point on the wheel from the middle of the track [m], ``slope`` dz/dy of
    the rail there; at an ``edge`` the profile of wheel or rail ends.
    """

    place: Floats
    gap: Floats
    x: Floats
    y: Floats
    z: Floats
    slope: Floats
    edge: Floats


def place_rail(profile: Profile, inclination: float, gauge: float, gauge_depth: float) -> Rail:
    """Return a rail leaning inwards, its gauge face at half the gauge from the middle.

    The gauge is measured between the points of the rails nearest to each other within
    ``gauge_depth`` below their highest points.

    Parameters
    ----------
    profile
        Profile of the rail, upright.
    inclination
        Angle by which the rail leans inwards [rad].
    gauge
        Distance of the gauge faces [m].
    gauge_depth
        Depth below the top down to which the gauge is measured [m].
    """
    upright = tabulated(profile.pieces, RAIL_STEP)
    leaning = tabulated((upright,), RAIL_STEP, inclination)
    count = int(np.ceil((leaning.end - leaning.begin) / RAIL_STEP)) + 1
    places = np.linspace(leaning.begin, leaning.end, count)
    top = float(_highest(leaning, places))
    face = gauge_face(leaning, places, top - gauge_depth)
    if face <= leaning.begin:  # the table ends above that depth, where the flank is steep
        face = _steep_face(profile, inclination, top - gauge_depth)
    across = 0.5 * gauge - face
    surface = QuinticTable(
        leaning.places + across,
        leaning.left - np.array([[top], [0.0], [0.0]]),
        leaning.right - np.array([[top], [0.0], [0.0]]),
    )
    return Rail(profile, inclination, (across, -top), surface)


def _highest(surface: QuinticTable, places: Floats) -> float:
    heights = surface.height(places)
    best = int(np.argmax(heights))
    fine = np.linspace(places[max(best - 1, 0)], places[min(best + 1, len(places) - 1)], 401)
    return float(np.max(surface.height(fine)))


def gauge_face(surface: QuinticTable, places: Floats, level: float) -> float:
    """Return the innermost place at or above a level."""
    above = np.flatnonzero(surface.height(places) >= level)
    first = int(above[0])
    if first == 0:
        return float(places[0])
    low, high = places[first - 1], places[first]
    for _ in range(_ITERATIONS):
        middle = 0.5 * (low + high)
        if surface.height(np.array([middle]))[0] >= level:
            high = middle
        else:
            low = middle
    return float(high)


def _steep_face(profile: Profile, inclination: float, level: float) -> float:
    """Return the innermost place at or above a level, from the profile itself as it leans."""
    y = np.linspace(profile.begin, profile.end, int((profile.end - profile.begin) / FACE_STEP) + 2)
    z = profile.height(y)
    c, s = np.cos(inclination), np.sin(inclination)
    across, up = c * y - s * z, s * y + c * z
    first = int(np.argmax(up >= level))
    innermost = float(np.min(across[up >= level]))
    if first == 0:
        return innermost
    crossing = np.interp(level, up[first - 1 : first + 1], across[first - 1 : first + 1])
    return min(innermost, float(crossing))


def silhouette(
    wheel: MountedWheel, pose: Pose, place: Floats, height: Floats, slope: Floats
) -> Silhouette:
    """Return the outline of a wheel in the view along the rail; nan where it has no such point.

    On a curve the rail turns away below the wheel: what is returned as y is the place at which
    the wheel meets the rail's profile, y - κ x²/2, and the normal is square to the rail there. It
    is analytic in all numbers, so that steps into the complex plane differentiate it.

    Parameters
    ----------
    wheel
        The wheel.
    pose
        Place of its axle.
    place, height, slope
        Lateral coordinates on the profile, with z and dz/dy there, shape (n,).
    """
    c_roll, s_roll = np.cos(pose.roll), np.sin(pose.roll)
    c_yaw, s_yaw = np.cos(pose.yaw), np.sin(pose.yaw)
    radius = wheel.radius + height
    axial = wheel.half_distance + place
    x, bend = np.zeros_like(radius), pose.curvature
    for _ in range(1 if bend == 0.0 else 4):
        # Normal sin θ e_x - cos θ e_z - z' e_y of the wheel times the direction (1, κ x, 0).
        along = c_yaw + bend * x * s_yaw
        down = (s_yaw - bend * x * c_yaw) * s_roll
        side = (s_yaw - bend * x * c_yaw) * c_roll
        with np.errstate(invalid="ignore"):
            tilt = np.arcsin(-slope * side / np.sqrt(along * along + down * down))
        turn = tilt + np.arctan(down / along)
        sine, cosine = np.sin(turn), np.cos(turn)
        x = -axial * s_yaw * c_roll + radius * (sine * c_yaw - cosine * s_yaw * s_roll)
    y = pose.lateral + axial * c_yaw * c_roll + radius * (sine * s_yaw + cosine * c_yaw * s_roll)
    z = pose.height + axial * s_roll - radius * cosine * c_roll
    return Silhouette(x, y - 0.5 * bend * x**2, z, turn)


def lowest_gap(wheel: MountedWheel, rail: Rail, pose: Pose) -> tuple[float, float]:
    """Return the lowest gap [m] and its rate with the roll [m/rad].

    The gap is that of a parabola through scanned places, off by less than a nanometre where
    the profiles are smooth: enough to begin with. Both are nan where the wheel is nowhere
    above its rail.
    """
    seen = silhouette(wheel, pose, *wheel_above(wheel, rail, pose))
    gap = _gap(rail, seen)
    if len(gap) == 0 or np.isnan(gap).all():
        return np.nan, np.nan
    k = int(np.nanargmin(gap))
    y, z = float(seen.y[k]), float(seen.z[k])
    steepness = float(rail.surface.values(seen.y[k : k + 1])[1][0])
    rate = roll_rate(pose, y, z, steepness)
    if not 0 < k < len(gap) - 1 or np.isnan(gap[k - 1] + gap[k + 1]):
        return float(gap[k]), rate
    rise, bend = gap[k + 1] - gap[k - 1], gap[k + 1] - 2.0 * gap[k] + gap[k - 1]
    return float(gap[k] - (rise**2 / (8.0 * bend) if bend > 0.0 else 0.0)), rate


def roll_rate(pose: Pose, y: float, z: float, slope: float) -> float:
    """Return the rate of the gap with the roll at a contact (y, z) on a rail of a slope [m/rad].

    Rolling lifts the place by its distance from the middle, and moves it outwards by the height
    of the axle over it, to where the rail is higher by the slope. That the place on the wheel
    changes does not matter: the gap is smallest there.
    """
    return y - pose.lateral - slope * (pose.height - z)


def touching_points(wheel: MountedWheel, rail: Rail, pose: Pose) -> GapMinima:
    """Return all local minima of the gap between a wheel and a rail.

    The gap falls by what the axle is lowered. With the lowest minimum at zero the wheel stands
    on the rail; minima at equal gaps are a contact at two points. A wheel that is nowhere above
    its rail has no minima.
    """
    places, height, slope = wheel_above(wheel, rail, pose)
    gap = _gap(rail, silhouette(wheel, pose, places, height, slope))
    padded = np.concatenate([[np.inf], np.where(np.isnan(gap), np.inf, gap), [np.inf]])
    lower = (padded[1:-1] < padded[:-2]) & (padded[1:-1] <= padded[2:])
    found = np.flatnonzero(lower)
    inner = np.isfinite(padded[found]) & np.isfinite(padded[found + 2])
    refined = np.where(inner, _refined(wheel, rail, pose, places, found), places[found])
    seen = silhouette(wheel, pose, refined, *wheel.table.values(refined)[:2])
    gaps = _gap(rail, seen)
    order = np.argsort(gaps, kind="stable")
    x, y, z = seen.x[order], seen.y[order], seen.z[order]
    rail_slope = rail.surface.values(y)[1]
    return GapMinima(refined[order], gaps[order], x, y, z, rail_slope, ~inner[order])


def wheel_standing(wheel: MountedWheel, rail: Rail, pose: Pose) -> tuple[float, GapMinima]:
    """Return the height at which a wheel of its own stands on its rail, and its contacts.

    Parameters
    ----------
    wheel, rail
        The wheel and its rail.
    pose
        Shift, roll and yaw of its axle; its height is not used.

    Raises
    ------
    InputError
        If the wheel is not above its rail.
    """
    touch = touching_points(wheel, rail, pose)
    if len(touch.gap) == 0:
        raise InputError("the wheel is not above its rail")
    drop = float(touch.gap[0])
    return pose.height - drop, touch._replace(gap=touch.gap - drop, z=touch.z - drop)


def wheel_above(wheel: MountedWheel, rail: Rail, pose: Pose) -> tuple[Floats, Floats, Floats]:
    """Return the scanned part of a wheel that is above its rail, and a margin beside."""
    places, height, slope = wheel.scan
    tilt = abs(pose.roll) + pose.yaw**2 + abs(pose.curvature) * wheel.radius
    margin = _MARGIN + (wheel.radius + abs(pose.height)) * tilt
    outer = wheel.half_distance + pose.lateral
    low, high = rail.surface.begin - outer - margin, rail.surface.end - outer + margin
    part = slice(*np.searchsorted(places, [low, high]))
    return places[part], height[part], slope[part]


def _gap(rail: Rail, seen: Silhouette) -> Floats:
    return np.asarray(seen.z - rail.surface.height(seen.y))


def _refined(
    wheel: MountedWheel, rail: Rail, pose: Pose, places: Floats, found: NDArray[np.intp]
) -> Floats:
    """Return minima between the neighbours of places found, by bisection of the slope of f."""
    low = places[np.maximum(found - 1, 0)].copy()
    high = places[np.minimum(found + 1, len(places) - 1)].copy()
    (below, first), (above, last) = (_steeper(wheel, rail, pose, y) for y in (low, high))
    # At large yaw the outline turns back where the profile is hollow.
    onward = np.sign(last - first)
    below, above = onward * below, onward * above
    middle = 0.5 * (low + high)
    before = np.zeros(len(found), dtype=bool)
    for step in range(_REFINEMENTS):
        if step > 0:
            with np.errstate(invalid="ignore", divide="ignore"):
                middle = low - below * (high - low) / (above - below)
            unsure = ~((middle >= low) & (middle <= high))
            middle = np.where(unsure, 0.5 * (low + high), middle)
        rest = onward * _steeper(wheel, rail, pose, middle)[0]
        if (np.abs(rest) < _SLOPE_ACCURACY).all():
            break
        rising = rest > 0.0
        # Illinois: an end that stays twice is given half its weight, so that both ends move.
        again = (rising == before) if step > 0 else np.zeros_like(rising)
        below = np.where(rising, np.where(again, 0.5 * below, below), rest)
        above = np.where(rising, rest, np.where(again, 0.5 * above, above))
        low, high, before = np.where(rising, low, middle), np.where(rising, middle, high), rising
    return middle


def _steeper(wheel: MountedWheel, rail: Rail, pose: Pose, place: Floats) -> tuple[Floats, Floats]:
    """Return by how much the outline of a wheel is steeper than the rail below [1], and y [m].

    The outline is an envelope, so that its tangent is square to the normal of the wheel and its
    slope -n_y/n_z, without a derivative of θ.
    """
    height, slope, _ = wheel.table.values(place)
    seen = silhouette(wheel, pose, place, height, slope)
    return outward_slope(seen, pose, slope) - rail.surface.values(seen.y)[1], seen.y


def outward_slope(seen: Silhouette, pose: Pose, slope: Floats) -> Floats:
    """Return the slope dz/dy of an outline seen along the rail; ``slope`` is the profile's [1]."""
    c_roll, s_roll = np.cos(pose.roll), np.sin(pose.roll)
    c_yaw, s_yaw = np.cos(pose.yaw), np.sin(pose.yaw)
    sine, cosine = np.sin(seen.turn), np.cos(seen.turn)
    n_y = sine * s_yaw + cosine * c_yaw * s_roll - slope * c_yaw * c_roll
    n_z = -cosine * c_roll - slope * s_roll
    return np.asarray(-n_y / n_z)
