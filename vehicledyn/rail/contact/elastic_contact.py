"""Elastic contacts of one wheel with its rail, as expressions of the pose of its axle.

The overlap of the undeformed profiles is looked at in places fixed on the wheel
(:mod:`vehicledyn.rail.contact.wheel_grid`). In place k the silhouette of the wheel in the view
along the
rail has a closed form (:mod:`vehicledyn.rail.geometry.contact_geometry`); with the rail's height
below it
and the angle γ between the wheel's normal there and the vertical the normal overlap is p_k, and
each window of the wheel has the sums over its places

    S_0 = Σ p³ dl,    S_1 = Σ p³ l dl,    S_2 = Σ p³ l² dl,    T = Σ p⁴ dl,    p ≥ 0,

l the length along the profile. For the overlap p = δ - B l² of a Hertzian contact

    δ = 9/8 T/S_0,    δ/B = 9 (S_2/S_0 - (S_1/S_0)²),

and the contact lies at S_1/S_0. The same is taken for any other overlap. High powers make that
much of the middle of a contact, as the pressure does, and are smooth: all forces have two
continuous derivatives but for what the grid leaves, and contacts that merge, split or cross from
one window into the next do so gradually.

Axes are those of :mod:`vehicledyn.rail.geometry.contact_geometry`: each wheel is seen from its own
side, x forward, y outwards to the field side, z up, the origin in the middle of the track.

References
----------
Hertz's theory by :mod:`vehicledyn.rail.geometry.hertz`. Compare Kik, Piotrowski (1996) and Ayasse,
Chollet
(2005), named in :mod:`vehicledyn.rail.geometry.elastic_geometry`, which is the second formulation
that this one is tested against.
"""

from __future__ import annotations

import itertools
from collections.abc import Hashable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vehicledyn.rail.contact.elastic_patch import ElasticPatch
from vehicledyn.rail.contact.neighbouring_contacts import neighbours
from vehicledyn.rail.contact.wheel_grid import WheelGrid, wheel_grid
from vehicledyn.rail.geometry.contact_geometry import MountedWheel, Rail
from vehicledyn.rail.geometry.hertz import hertz
from vehicledyn.rail.profiles.profile_pieces import Floats
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable

SUM_FLOOR = 1e-30
"""Added to S_0, so that a lifted wheel has an approach: that of overlaps of a nanometre [m⁴]."""

SPREAD_FLOOR = 1e-9
"""Added to the variance of l, for contacts narrower than the grid [m²]."""

_RAIL_STEP = 1e-4
_WHEEL_STEP = 2e-4
_STEEPEST = 6.0
_SHORTEST_COSINE = 1e-3


@dataclass(frozen=True)
class Axle:
    """The axle of a wheel, in axes seen from its own side.

    Attributes
    ----------
    lateral, height
        Place of a point of the axle [m]; x is zero there.
    direction
        Unit vector along the axle, outwards.
    offset
        Distance of the wheel's tape circle from that point along the axle [m].
    curvature
        Curvature of the track, positive when it bends to this side; a plain zero where it is
        straight costs nothing [1/m].
    """

    lateral: Scalar
    height: Scalar
    direction: tuple[Scalar, Scalar, Scalar]
    offset: Scalar
    curvature: Scalar = 0.0


@dataclass(frozen=True)
class ElasticContact:
    """A wheel's profile over a rail, ready for expressions; the same for left and right.

    Attributes
    ----------
    grid
        Places on the wheel.
    surface
        Height of the rail over the lateral coordinate from the middle of the track.
    place, height
        Lateral coordinate and height on the wheel's profile over the length along it.
    tip
        Lateral coordinate of the highest place of the flange on the profile [m].
    last
        Largest lateral coordinate of the profile [m].
    gauge_face
        Where the surface of the rail begins, from the middle of the track [m].
    functions
        Functions of its forces, by what they were built for; equal wheels share them.
    """

    grid: WheelGrid
    surface: CurveTable
    place: CurveTable
    height: CurveTable
    tip: float
    last: float
    gauge_face: float
    functions: dict[Hashable, Any] = field(default_factory=dict, compare=False, repr=False)

    @staticmethod
    def of(wheel: MountedWheel, rail: Rail, attack: float = 0.0) -> ElasticContact:
        """Return the contact of a wheel and its rail, with windows up to an angle of attack [rad].

        Raises
        ------
        InputError
            If the wheel is above its rail at no lateral shift.
        """
        grid = wheel_grid(wheel, rail, attack)
        places, heights = wheel.scan[0], wheel.scan[1]
        surface, begin = _surface(rail)
        place, height = _profile(wheel, grid)
        return ElasticContact(
            grid, surface, place, height, float(places[np.argmax(heights)]), float(places[-1]),
            begin,
        )  # fmt: skip

    def patches(self, axle: Axle, radius: Scalar, modulus: Scalar) -> tuple[ElasticPatch, ...]:
        """Return the contact of each window, from the flange to the field side.

        Parameters
        ----------
        axle
            Where the axle is; displacements of the rail are taken off its centre.
        radius
            Rolling radius of the tape circle [m].
        modulus
            E* of both bodies [N/m²].
        """
        outline = _Outline.of(axle, radius)
        overlaps = _with_middles([self._overlap(outline, k) for k in range(len(self.grid.place))])
        found = [
            self._patch(outline, overlaps, share, float(middle), modulus)
            for share, middle in zip(self.grid.shares, self.grid.middles, strict=True)
        ]
        return neighbours(found, modulus)

    def _overlap(self, outline: _Outline, k: int) -> Scalar:
        """Return the normal overlap p of one place, negative where there is none [m]."""
        grid = self.grid
        slope = float(grid.slope[k])
        point = outline.point(float(grid.place[k]), float(grid.height[k]), slope)
        stretch = float(np.hypot(1.0, slope))
        upwards = (slope * outline.direction[2] - point.down) * (1.0 / stretch)
        return (self.surface.value(point.y) - point.z) * upwards

    def _patch(
        self,
        outline: _Outline,
        positive: list[Scalar],
        share: Floats,
        middle: float,
        modulus: Scalar,
    ) -> ElasticPatch:
        s0: Scalar = SUM_FLOOR
        s1: Scalar = 0.0
        s2: Scalar = 0.0
        s3: Scalar = 0.0
        for k in np.flatnonzero(share):
            p = positive[k]
            length = float(self.grid.along[k]) - middle
            part = p * p * p * float(share[k] * self.grid.width[k])
            s0, s3 = s0 + part, s3 + part * p
            lever = part * length
            s1, s2 = s1 + lever, s2 + lever * length
        mean = s1 / s0
        approach = 1.125 * s3 / s0
        spread = 9.0 * (s2 / s0 - mean * mean + SPREAD_FLOOR)
        return self._at(outline, mean + middle, approach, spread, modulus)

    def _at(
        self, outline: _Outline, along: Scalar, approach: Scalar, spread: Scalar, modulus: Scalar
    ) -> ElasticPatch:
        """Return the contact at a length along the profile, with the square δ/B of its width."""
        place, height = self.place.value(along), self.height.value(along)
        point = outline.point(place, height, self.height.slope(along) / self.place.slope(along))
        radius = outline.radius + height
        rise = self.surface.slope(point.y)
        cosine = 1.0 / ops.sqrt(1.0 + rise * rise)
        sine = rise * cosine
        return ElasticPatch(
            place,
            along,
            outline.ahead + point.x,
            point.y,
            point.z,
            radius,
            outline.heading + outline.curvature * point.x,
            (cosine, sine),
            (-sine, cosine),
            approach,
            spread,
            hertz(0.5 * cosine / radius, approach / spread, modulus),
        )


@dataclass(frozen=True)
class _Point:
    """A point of the silhouette, and the z component of the radius's direction to it.

    x counts from beside the tape circle, to first order in the slope of the axle.
    """

    x: Scalar
    y: Scalar
    z: Scalar
    down: Scalar


@dataclass(frozen=True)
class _Outline:
    """The silhouette of a wheel along the rail, as a function of the place on its profile.

    With e the direction of the axle, t along the rail, T = √(1 - e_x²) and g = e_x/T, a point of
    the silhouette lies at c + a e + R (cos β d + sin β b), d = e × t/T, b = (t - e_x e)/T, where
    sin β = z' g for a profile of slope z': there the wheel's normal has no part along the rail.

    On a curve t turns with κ x. Axes are laid along the rail beside the tape circle, at x =
    ``ahead``; from there on x = a e_x + R sin β, which makes sin β = z' g (1 + κ a)/(1 - z' κ R).
    """

    lateral: Scalar
    height: Scalar
    direction: tuple[Scalar, Scalar, Scalar]
    below: tuple[Scalar, Scalar]
    skew: Scalar
    radius: Scalar
    ahead: Scalar
    heading: Scalar
    curvature: Scalar

    @staticmethod
    def of(axle: Axle, radius: Scalar) -> _Outline:
        (ex, ey, ez), bend = axle.direction, axle.curvature
        ahead = axle.offset * ex
        lateral = axle.lateral + axle.offset * ey
        heading = bend * ahead
        if not _is_zero(bend):
            lateral = lateral - 0.5 * heading * ahead
            ex, ey = ex + heading * ey, ey - heading * ex
        square = ey * ey + ez * ez
        root = 1.0 / ops.sqrt(square)
        return _Outline(
            lateral,
            axle.height + axle.offset * ez,
            (ex, ey, ez),
            (ez * root, -ey * root),
            ex * ex / square,
            radius,
            ahead,
            heading,
            bend,
        )

    def point(self, place: Scalar, height: Scalar, slope: Scalar) -> _Point:
        """Return the point of a place with its height and slope on the profile."""
        radius = self.radius + height
        if not _is_zero(self.curvature):
            bend = self.curvature
            slope = slope * (1.0 + bend * place) / (1.0 - slope * bend * radius)
        cosine = ops.sqrt(ops.maximum(1.0 - slope * slope * self.skew, _SHORTEST_COSINE))
        lean = slope * self.skew
        across = cosine * self.below[0] - lean * self.direction[1]
        down = cosine * self.below[1] - lean * self.direction[2]
        x = (place + radius * slope) * self.direction[0]
        y = self.lateral + place * self.direction[1] + radius * across
        z = self.height + place * self.direction[2] + radius * down
        if not _is_zero(self.curvature):
            y = y - 0.5 * self.curvature * x * x
        return _Point(x, y, z, down)


def _is_zero(value: Scalar) -> bool:
    return isinstance(value, int | float) and value == 0.0


def _with_middles(overlaps: list[Scalar]) -> list[Scalar]:
    """Return overlaps and those half way between by cubics through four of them, where positive."""
    found = []
    for k, (p, q) in enumerate(itertools.pairwise(overlaps)):
        before = overlaps[max(k - 1, 0)]
        after = overlaps[min(k + 2, len(overlaps) - 1)]
        found += [p, 0.5625 * (p + q) - 0.0625 * (before + after)]
    return [ops.maximum(p, 0.0) for p in (*found, overlaps[-1])]


def _surface(rail: Rail) -> tuple[CurveTable, float]:
    """Return the height of a rail and where it begins; steep ends go on straight."""
    surface = rail.surface
    count = int(np.floor((surface.end - surface.begin) / _RAIL_STEP))
    y = surface.begin + _RAIL_STEP * np.arange(count + 1.0)
    height, slope, _ = surface.values(y)
    usable = np.flatnonzero(np.abs(slope) <= _STEEPEST)
    first, last = int(usable[0]), int(usable[-1])
    table = CurveTable.through(
        f"rail {rail.profile.name}", float(y[first]), _RAIL_STEP, height[first : last + 1]
    )
    return table, float(y[first])


def _profile(wheel: MountedWheel, grid: WheelGrid) -> tuple[CurveTable, CurveTable]:
    """Return lateral coordinate and height of a profile over the length along the grid."""
    count = int(np.ceil(grid.along[-1] / _WHEEL_STEP))
    step = float(grid.along[-1]) / count
    fine = np.linspace(grid.place[0], grid.place[-1], 40 * count + 1)
    height, _, _ = wheel.table.values(fine)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fine), np.diff(height)))])
    place = np.interp(step * np.arange(count + 1), along, fine)
    name = f"wheel {wheel.profile.name}"
    return (
        CurveTable.through(f"{name} place", 0.0, step, place),
        CurveTable.through(f"{name} height", 0.0, step, wheel.table.height(place)),
    )
