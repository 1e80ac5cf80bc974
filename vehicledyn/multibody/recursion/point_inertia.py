"""Inertia of a deformable body whose mass stands at points that depend on the deformation.

Its mass stands at points p_j(q), in the axes of its frame; each accelerates by
a + β p + 2 ω × ṗ + p̈, with the share of every coordinate ∂p/∂q_k. All of it follows from the
kinetic energy of these points, so that momentum and energy are those of the points exactly. What
inertia the body has beyond, such as that of sections about the first axis, adds its own terms.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from vehicledyn.multibody.model.deformation import Flexibility, Slice
from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.link_motion import components
from vehicledyn.multibody.recursion.deformed_inertia import DeformedInertia
from vehicledyn.multibody.recursion.inertia import Inertia
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_NEGLIGIBLE = 1e-12
"""Constant below which an entry is the rounding of orthogonal shapes."""


@dataclass(frozen=True)
class PointInertia(DeformedInertia):
    """Inertia of the points that the mass of a body stands at."""

    @property
    def slices(self) -> list[Slice]:
        """The mass as points."""
        return self.kinematics.slices(self.link)

    @cached_property
    def rigid(self) -> Inertia:
        """Inertia with the deformation frozen."""
        moment, second = _zero(), [[ops.scalar(0.0)] * 3 for _ in range(3)]
        for item in self.slices:
            p = item.position
            moment = moment + item.share * p
            for i in range(3):
                for j in range(i, 3):
                    second[i][j] = second[i][j] + item.share * p[i] * p[j]
        turned = _matrix([item for item in self.slices if item.rotation is not None])
        xx, yy, zz = (self.body.mass * _tidy(second[i][i]) for i in range(3))
        more = self.body.turning.entry
        beside = [
            more(i, j) - self.body.mass * _tidy(second[i][j]) for i, j in ((0, 1), (0, 2), (1, 2))
        ]
        about = [sum_ + more(i, i) for i, sum_ in enumerate((yy + zz, xx + zz, xx + yy))]
        matrix = rotations.symmetric(about, beside)
        if turned is not None:
            matrix = matrix + turned
        return Inertia(ops.scalar(self.body.mass), self.body.mass * _tidied(moment), matrix)

    def unit_wrench(self, k: int) -> JointWrench:
        """Return what the frame must transmit for a unit acceleration of a coordinate."""
        force, torque = _zero(), _zero()
        for item in self.slices:
            if k in item.linear:
                pushed = item.share * item.linear[k]
                force = force + pushed
                torque = torque + ops.cross(item.position, pushed)
        own = ops.vector(*(self.body.turning.entry(i, 3 + k) for i in range(3)))
        for item in self.slices:
            if item.rotation is not None and k in item.angular:
                own = own + item.rotation @ _held(item, item.angular[k])
        mass = self.body.mass
        return JointWrench(mass * _tidied(force), mass * _tidied(torque) + own)

    def entry(self, k: int, other: int) -> Scalar:
        """Return the entry of the mass matrix between two coordinates of the deformation."""
        total = ops.scalar(0.0)
        for item in self.slices:
            if k in item.linear and other in item.linear:
                total = total + item.share * ops.dot(item.linear[k], item.linear[other])
        own = self.body.turning.entry(3 + k, 3 + other)
        for item in self.slices:
            if k in item.angular and other in item.angular:
                held = _held(item, item.angular[other])
                own = own + ops.dot(item.angular[k], held)
        return self.body.mass * _tidy(total) + own

    @cached_property
    def wrench(self) -> tuple[Vec, Vec]:
        """Force and torque about the origin that the motion needs [N, N m]."""
        force, torque = _zero(), _zero()
        for item, pushed in zip(self.slices, self._pushes, strict=True):
            force = force + pushed
            torque = torque + ops.cross(item.position, pushed)
        mass = self.body.mass
        torque = mass * torque + self.turning_torque
        for item, twist in zip(self.slices, self._twists, strict=True):
            if item.rotation is not None and twist is not None:
                torque = torque + item.rotation @ twist
        return mass * force, torque

    def forces(self) -> list[Scalar]:
        """Return the force on each coordinate of the deformation that the motion needs."""
        found = []
        spun = self.spun
        for k, _ in enumerate(self.body.coordinates):
            total = ops.scalar(0.0)
            for item, pushed in zip(self.slices, self._pushes, strict=True):
                if k in item.linear:
                    total = total + ops.dot(item.linear[k], pushed)
            own = self.body.turning.product(3 + k, spun)
            for item, twist in zip(self.slices, self._twists, strict=True):
                if twist is not None and k in item.angular:
                    own = own + ops.dot(item.angular[k], twist)
            found.append(self.body.mass * total + own)
        return found

    @cached_property
    def _twists(self) -> list[Vec | None]:
        """Torque that the own inertia of each slice needs, in its axes; None without any [N m]."""
        k, link = self.kinematics, self.link
        if all(item.rotation is None for item in self.slices):
            return [None] * len(self.slices)
        found: list[Vec | None] = []
        omega, alpha = k.link_angular_velocity(link), k.link_angular_acceleration(link)
        for item, (turning, growth) in zip(self.slices, k.slice_turns(link), strict=True):
            if item.rotation is None:
                found.append(None)
                continue
            carried = item.rotation.T @ omega
            total = carried + turning
            spun = item.rotation.T @ alpha + ops.cross(carried, turning) + growth
            spun = spun + k.accelerated(item.angular, link)
            held = _held(item, total)
            found.append(_held(item, spun) + ops.cross(total, held))
        return found

    @cached_property
    def _pushes(self) -> list[Vec]:
        """Share of the mass times acceleration of each point [m/s²]."""
        k, link = self.kinematics, self.link
        base, beta, omega = k.link_acceleration(link), k.beta(link), k.link_angular_velocity(link)
        found = []
        for item, (moving, growth) in zip(self.slices, k.slice_motions(link), strict=True):
            lift = base + beta @ item.position + 2.0 * ops.cross(omega, moving) + growth
            lift = lift + k.accelerated(item.linear, link)
            found.append(item.share * lift)
        return found


def energies_of_points(
    kinematics: Kinematics, link: int, flexibility: Flexibility, gravity: Vec
) -> tuple[Scalar, Scalar]:
    """Return kinetic energy and potential energy in the gravity field of points [J]."""
    omega, base = kinematics.link_angular_velocity(link), kinematics.link_velocity(link)
    motions = kinematics.slice_motions(link)
    kinetic = height = ops.scalar(0.0)
    for item, (moving, _) in zip(kinematics.slices(link), motions, strict=True):
        velocity = base + ops.cross(omega, item.position) + moving
        kinetic = kinetic + 0.5 * item.share * ops.dot(velocity, velocity)
        where = kinematics.position_in(-1, link, item.position)
        height = height - item.share * ops.dot(gravity, where)
    slices = kinematics.slices(link)
    turns = kinematics.slice_turns(link) if any(s.rotation is not None for s in slices) else []
    turning_energy = ops.scalar(0.0)
    for item, (turning, _) in zip(slices, turns, strict=False):
        if item.rotation is not None:
            total = item.rotation.T @ omega + turning
            turning_energy = turning_energy + 0.5 * ops.dot(total, _held(item, total))
    moving = [*components(omega), *kinematics.amplitude_rates(link)]
    spin = ops.scalar(0.0)
    for row in flexibility.turning.rows:
        spin = spin + 0.5 * moving[row] * flexibility.turning.product(row, moving)
    return flexibility.mass * kinetic + spin + turning_energy, flexibility.mass * height


def _held(item: Slice, turning: Vec) -> Vec:
    """Return the angular momentum of a slice about its own axes, in these."""
    return ops.vector(*(j * turning[k] for k, j in enumerate(item.inertia)))


def _matrix(items: list[Slice]) -> Mat | None:
    """Return the own inertia of slices in the axes of the body; None without any."""
    total: Mat | None = None
    for item in items:
        if item.rotation is not None:
            zero = (0.0, 0.0, 0.0)
            own = rotations.symmetric(list(item.inertia), zero)
            turned = rotations.congruent(item.rotation, own)
            total = turned if total is None else total + turned
    return total


def _zero() -> Vec:
    return ops.vector(0.0, 0.0, 0.0)


def _tidied(vector: Vec) -> Vec:
    return ops.vector(*(_tidy(vector[k]) for k in range(3)))


def _tidy(value: Scalar) -> Scalar:
    """Return a number, zero for one that is but the rounding of orthogonal shapes."""
    if value.is_constant() and abs(float(value)) < _NEGLIGIBLE:
        return ops.scalar(0.0)
    return value
