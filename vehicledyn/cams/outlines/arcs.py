"""Outlines of arcs and straight lines that join with equal tangents."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pydantic import Field, model_validator

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.base.registry import register
from vehicledyn.cams.analytic import cosine, is_stepped, length, real_part, sine
from vehicledyn.cams.follower import PointFollower
from vehicledyn.cams.geometry import turned
from vehicledyn.cams.outline import Array, CamOutline, Reach, Support
from vehicledyn.cams.turns import wrapped
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

_TURN = 2.0 * math.pi
_CLOSED = 1e-7
"""What an outline may be open, over its size."""
_TOUCHES = 1e-9
_FAR = 1e3
"""Beyond every outline [m]."""


@dataclass(frozen=True)
class Edge:
    """An arc about a centre with normals from one angle to another, or a line if straight.

    ``radius`` is negative where the outline is hollow. A line has the normal at the angle
    ``first``, its start at ``centre`` and a ``length``.
    """

    centre: tuple[float, float]
    radius: float
    first: float
    last: float
    length: float = 0.0

    @property
    def is_line(self) -> bool:
        """Whether it is straight."""
        return self.length > 0.0

    def normal(self, angle: float) -> Array:
        """Return a unit vector."""
        return np.array([cosine(angle), sine(angle)])

    def end(self, at: float, offset: float) -> Array:
        """Return its start (0) or end (1), moved out by an offset [m]."""
        if self.is_line:
            along = np.array([-sine(self.first), cosine(self.first)])
            start = np.array(self.centre) + at * self.length * along
            return start + offset * self.normal(self.first)
        angle = self.first if at == 0.0 else self.last
        return np.array(self.centre) + (self.radius + offset) * self.normal(angle)


class Edges(CamOutline):
    """Base of the outlines that consist of arcs and lines."""

    def chain(self) -> tuple[Edge, ...]:
        """Return arcs and lines counterclockwise."""
        raise NotImplementedError

    def support(self, angle: Array) -> Support:
        """Return the touching lines: those of the arc that reaches furthest."""
        c, s = np.cos(angle), np.sin(angle)
        arcs = [e for e in self.chain() if not e.is_line and e.radius.real >= 0.0]
        reach = np.array([e.centre[0] * c + e.centre[1] * s + e.radius for e in arcs])
        size, ends = reach.real, [(e.first.real, e.last.real) for e in arcs]
        inside = np.array([np.mod(angle.real - a, _TURN) <= b - a + 1e-9 for a, b in ends])
        best = np.argmax(np.where(inside, size, size.min() - 1.0), axis=0)
        x, y, r = (np.array([v(e) for e in arcs])[best] for v in (_x, _y, _r))
        return Support(reach[best, np.arange(angle.size)], y * c - x * s, r)

    def reach(self, follower: PointFollower, theta: Array) -> Reach:
        """Return the outermost place where the centre's path meets arcs and lines moved out."""
        if not (is_stepped(self) or is_stepped(follower)):
            return self._outermost(follower, theta)[0]
        best, known = real_part(self)._outermost(real_part(follower), theta)[::-1]
        return self._stepped(follower, theta, known.coordinate, best)

    def _outermost(self, follower: PointFollower, theta: Array) -> tuple[Reach, Array]:
        """Return that place, and the number of its arc or line."""
        found: list[tuple[Array, Array, Array]] = []
        numbers = []
        for number, edge in enumerate(self.chain()):
            for coordinate in self._meetings(edge, follower, theta):
                numbers.append(number)
                normal, curvature, inside = self._at(edge, follower, theta, coordinate)
                found.append((np.where(inside, coordinate, -np.inf), normal, curvature))
        coordinates = np.array([item[0] for item in found])
        best = np.argmax(coordinates, axis=0)
        places = np.arange(theta.size)
        chosen = coordinates[best, places]
        if not np.isfinite(chosen).all():
            at = math.degrees(float(theta[int(np.argmin(chosen))]))
            raise ValueError(
                f"the follower does not reach the outline at {at:.4g} deg of the cam; it is "
                "shorter or longer than its cam allows: change its arm, offset or pivot"
            )
        normals = np.array([item[1] for item in found])[best, :, places].T
        curvature = np.array([item[2] for item in found])[best, places]
        return Reach(chosen, normals, curvature), np.array(numbers)[best]

    def _stepped(
        self, follower: PointFollower, theta: Array, coordinate: Array, best: Array
    ) -> Reach:
        """Return the place near one that is known, with numbers that step into the complex plane.

        Newton's step from a place of the real numbers gives what a small step changes.
        """
        edges = self.chain()
        beside = [_beside(e, follower, theta, coordinate) for e in edges]
        gaps, normals = (np.array([item[k] for item in beside]) for k in (0, 1))
        places = np.arange(theta.size)
        lever = np.sum(
            turned(theta, normals[best, :, places].T) * follower.centre(coordinate).first, axis=0
        )
        moved = coordinate - gaps[best, places] / lever
        normals = np.array([_beside(e, follower, theta, moved)[1] for e in edges])
        bends = [0.0 if e.is_line else 1.0 / (e.radius + follower.roller) for e in edges]
        return Reach(moved, normals[best, :, places].T, np.array(bends)[best])

    def point_gap(self, radius: float, x: Scalar, y: Scalar) -> Scalar:
        """Return the distance from the arc or line in whose sector the centre is."""
        edges = self.chain()
        starts = [math.atan2(*e.end(0.0, radius)[::-1]) for e in edges]
        order = [wrapped(a - starts[0]) for a in starts]
        here = wrapped(ops.atan2(y, x) - starts[0])
        total: Scalar = _distance(edges[0], radius, x, y)
        for edge, begin in zip(edges[1:], order[1:], strict=True):
            total = ops.where(here >= begin, _distance(edge, radius, x, y), total)
        return total

    def line_gap(self, angle: Scalar, distance: Scalar) -> Scalar:
        """Return the distance of the face from the arc that it would touch."""
        arcs = [e for e in self.chain() if not e.is_line and e.radius >= 0.0]
        c, s = ops.cos(angle), ops.sin(angle)
        reaches = [e.centre[0] * c + e.centre[1] * s + e.radius for e in arcs]
        if len(arcs) == 1:
            return distance - reaches[0]
        total: Scalar = ops.scalar(-_FAR)
        for edge, reach in zip(arcs, reaches, strict=True):
            inside = wrapped(angle - edge.first) <= edge.last - edge.first
            total = ops.maximum(total, ops.where(inside, reach, -_FAR))
        return distance - total

    def _meetings(self, edge: Edge, follower: PointFollower, theta: Array) -> list[Array]:
        """Return the coordinates at which the centre is on an arc or line moved out, (n,) each."""
        c, s = np.cos(theta), np.sin(theta)
        offset = edge.radius + follower.roller
        x = c * edge.centre[0] - s * edge.centre[1]
        y = s * edge.centre[0] + c * edge.centre[1]
        if edge.is_line:
            angle = edge.first + theta
            nx, ny = np.cos(angle), np.sin(angle)
            return follower_on_line(follower, nx, ny, nx * x + ny * y + follower.roller)
        return follower_on_circle(follower, x, y, abs(offset))

    def _at(
        self, edge: Edge, follower: PointFollower, theta: Array, coordinate: Array
    ) -> tuple[Array, Array, Array]:
        """Return normal, curvature and whether the place belongs to the arc or line."""
        with np.errstate(invalid="ignore"):
            place = follower.centre(coordinate).place
            c, s = np.cos(theta), np.sin(theta)
            inner = np.array([c * place[0] + s * place[1], c * place[1] - s * place[0]])
            away = inner - np.array(edge.centre)[:, None]
            if edge.is_line:
                normal = np.broadcast_to(edge.normal(edge.first)[:, None], inner.shape)
                along = away[1] * math.cos(edge.first) - away[0] * math.sin(edge.first)
                slack = _TOUCHES * edge.length
                inside = (along >= -slack) & (along <= edge.length + slack)
                return np.array(normal), np.zeros(theta.size), inside & np.isfinite(coordinate)
            offset = edge.radius + follower.roller
            sign = math.copysign(1.0, offset)
            normal = sign * away / np.hypot(*away)
            angle = np.arctan2(normal[1], normal[0])
            low, high = min(edge.first, edge.last), max(edge.first, edge.last)
            inside = np.mod(angle - low + _TOUCHES, _TURN) <= high - low + 2.0 * _TOUCHES
            if edge.radius < 0.0 and offset > 0.0:
                inside &= False
            return normal, np.full(theta.size, 1.0 / offset), inside & np.isfinite(coordinate)


def follower_on_circle(follower: PointFollower, x: Array, y: Array, radius: float) -> list[Array]:
    """Return coordinates at which a centre is on a circle about (x, y) in ground axes."""
    with np.errstate(invalid="ignore", divide="ignore"):
        if not follower.rocks:
            offset = float(follower.centre(np.ones(1)).place[0, 0])
            root = np.sqrt(radius**2 - (offset - x) ** 2)
            return [y + root, y - root]
        d, arm, side = _arm(follower)
        # |pivot + l (-cos ψ, side sin ψ) - centre| = radius
        ax, ay = d - x, -y
        size = np.hypot(ax, ay)
        cosine = (radius**2 - arm**2 - size**2) / (2.0 * arm * size)
        return _angles(np.arctan2(side * ay, -ax), np.arccos(cosine))


def follower_on_line(follower: PointFollower, nx: Array, ny: Array, distance: Array) -> list[Array]:
    """Return coordinates at which a centre is on a line n · p = distance in ground axes."""
    with np.errstate(invalid="ignore", divide="ignore"):
        if not follower.rocks:
            offset = float(follower.centre(np.ones(1)).place[0, 0])
            return [(distance - nx * offset) / ny]
        d, arm, side = _arm(follower)
        cosine = (distance - nx * d) / arm
        return _angles(np.arctan2(side * ny, -nx), np.arccos(cosine))


def _angles(middle: Array, half: Array) -> list[Array]:
    """Return the two angles about a middle, those that no arm has as no numbers."""
    found = (np.mod(middle + half, _TURN), np.mod(middle - half, _TURN))
    return [np.where(angle < math.pi, angle, np.nan) for angle in found]


def _beside(
    edge: Edge, follower: PointFollower, theta: Array, coordinate: Array
) -> tuple[Array, Array]:
    """Return how far a centre is outside an arc or line moved out, and the normal there."""
    inner = turned(-theta, follower.centre(coordinate).place)
    away = inner - np.array(edge.centre)[:, None]
    if edge.is_line:
        normal = np.broadcast_to(edge.normal(edge.first)[:, None], inner.shape)
        return np.sum(normal * away, axis=0) - follower.roller, normal
    offset = edge.radius + follower.roller
    sign, size = math.copysign(1.0, offset.real), length(*away)
    return sign * size - offset, sign * away / size


def _arm(follower: PointFollower) -> tuple[float, float, float]:
    """Return pivot, arm and side of a rocking follower."""
    side = -follower.pressure_sign()
    return float(follower.pivot), float(follower.arm), side  # type: ignore[attr-defined]


def _distance(edge: Edge, radius: float, x: Scalar, y: Scalar) -> Scalar:
    """Return how far a centre is outside an arc or line moved out by a radius [m]."""
    if edge.is_line:
        c, s = math.cos(edge.first), math.sin(edge.first)
        return c * (x - edge.centre[0]) + s * (y - edge.centre[1]) - radius
    offset = edge.radius + radius
    dx, dy = x - edge.centre[0], y - edge.centre[1]
    return math.copysign(1.0, offset) * ops.sqrt(dx * dx + dy * dy) - offset


def _x(edge: Edge) -> float:
    return edge.centre[0]


def _y(edge: Edge) -> float:
    return edge.centre[1]


def _r(edge: Edge) -> float:
    return edge.radius


@register("cam_outline", "eccentric_circle")
class EccentricCircle(Edges):
    """A circle whose centre is beside the axis of the cam."""

    radius: float = quantity("m", "Radius of the circle", gt=0.0)
    eccentricity: float = quantity("m", "Distance of its centre from the axis", gt=0.0)
    direction: float = quantity(
        "rad",
        "Direction of its centre from +X; at -90 deg the follower begins lowest",
        default=-0.5 * math.pi,
    )

    @model_validator(mode="after")
    def _about_axis(self) -> EccentricCircle:
        if self.eccentricity >= self.radius:
            raise ValueError("eccentricity: must be below the radius, so that the axis is inside")
        return self

    def chain(self) -> tuple[Edge, ...]:
        """Return the circle."""
        x = self.eccentricity * cosine(self.direction)
        y = self.eccentricity * sine(self.direction)
        return (Edge((x, y), self.radius, 0.0, _TURN),)


class CircleArc(ParameterSet):
    """An arc of an outline, or with a length a straight line."""

    radius: float | None = quantity("m", "Radius, negative for a hollow arc", default=None)
    turn: float | None = quantity("rad", "Angle that the arc turns by", default=None, gt=0.0)
    length: float | None = quantity("m", "Length of a straight line", default=None, gt=0.0)

    @model_validator(mode="after")
    def _arc_or_line(self) -> CircleArc:
        is_arc = self.radius is not None and self.turn is not None
        if is_arc == (self.length is not None) or (self.radius is None) != (self.turn is None):
            raise ValueError("give radius and turn of an arc, or the length of a straight line")
        if self.radius == 0.0:
            raise ValueError("radius: must not be zero; a corner needs a small radius")
        return self


@register("cam_outline", "arcs")
class Arcs(Edges):
    """Arcs and straight lines one after the other, counterclockwise, with equal tangents."""

    start: tuple[float, float] = quantity("m", "Where the first one starts")
    normal: float = quantity("rad", "Direction of the outward normal there, from +X")
    arcs: list[CircleArc] = Field(description="Arcs and lines, counterclockwise", min_length=1)

    def chain(self) -> tuple[Edge, ...]:
        """Return arcs and lines, in place."""
        return _chained(self.start, self.normal, self.arcs)


def _chained(
    start: tuple[float, float], normal: float, given: Sequence[CircleArc]
) -> tuple[Edge, ...]:
    found, place, angle = [], np.array(start), normal
    for item in given:
        if item.length is not None:
            found.append(Edge((place[0], place[1]), 0.0, angle, angle, item.length))
        else:
            radius, turn = float(item.radius or 0.0), float(item.turn or 0.0)
            last = angle + math.copysign(turn, radius)
            centre = place - radius * np.array([cosine(angle), sine(angle)])
            found.append(Edge((centre[0], centre[1]), radius, angle, last))
            angle = last
        place = found[-1].end(1.0, 0.0)
    _check_closed(start, place, angle - normal, found)
    return tuple(found)


def _check_closed(
    start: tuple[float, float], place: Array, turned_by: float, edges: Sequence[Edge]
) -> None:
    if abs(turned_by - _TURN) > _CLOSED:
        raise ValueError(
            f"the outline does not close: its arcs turn by {math.degrees(turned_by):.8g} deg in "
            "all, make it 360 deg"
        )
    gap = place - np.array(start)
    size = max(float(np.abs(e.end(0.0, 0.0)).max()) for e in edges)
    if float(np.hypot(*gap.real)) > _CLOSED * size:
        raise ValueError(
            f"the outline does not close: it ends ({1e3 * gap[0]:.6g}, {1e3 * gap[1]:.6g}) mm from "
            "its start; change radii, turns or lengths"
        )
