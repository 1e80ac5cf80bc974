"""Rows of the constraints that are no cuts, in absolute coordinates; second derivatives by hand."""

from functools import singledispatch

import numpy as np

from vehicledyn.multibody.elements.knife_edge import KnifeEdge
from vehicledyn.multibody.elements.rolling import RollingWheel
from vehicledyn.multibody.elements.transmissions import Transmission
from vehicledyn.multibody.model.constraints import LinearConstraint, RateConstraint, UserConstraint
from vehicledyn.symbolic import ops


class Rows:
    """Adds rows to a system in absolute coordinates, at a time."""

    def __init__(self, absolute, time):
        self.absolute, self.time = absolute, time

    def number(self, expression):
        return float(self.absolute.values(ops.scalar(expression))[0, 0])

    def frame(self, body):
        return self.absolute.frames[self.absolute.of_body[body]]

    def point(self, body, place):
        """Position, velocity and acceleration without that of the frame, of a point."""
        frame = self.frame(body)
        arm, position, velocity = frame.at(np.array(place))
        return position, velocity, np.cross(frame.w, np.cross(frame.w, arm)), arm

    def point_row(self, body, arm, direction):
        """Row of direction · (a + α × arm)."""
        return {self.absolute.of_body[body]: np.r_[direction, np.cross(arm, direction)]}

    def joint_row(self, name):
        """Row and its right side for the acceleration of a coordinate: row · acc = q̈ + rest."""
        e, below, above, is_rotation = self.absolute.axis[name]
        if is_rotation:
            turn = np.r_[np.zeros(3), e]
            return {above: turn, below: -turn}, 0.0
        p, c = self.absolute.frames[below], self.absolute.frames[above]
        arm = c.r - p.r
        swirl = np.cross(p.w, np.cross(p.w, arm)) + 2.0 * np.cross(p.w, e * self.rate(name))
        return {above: np.r_[e, np.zeros(3)], below: np.r_[-e, -np.cross(arm, e)]}, e @ swirl

    def coordinate(self, name):
        return self.absolute.q[name]

    def rate(self, name):
        return self.absolute.qd[name]

    def add(self, tag, right, *weighted):
        """Add Σ weight · row; ``right`` is what it is equal to."""
        total = {}
        for weight, row in weighted:
            for frame, entries in row.items():
                total[frame] = total.get(frame, np.zeros(6)) + weight * entries
        # The ground is frame 0 and does not move.
        self.absolute._append(total, right, tag)


@singledispatch
def add_rows(constraint, rows):
    """Add the rows of a constraint; their tags are the names of the multipliers' channels."""
    raise NotImplementedError(type(constraint))


@add_rows.register
def _(constraint: LinearConstraint, rows: Rows):
    right, weighted = 0.0, []
    for name, factor in constraint.terms:
        row, rest = rows.joint_row(name)
        size = rows.number(factor)
        weighted.append((size, row))
        right += size * rest
    word = "torque" if constraint.force_unit == "N*m" else "force"
    rows.add(f"{constraint.name}.{word}", right, *weighted)


@add_rows.register
def _(constraint: Transmission, rows: Rows):
    add_rows(constraint.relation, rows)


@add_rows.register
def _(constraint: RollingWheel, rows: Rows):
    """The material point at the lowest place has no velocity: v + ω × (c + ρ) = 0."""
    frame = rows.frame(constraint.body)
    radius, crown = rows.number(constraint.radius), rows.number(constraint.crown)
    e, up = frame.turn[:, constraint.axis - 1], np.array([0.0, 0.0, 1.0])
    moving = np.cross(frame.w, e)
    flat = np.sqrt(1.0 - e[2] ** 2)
    down = (e[2] * e - up) / flat
    falling = (moving[2] * e + e[2] * moving) / flat + down * e[2] * moving[2] / flat**2
    arm = radius * down - crown * up
    _, _, swirl, centre = rows.point(constraint.body, constraint.centre)
    rest = swirl + np.cross(frame.w, radius * falling)
    left = np.array([e[0], e[1], 0.0]) / np.hypot(e[0], e[1])
    along = np.array([left[1], -left[0], 0.0])
    for word, d in (("normal", up), ("longitudinal", along), ("lateral", left)):
        row = rows.point_row(constraint.body, centre + arm, d)
        rows.add(f"{constraint.name}.{word}_force", -d @ rest, (1.0, row))


@add_rows.register(UserConstraint)
@add_rows.register(RateConstraint)
@add_rows.register(KnifeEdge)
def _(constraint, rows):
    BY_HAND[constraint.name](f"{constraint.name}.multiplier", rows)


def distance(tag, rows, ends, scale, second):
    """d²/dt² of d·d/scale is -second, d between a point of one body and one of another."""
    (near, a), (far, b) = ends
    x, v, s, arm_a = rows.point(near, a)
    y, w, r, arm_b = rows.point(far, b)
    d, dv = x - y, v - w
    right = -second - 2.0 / scale * (dv @ dv + d @ (s - r))
    rows.add(
        tag,
        right,
        (2.0 / scale, rows.point_row(near, arm_a, d)),
        (-2.0 / scale, rows.point_row(far, arm_b, d)),
    )


def no_side_slip(tag, rows, body, place, across):
    """A direction d fixed in a body: d · v = 0, so d · a = -(ω × d) · v."""
    _, v, swirl, arm = rows.point(body, place)
    d, w = rows.frame(body).turn @ np.array(across), rows.frame(body).w
    rows.add(tag, -np.cross(w, d) @ v - d @ swirl, (1.0, rows.point_row(body, arm, d)))


def string_of(ends, scale_of, second):
    def add(tag, rows):
        distance(tag, rows, ends, scale_of(rows), second(rows.time))

    return add


def on_surface(tag, rows):
    p, v, swirl, arm = rows.point("upper", (0.3, -0.1, 0.2))
    wave = 2.0 * p[0] + 0.3
    slope = np.array([-0.4 * np.cos(wave) * p[1], -0.2 * np.sin(wave) - 2.0 * p[1], 1.0])
    bend = 0.8 * np.sin(wave) * p[1] * v[0] ** 2 - 0.8 * np.cos(wave) * v[0] * v[1]
    bend += -2.0 * v[1] ** 2 + 0.1 * np.sin(rows.time)
    rows.add(tag, -slope @ swirl - bend, (1.0, rows.point_row("upper", arm, slope)))


def rate_law(tag, rows):
    """(2 + cos t) v_x + 0.4 q̇ = 0.2 sin p + 0.1 t."""
    t, x = rows.time, np.array([1.0, 0.0, 0.0])
    _, v, swirl, arm = rows.point("lower", (0.3, -0.1, 0.2))
    row, rest = rows.joint_row("upper.q0")
    lead, angle = 2.0 + np.cos(t), rows.coordinate("other.q1")
    right = np.sin(t) * v[0] - lead * swirl[0] + 0.4 * rest + 0.1
    right += 0.2 * np.cos(angle) * rows.rate("other.q1")
    rows.add(tag, right, (lead, rows.point_row("lower", arm, x)), (0.4, row))


def slow(tag, rows):
    """(1 + 0.2 cos 2t) v_z + 0.3 q̇ = 0.1 sin t."""
    t, z = rows.time, np.array([0.0, 0.0, 1.0])
    _, v, swirl, arm = rows.point("fork", (0.2, 0.0, 0.1))
    row, rest = rows.joint_row("plate.pitch")
    lead = 1.0 + 0.2 * np.cos(2.0 * t)
    right = 0.4 * np.sin(2.0 * t) * v[2] - lead * swirl[2] + 0.3 * rest + 0.1 * np.cos(t)
    rows.add(tag, right, (lead, rows.point_row("fork", arm, z)), (0.3, row))


def cam(tag, rows):
    """The slide follows 0.2 + 0.1 sin d cos c, with d the drum's angle + 0.4, c the crank's."""
    d, c = rows.coordinate("drum.angle") + 0.4, rows.coordinate("crank.angle")
    dd, cd = rows.rate("drum.angle"), rows.rate("crank.angle")
    weights = {
        "lever.slide": 1.0,
        "drum.angle": -0.1 * np.cos(d) * np.cos(c),
        "crank.angle": 0.1 * np.sin(d) * np.sin(c),
    }
    bend = np.sin(d) * np.cos(c) * (dd * dd + cd * cd) + 2.0 * np.cos(d) * np.sin(c) * dd * cd
    found = {name: rows.joint_row(name) for name in weights}
    right = sum(weights[n] * rest for n, (_, rest) in found.items()) - 0.1 * bend
    rows.add(tag, right, *((weights[n], row) for n, (row, _) in found.items()))


def planets(tag, rows):
    weights = {"sun.q0": 1.0, "arm.q0": -3.1, "ring.q0": 2.1}
    rows.add(tag, 0.0, *((w, rows.joint_row(n)[0]) for n, w in weights.items()))


BY_HAND = {
    "string": string_of(
        (("lower", (0.2, 0.1, -0.1)), ("other", (-0.1, 0.3, 0.2))),
        lambda rows: 1.0,
        lambda t: 0.9 * np.sin(3.0 * t),
    ),
    "cable": string_of(
        (("lever", (0.2, 0.1, 0.0)), ("arm", (0.0, 0.3, 0.2))),
        lambda rows: 2.0 * rows.number(parameter(rows, "rope")),
        lambda t: 0.18 * np.sin(3.0 * t),
    ),
    "surface": on_surface,
    "skate": lambda tag, rows: no_side_slip(tag, rows, "other", (0.3, -0.1, 0.2), SKATE),
    "law": rate_law,
    "slow": slow,
    "cam": cam,
    "planets": planets,
    "edge": lambda tag, rows: no_side_slip(tag, rows, "base", (-0.6, 0.0, 0.0), (0.0, 0.6, 0.8)),
    "trail": lambda tag, rows: no_side_slip(tag, rows, "trailer", (-0.8, 0.0, 0.1), (0, 1, 0)),
}
SKATE = (0.48, 0.6, 0.64)


def parameter(rows, name):
    return next(e.symbol for e in rows.absolute.system.table.entries if e.name == name)
