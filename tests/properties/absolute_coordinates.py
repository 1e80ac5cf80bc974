"""A second formulation: six absolute coordinates a frame, every joint a constraint.

Each elementary joint connects two rigid frames (most of them massless). Newton's and Euler's
equations of all frames are solved together with the joints, drives and cuts differentiated
twice; the multipliers are the reactions. Nothing is recursive and all vectors are in world
axes, so this shares neither the recursion nor its frames with the program.
"""

from dataclasses import dataclass, field

import numpy as np

from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.cuts import BallCut, BodyCut, RodCut
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.symbolic import ops


def skew(v):
    return np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])


def rotation(axis, angle):
    c, s = np.cos(angle), np.sin(angle)
    i, j = axis % 3, (axis + 1) % 3
    r = np.eye(3)
    r[i, i] = r[j, j] = c
    r[i, j], r[j, i] = -s, s
    return r


def across(e):
    """Two directions perpendicular to a unit vector."""
    u = np.cross(e, np.eye(3)[np.argmin(np.abs(e))])
    u = u / np.linalg.norm(u)
    return np.array([u, np.cross(e, u)])


@dataclass
class Frame:
    """Position, orientation, velocity and mass of a rigid frame, world axes."""

    r: np.ndarray
    turn: np.ndarray
    v: np.ndarray
    w: np.ndarray
    mass: float = 0.0
    com: np.ndarray = field(default_factory=lambda: np.zeros(3))
    inertia: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))
    force: np.ndarray = field(default_factory=lambda: np.zeros(3))
    torque: np.ndarray = field(default_factory=lambda: np.zeros(3))

    def at(self, point):
        """Arm of a point in world axes, its position and velocity."""
        arm = self.turn @ point
        return arm, self.r + arm, self.v + np.cross(self.w, arm)


class Absolute:
    """A system at given coordinates and rates, as frames and constraint rows.

    ``values`` maps an expression of the parameters to numbers; ``wrenches`` are
    (body, force, torque) in body axes about the body's origin; ``driven`` holds the known
    accelerations of driven coordinates and ``joint_forces`` the forces along coordinates.
    """

    def __init__(self, system, values, q, qd, *, wrenches, driven, joint_forces):
        self.system, self.values, self.q, self.qd = system, values, q, qd
        zero = np.zeros(3)
        self.frames = [Frame(zero, np.eye(3), zero, zero)]
        self.of_body = {GROUND: 0}
        self.rows, self.right, self.tags = [], [], []
        self.axis = {}
        self.gravity = self.vector(system.gravity)
        self.driven = driven
        for body in system.bodies:
            self._add_body(body)
        for body, force, torque in wrenches:
            frame = self.frames[self.of_body[body]]
            frame.force = frame.force + frame.turn @ force
            frame.torque = frame.torque + frame.turn @ torque
        for name, size in joint_forces.items():
            e, below, above, is_rotation = self.axis[name]
            where = "torque" if is_rotation else "force"
            for index, sign in ((above, 1.0), (below, -1.0)):
                frame = self.frames[index]
                setattr(frame, where, getattr(frame, where) + sign * size * e)
            if not is_rotation:
                arm = self.frames[above].r - self.frames[below].r
                self.frames[below].torque = self.frames[below].torque - np.cross(arm, size * e)
        self.cut_rows = len(self.rows)
        for cut in system.cuts:
            self._add_cut(cut)

    def vector(self, items):
        return self.values(ops.vector(*items))[:, 0]

    def _add_body(self, body):
        previous, offset = self.of_body[body.parent], self.vector(body.at)
        for item in body.joints:
            if isinstance(item, Joint):
                previous = self._add_joint(previous, offset, item)
            else:
                previous = self._add_weld(previous, offset, self.values(item.rotation))
            offset = np.zeros(3)
        if not body.joints:
            previous = self._add_weld(previous, offset, np.eye(3))
        self.of_body[body.name] = previous
        if body.mass is not None:
            frame = self.frames[previous]
            frame.mass = float(self.values(ops.scalar(body.mass))[0, 0])
            frame.com = self.vector(body.com)
            six = [float(self.values(ops.scalar(i))[0, 0]) for i in body.inertia]
            xx, yy, zz, xy, xz, yz = (*six, 0.0, 0.0, 0.0)[:6]
            frame.inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def _add_weld(self, parent, offset, turn):
        p = self.frames[parent]
        arm, r, v = p.at(offset)
        self.frames.append(Frame(r, p.turn @ turn, v, p.w))
        child = len(self.frames) - 1
        bias = np.cross(p.w, np.cross(p.w, arm))
        self._position_rows(parent, child, arm, np.eye(3), bias, "weld")
        self._turn_rows(parent, child, np.eye(3), np.zeros(3), "weld")
        return child

    def _add_joint(self, parent, offset, joint):
        p, q, qd = self.frames[parent], self.q[joint.name], self.qd[joint.name]
        axis = joint.type.turns_about or joint.type.slides_along
        e_local = np.eye(3)[axis - 1]
        e = p.turn @ e_local
        child = len(self.frames)
        is_rotation = joint.type.turns_about is not None
        self.axis[joint.name] = (e, parent, child, is_rotation)
        if is_rotation:
            arm, r, v = p.at(offset)
            turn = p.turn @ rotation(axis, q)
            self.frames.append(Frame(r, turn, v, p.w + e * qd))
            bias = np.cross(p.w, np.cross(p.w, arm))
            self._position_rows(parent, child, arm, np.eye(3), bias, "joint")
            self._turn_rows(parent, child, across(e), np.cross(p.w, e * qd), "joint")
            if joint.name in self.driven:
                known = np.cross(p.w, e * qd) + e * self.driven[joint.name]
                self._turn_rows(parent, child, e[None], known, ("drive", joint.name))
        else:
            arm, r, v = p.at(offset + e_local * q)
            self.frames.append(Frame(r, p.turn, v + e * qd, p.w))
            bias = np.cross(p.w, np.cross(p.w, arm)) + 2.0 * np.cross(p.w, e * qd)
            self._position_rows(parent, child, arm, across(e), bias, "joint")
            self._turn_rows(parent, child, np.eye(3), np.zeros(3), "joint")
            if joint.name in self.driven:
                known = bias + e * self.driven[joint.name]
                self._position_rows(parent, child, arm, e[None], known, ("drive", joint.name))
        return child

    def _position_rows(self, parent, child, arm, directions, bias, tag):
        """Rows of d·(a_child - a_parent - α_parent × arm) = d·bias."""
        for d in directions:
            row = {child: np.r_[d, np.zeros(3)], parent: np.r_[-d, -np.cross(arm, d)]}
            self._append(row, d @ bias, tag)

    def _turn_rows(self, parent, child, directions, bias, tag):
        for d in directions:
            row = {child: np.r_[np.zeros(3), d], parent: np.r_[np.zeros(3), -d]}
            self._append(row, d @ bias, tag)

    def _add_cut(self, cut):
        index = [self.of_body[cut.body_a], self.of_body[cut.body_b]]
        frames = [self.frames[k] for k in index]
        ends = [
            f.at(self.vector(p)) for f, p in zip(frames, (cut.point_a, cut.point_b), strict=True)
        ]
        swirl = [np.cross(f.w, np.cross(f.w, end[0])) for f, end in zip(frames, ends, strict=True)]
        if isinstance(cut, RodCut):
            d, dv = ends[1][1] - ends[0][1], ends[1][2] - ends[0][2]
            length = np.linalg.norm(d)
            u = d / length
            bias = -(dv @ dv - (u @ dv) ** 2) / length - u @ (swirl[1] - swirl[0])
            self._point_row(index, ends, u, bias, (cut.name, "axial"))
            return
        assert isinstance(cut, BallCut | BodyCut)
        for k, d in enumerate(np.eye(3)):
            self._point_row(index, ends, d, -d @ (swirl[1] - swirl[0]), (cut.name, f"force{k}"))
        if isinstance(cut, BodyCut):
            for k, d in enumerate(np.eye(3)):
                row = {index[1]: np.r_[np.zeros(3), d]}
                row[index[0]] = row.get(index[0], 0.0) - np.r_[np.zeros(3), d]
                self._append(row, 0.0, (cut.name, f"torque{k}"))

    def _point_row(self, index, ends, direction, bias, tag):
        row = {}
        for k, end, sign in zip(index, ends, (-1.0, 1.0), strict=True):
            part = sign * np.r_[direction, np.cross(end[0], direction)]
            row[k] = row.get(k, np.zeros(6)) + part
        self._append(row, bias, tag)

    def _append(self, row, right, tag):
        full = np.zeros(6 * len(self.frames))
        for frame, entries in row.items():
            full[6 * frame : 6 * frame + 6] = entries
        self.rows.append(full)
        self.right.append(right)
        self.tags.append(tag)

    @property
    def jacobian(self):
        """All constraint rows; the ground is frame 0 and does not move."""
        n = 6 * len(self.frames)
        return np.array([np.r_[row, np.zeros(n - len(row))] for row in self.rows])[:, 6:]

    @property
    def velocities(self):
        return np.concatenate([np.r_[f.v, f.w] for f in self.frames[1:]])

    def solve(self):
        """Accelerations of all frames (rows of a, α) and the multiplier of each row."""
        count = len(self.frames) - 1
        mass, force = np.zeros((6 * count, 6 * count)), np.zeros(6 * count)
        for k, frame in enumerate(self.frames[1:]):
            block = slice(6 * k, 6 * k + 6)
            mass[block, block], force[block] = self._newton_euler(frame)
        j = self.jacobian
        kkt = np.block([[mass, -j.T], [j, np.zeros((len(j), len(j)))]])
        # Least squares of least norm, so that redundant rows are allowed. Rows are of order one.
        unknown = np.linalg.lstsq(kkt, np.r_[force, self.right], rcond=1e-13)[0]
        self.accelerations = unknown[: 6 * count].reshape(count, 6)
        self.multipliers = unknown[6 * count :]
        return self

    def _newton_euler(self, f):
        """Mass block about the frame's origin and the force and torque without constraints."""
        c, i = f.turn @ f.com, f.turn @ f.inertia @ f.turn.T
        s = skew(c)
        block = np.block([[f.mass * np.eye(3), -f.mass * s], [f.mass * s, i - f.mass * s @ s]])
        swirl = f.mass * np.cross(f.w, np.cross(f.w, c))
        weight = f.mass * self.gravity
        force = f.force + weight - swirl
        gyro = np.cross(f.w, i @ f.w) + np.cross(c, swirl)
        return block, np.r_[force, f.torque + np.cross(c, weight) - gyro]

    def acceleration_of(self, name):
        """Acceleration of a joint coordinate."""
        e, below, above, is_rotation = self.axis[name]
        zero = np.zeros(6)
        a = [zero if k == 0 else self.accelerations[k - 1] for k in (below, above)]
        p, c = self.frames[below], self.frames[above]
        if is_rotation:
            return e @ (a[1][3:] - a[0][3:])
        arm = c.r - p.r
        moved = np.cross(a[0][3:], arm) + np.cross(p.w, np.cross(p.w, arm))
        return e @ (a[1][:3] - a[0][:3] - moved)

    def multiplier_of(self, tag):
        """Sum of the multipliers of the rows with a tag (each tag of a cut is one row)."""
        return sum(m for m, t in zip(self.multipliers, self.tags, strict=True) if t == tag)

    def reaction_on(self, body):
        """Force and torque about the origin that the body's last joint passes to it, world."""
        frame = self.of_body[body]
        total = np.zeros(6)
        rows = self.rows[: self.cut_rows]
        for row, multiplier in zip(rows, self.multipliers, strict=False):
            # The rows of a frame's own joint were as long as the frames known then.
            if len(row) == 6 * (frame + 1):
                total += multiplier * row[6 * frame :]
        return total
