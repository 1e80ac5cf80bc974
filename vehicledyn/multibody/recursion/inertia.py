"""Mass, first moment and inertia matrix of a link, and how they add up along the tree."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.multibody.model.bodies import Body
from vehicledyn.multibody.recursion.body_inertia import BodyInertia, BodyMotion
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_FULL = 6
CYCLES = ((0, 1, 2), (1, 2, 0), (2, 0, 1))


@dataclass(frozen=True)
class Inertia(BodyInertia):
    """Rigid-body inertia about a frame's origin, in that frame's axes.

    ``mass`` [kg], ``moment`` = mass times the position of the centre of mass [kg m],
    ``matrix`` about the origin, 3 by 3 [kg m²]. ``thin`` is the axis, 0 to 2, along which the
    body is known to have no extent, if any.
    """

    mass: Scalar
    moment: Vec
    matrix: Mat
    thin: int | None = None

    def __add__(self, other: Inertia) -> Inertia:
        """Return the inertia of both together."""
        return Inertia(
            self.mass + other.mass, self.moment + other.moment, self.matrix + other.matrix
        )

    def in_parent(self, turns: Sequence[Mat], arm: Vec) -> Inertia:
        """Return it in a parent frame: turned by each rotation, origin displaced by ``arm``."""
        moment, matrix = self.moment, self.matrix
        for turn in turns:
            moment, matrix = turn @ moment, rotations.congruent(turn, matrix)
        matrix = matrix + _shifted(self.mass, moment, arm)
        return Inertia(self.mass, moment + self.mass * arm, matrix)

    def inertial_wrench(self, motion: BodyMotion) -> tuple[Vec, Vec]:
        """Return m a + β s and I α + ω × I ω + s × a, s the first moment [N, N m]."""
        force = torque = ops.vector(0.0, 0.0, 0.0)
        if not ops.is_structurally_zero(self.mass):
            force = self.mass * motion.acceleration
        if not ops.is_structurally_zero(self.matrix):
            torque = self._spin_torque(motion)
        if not ops.is_structurally_zero(self.moment):
            force = force + motion.beta @ self.moment
            torque = torque + ops.cross(self.moment, motion.acceleration)
        return force, torque

    def mass_blocks(self) -> tuple[Mat, Mat, Mat]:
        """Return m 1, -tilde(s) and I, s the first moment."""
        return self.mass * rotations.identity(), -ops.tilde(self.moment), self.matrix

    def _spin_torque(self, motion: BodyMotion) -> Vec:
        """Return I α + ω × I ω [N m] of the inertia matrix I.

        With P = ½ tr(I) 1 - I, the integral of x xᵀ dm, it is the axial vector of β P - (β P)ᵀ,
        cheaper where β is needed anyway.
        """
        matrix = self.matrix
        if rotations.is_diagonal(matrix) and ops.is_structurally_zero(self.moment):
            omega, alpha = motion.angular_velocity, motion.angular_acceleration
            return ops.vector(
                *(
                    matrix[i, i] * alpha[i] + (matrix[k, k] - matrix[j, j]) * (omega[j] * omega[k])
                    for i, j, k in CYCLES
                )
            )
        beta, spread = motion.beta, self.spread()
        return ops.vector(
            *(
                beta[k, j] * spread[j]
                - beta[j, k] * spread[k]
                + (beta[j, j] - beta[k, k]) * matrix[j, k]
                + (beta[j, i] * matrix[k, i] - beta[k, i] * matrix[i, j])
                for i, j, k in CYCLES
            )
        )

    def spread(self) -> list[Scalar]:
        """Return the integrals of x² dm, y² dm and z² dm about the origin [kg m²]."""
        m = self.matrix
        return [
            ops.scalar(0.0) if i == self.thin else 0.5 * (m[j, j] + m[k, k] - m[i, i])
            for i, j, k in CYCLES
        ]


def rigid(items: Sequence[BodyInertia]) -> list[Inertia]:
    """Return inertias that are all those of rigid bodies."""
    found = [item for item in items if isinstance(item, Inertia)]
    if len(found) != len(items):
        raise ValueError("this recursion is for rigid bodies only")
    return found


def nothing() -> Inertia:
    """Return the inertia of a massless frame, structurally zero."""
    zero = ops.vector(0.0, 0.0, 0.0)
    return Inertia(ops.scalar(0.0), zero, ops.tilde(zero))


def of_body(body: Body | None) -> Inertia:
    """Return the inertia of a body about the origin of its own axes."""
    if body is None or body.mass is None:
        return nothing()
    com = ops.vector(*body.com)
    nowhere = ops.vector(0.0, 0.0, 0.0)
    matrix = matrix_of(body.inertia) + _shifted(body.mass, nowhere, com)
    return Inertia(ops.scalar(body.mass), body.mass * com, matrix)


def _shifted(mass: Scalar, moment: Vec, arm: Vec) -> Mat:
    """Return what an inertia matrix gains when its reference moves away by ``-arm`` [kg m²].

    With s = 2 moment + mass · arm the gain is (arm · s) 1 - (arm sᵀ + s armᵀ) / 2, which is
    Steiner's term for a first moment of zero.
    """
    s = 2.0 * moment + mass * arm
    if arm.is_zero() or s.is_zero():
        return ops.tilde(ops.vector(0.0, 0.0, 0.0))
    xx, yy, zz = (arm[k] * s[k] for k in range(3))
    xy, xz, yz = (-0.5 * (arm[i] * s[j] + arm[j] * s[i]) for i, j in ((0, 1), (0, 2), (1, 2)))
    return rotations.symmetric((yy + zz, xx + zz, xx + yy), (xy, xz, yz))


def matrix_of(inertia: Sequence[Scalar]) -> Mat:
    """Return the symmetric matrix of Ixx, Iyy, Izz and optionally Ixy, Ixz, Iyz [kg m²]."""
    beside = inertia[3:6] if len(inertia) == _FULL else (0.0, 0.0, 0.0)
    return rotations.symmetric(inertia[:3], beside)
