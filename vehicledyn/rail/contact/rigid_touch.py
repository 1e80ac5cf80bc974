"""Where a rigid wheel may touch its rail, as expressions of its pose and the place of contact.

A wheel is a surface of revolution about the unit axis e of its axle. With f = e × z/|e × z|
forward, k = f × e up and d = sin ψ f - cos ψ k, the point at the place s of its outline and at
the angle ψ about the axle, positive forward of the lowest point, is

    P = o + (b + s) o_s e + R(s) d,    normal  n = d - R'(s) o_s e,

o the middle of the axle, b the distance of the tape circle from it and o_s = ±1 the side, left
positive. Its surface touches the rail, whose height z_r(y) is the same all along the track,
where n has no part along the track, which gives ψ in closed form, where it has no part along the
outline of the rail, and where the gap P_z - z_r(P_y) is zero. On a curve the rail runs along a
circle: at P_x it is κ P_x²/2 further to the left and turned by κ P_x, which shifts ψ a little.
Where twist or irregularities slope the rail, the contact and its normal lean ahead with it; what
that lifts the wheel is of second order in the slope and left out.

Vectors are in the track frame at the middle of the axle, x forward, y to the left, z up (ISO
8855).

References
----------
Simeon, Führer, Rentrop (1991), Introduction to differential-algebraic equations in vehicle system
dynamics, Surveys on Mathematics for Industry 1, 1-37: contact coordinates of a rigid wheelset.
"""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.rail.profiles.outline import Outline, OutlinePoint
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

CORRECTIONS = 2
"""Corrections of ψ for the curvature of the track; each leaves κ R R' of the error, 5 % in the
tightest curve on a steep flange, and the gap feels the square of what is left."""


@dataclass(frozen=True)
class TouchingWheel:
    """A wheel and its rail.

    Attributes
    ----------
    side
        1 for the left, -1 for the right.
    wheel, rail
        Outlines; that of the rail over the lateral place from the middle of the track, outwards,
        with its inclination and height.
    radius
        Rolling radius at the tape circle [m].
    half_distance
        b, of the tape circle from the middle of the axle (or from the origin of the wheel's own
        body), outwards [m].
    """

    side: float
    wheel: Outline
    rail: Outline
    radius: Scalar
    half_distance: Scalar


@dataclass(frozen=True)
class RigidTouch:
    """A point of a wheel that may touch: place, outlines there and what must vanish.

    Attributes
    ----------
    point
        P, in the track frame [m].
    gap
        Vertical distance of P over the rail, zero where they touch [m].
    tangency
        Part of the wheel's normal along the outline of the rail, zero where both are parallel [1].
    rolling_radius
        R(s) [m].
    wheel, rail
        The outlines there.
    normal
        Unit normal of the rail, upwards, in the track frame.
    """

    point: Vec
    gap: Scalar
    tangency: Scalar
    rolling_radius: Scalar
    wheel: OutlinePoint
    rail: OutlinePoint
    normal: Vec

    @property
    def curvatures(self) -> tuple[Scalar, Scalar]:
        """Return half sums of the curvatures along and across the rolling direction [1/m]."""
        slope = self.wheel.slope
        along = 1.0 / (self.rolling_radius * ops.sqrt(1.0 + slope * slope))
        return 0.5 * along, 0.5 * (self.wheel.convexity + self.rail.convexity)


def touch_at(
    item: TouchingWheel,
    centre: Vec,
    axle: Vec,
    place: Scalar,
    *,
    curvature: Scalar = 0.0,
    shift: tuple[Scalar, Scalar] = (0.0, 0.0),
    slopes: tuple[Scalar, Scalar] = (0.0, 0.0),
) -> RigidTouch:
    """Return the point of a wheel at a place of its outline that may touch the rail.

    Parameters
    ----------
    item
        The wheel and its rail.
    centre, axle
        Middle of the axle [m] and the axle's unit axis, to the left, in the track frame.
    place
        s, lateral place on the outline of the wheel from the tape circle, outwards [m].
    curvature
        κ of the track, positive to the left; a plain zero costs nothing [1/m].
    shift
        Displacement of the rail from its design place, to the left and upwards [m].
    slopes
        How far the rail runs to the left and upwards a unit of its length [1].
    """
    outline = item.wheel.at(place)
    radius = item.radius + outline.height
    flat = ops.sqrt(axle[0] * axle[0] + axle[1] * axle[1])
    forward = ops.vector(axle[1] / flat, -axle[0] / flat, 0.0)
    up = ops.cross(forward, axle)
    hub = centre + item.side * (item.half_distance + place) * axle
    slope = item.side * outline.slope
    spoke = _spoke(forward, up, axle, slope=slope, heading=0.0)
    is_curved = not ops.is_structurally_zero(ops.scalar(curvature))
    for _ in range(CORRECTIONS if is_curved else 0):
        heading = curvature * (hub[0] + radius * spoke[0])
        spoke = _spoke(forward, up, axle, slope=slope, heading=heading)
    point, normal = hub + radius * spoke, spoke - slope * axle
    heading = curvature * point[0]
    rail = item.rail.at(item.side * (point[1] - 0.5 * heading * point[0] - shift[0]))
    leaning = item.side * rail.slope
    climb = slopes[1] - leaning * slopes[0]
    upward = ops.vector(leaning * heading - climb, -leaning, 1.0)
    return RigidTouch(
        point=point + ops.vector(radius * climb, 0.0, 0.0),
        gap=point[2] - rail.height - shift[1],
        tangency=item.side * (normal[1] - heading * normal[0]) + rail.slope * normal[2],
        rolling_radius=radius,
        wheel=outline,
        rail=rail,
        normal=upward / ops.norm(upward),
    )


def _spoke(forward: Vec, up: Vec, axle: Vec, *, slope: Scalar, heading: Scalar) -> Vec:
    """Return d where the wheel's normal has no part along the rail, the direction (1, κ x, 0)."""
    along = [vector[0] + heading * vector[1] for vector in (forward, up, axle)]
    sine, cosine = _turn(along[0], along[1], slope * along[2])
    return sine * forward - cosine * up


def _turn(forward: Scalar, up: Scalar, wanted: Scalar) -> tuple[Scalar, Scalar]:
    """Return sin ψ and cos ψ with ``forward`` sin ψ - ``up`` cos ψ = ``wanted``, near ψ = 0."""
    square = forward * forward + up * up
    rest = ops.sqrt(square - wanted * wanted)
    return (
        (wanted * forward + up * rest) / square,
        (forward * rest - wanted * up) / square,
    )
