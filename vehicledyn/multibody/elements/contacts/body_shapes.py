"""Shapes of bodies that touch: planes, capsules (balls are short ones) and convex polygons.

A capsule is what a ball covers that moves from one point to another. It touches a plane with its
lower end, another capsule and a polygon at the closest points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.elements.contacts.touch import Placing, Touch
from vehicledyn.multibody.model.declaration import ORIGIN, choice, number, vector
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.labels import unlabelled
from vehicledyn.symbolic.ops import Scalar, Vec

_TINY = 1e-18
"""Keeps roots and divisions away from zero [m²]."""
_FAR = 1e9
"""Beyond every side of a polygon [m or m²]."""


@dataclass(frozen=True)
class FlatPlane:
    """A plane of a body, with what is behind it solid."""

    point: Sequence[Scalar] = vector("m", "A point of it, in the axes of the body", default=ORIGIN)
    normal: Sequence[Scalar] = vector(
        "1", "Normal away from the body, of any length", default=(0.0, 0.0, 1.0)
    )


@dataclass(frozen=True)
class Capsule:
    """A ball, or what it covers on its way from one point of a body to another."""

    radius: Scalar = number("m", "Radius", above=0.0)
    centre: Sequence[Scalar] = vector("m", "Centre, in the axes of the body", default=ORIGIN)
    far_centre: Sequence[Scalar] | None = vector("m", "Centre at its other end", default=None)


@dataclass(frozen=True)
class Polygon:
    """A convex polygon across an axis of a body, as deep as wanted; or a cage of that shape."""

    first: tuple[float, ...] = choice(
        "Corners along the axis that follows the one it is across (z of axis 2)", unit="m"
    )
    second: tuple[float, ...] = choice("The same corners along the axis after that", unit="m")
    axis: Literal[1, 2, 3] = choice("Axis that it is across", default=2)
    encloses: bool = choice("Whether the other body is inside, as in a cage", default=False)

    def __post_init__(self) -> None:
        """Refuse what is no convex polygon.

        Raises
        ------
        InputError
            If it has too few corners or turns both ways.
        """
        if len(self.first) != len(self.second) or len(self.first) < 3:
            counts = f"{len(self.first)} and {len(self.second)}"
            raise InputError(f"polygon: {counts} corners; give as many, three or more")
        sides = list(zip(self.corners, (*self.corners[1:], self.corners[0]), strict=True))
        ways = [(b[0] - a[0], b[1] - a[1]) for a, b in sides]
        turns = [p[0] * q[1] - p[1] * q[0] for p, q in zip(ways, (*ways[1:], ways[0]), strict=True)]
        if min(turns) <= 0.0:
            raise InputError(
                "polygon: not convex, or not counterclockwise; change the order of the corners, or "
                "take several polygons"
            )

    @property
    def corners(self) -> list[tuple[float, float]]:
        """Corners across the axis [m]."""
        return list(zip(self.first, self.second, strict=True))


def on_plane(
    placing: Placing, body: str, plane: FlatPlane, ends: Sequence[Vec], radius: Scalar
) -> Touch:
    """Return where a capsule with these ends, in world axes, is closest to a plane."""
    normal = unlabelled(placing.rotation(body)) @ rotations.direction(plane.normal)
    point = unlabelled(placing.position(body, plane.point))
    heights = [ops.dot(normal, end - point) for end in ends]
    centre, height = ends[0], heights[0]
    for end, other in zip(ends[1:], heights[1:], strict=True):
        lower = other < height
        centre = ops.vector(*(ops.where(lower, end[k], centre[k]) for k in range(3)))
        height = ops.minimum(height, other)
    return Touch(height - radius, normal, centre - radius * normal)


def of_capsules(
    first: Sequence[Vec], first_radius: Scalar, second: Sequence[Vec], radius: Scalar
) -> Touch:
    """Return where two capsules with these ends, in world axes, are closest."""
    p, q = _closest(first, second)
    away = q - p
    distance = ops.sqrt(ops.dot(away, away) + _TINY)
    normal = away / distance
    return Touch(distance - first_radius - radius, normal, q - radius * normal)


def on_polygon(placing: Placing, body: str, polygon: Polygon, centre: Vec, radius: Scalar) -> Touch:
    """Return where a ball is closest to a polygon, or to the walls of a cage."""
    turn = unlabelled(placing.rotation(body))
    local = turn.T @ (centre - unlabelled(placing.position(body)))
    first, second = polygon.axis % 3, (polygon.axis + 1) % 3
    x, y = local[first], local[second]
    nearest: list[Scalar] = [ops.scalar(_FAR), x, y]
    inside: Scalar = ops.scalar(-_FAR)
    for a, b in zip(polygon.corners, (*polygon.corners[1:], polygon.corners[0]), strict=True):
        side = (b[0] - a[0], b[1] - a[1])
        length = math.hypot(*side)
        outwards = ((x - a[0]) * side[1] - (y - a[1]) * side[0]) / length
        inside = ops.maximum(inside, outwards)
        share = ((x - a[0]) * side[0] + (y - a[1]) * side[1]) / length**2
        share = ops.minimum(ops.maximum(share, 0.0), 1.0)
        on_side = (a[0] + share * side[0], a[1] + share * side[1])
        squared = (x - on_side[0]) ** 2 + (y - on_side[1]) ** 2
        is_nearer = squared < nearest[0]
        pairs = zip((squared, *on_side), nearest, strict=True)
        nearest = [ops.where(is_nearer, new, old) for new, old in pairs]
    place = (x, y, local[polygon.axis - 1])
    return _from_wall(polygon, place, nearest, (inside, radius), (turn, placing, body))


def _from_wall(
    polygon: Polygon,
    place: tuple[Scalar, Scalar, Scalar],
    nearest: Sequence[Scalar],
    apart: tuple[Scalar, Scalar],
    frame: tuple[Vec, Placing, str],
) -> Touch:
    """Return the touch of a ball with the nearest point of the walls."""
    x, y, depth = place
    inside, radius = apart
    turn, placing, body = frame
    sign = ops.where(inside > 0.0, 1.0, -1.0)
    distance = ops.sqrt(nearest[0] + _TINY)
    solid = -1.0 if polygon.encloses else 1.0
    gap = solid * sign * distance - radius
    way = (solid * sign * (x - nearest[1]) / distance, solid * sign * (y - nearest[2]) / distance)
    normal = turn @ _lifted(polygon.axis, way[0], way[1], 0.0)
    at = turn @ _lifted(polygon.axis, nearest[1], nearest[2], depth)
    return Touch(gap, normal, unlabelled(placing.position(body)) + at)


def _lifted(axis: int, x: Scalar, y: Scalar, depth: Scalar) -> Vec:
    """Return the vector with parts in the plane across an axis, and along it."""
    parts: list[Scalar] = [0.0, 0.0, 0.0]
    parts[axis % 3], parts[(axis + 1) % 3], parts[axis - 1] = x, y, depth
    return ops.vector(*parts)


def _closest(first: Sequence[Vec], second: Sequence[Vec]) -> tuple[Vec, Vec]:
    """Return the closest points of two segments, or of points where only one end is given.

    Ericson (2005), Real-Time Collision Detection, section 5.1.9.
    """
    if len(first) == 1 and len(second) == 1:
        return first[0], second[0]
    if len(first) == 1:
        return first[0], _on_segment(second, first[0])
    if len(second) == 1:
        return _on_segment(first, second[0]), second[0]
    d, e, r = first[1] - first[0], second[1] - second[0], first[0] - second[0]
    a, b, c = ops.dot(d, d), ops.dot(d, e), ops.dot(e, e)
    f, g = ops.dot(d, r), ops.dot(e, r)
    s = _clamped((b * g - c * f) / (a * c - b * b + _TINY))
    q = second[0] + _clamped((b * s + g) / c) * e
    p = _on_segment(first, q)
    return p, q


def _on_segment(ends: Sequence[Vec], point: Vec) -> Vec:
    way = ends[1] - ends[0]
    return ends[0] + _clamped(ops.dot(point - ends[0], way) / ops.dot(way, way)) * way


def _clamped(share: Scalar) -> Scalar:
    return ops.minimum(ops.maximum(share, 0.0), 1.0)
