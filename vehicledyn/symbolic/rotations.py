"""Rotations and the axes of the program.

Right-handed axes, x forward, y to the left, z up (ISO 8855). ``turn(axis, angle)`` is the
matrix R with v_parent = R v_child when the child frame is turned by ``angle`` about the axis
of the parent; the book writes its transpose.
"""

from __future__ import annotations

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Mat, Scalar, Vec


def turn(axis: int, angle: Scalar) -> Mat:
    """Return the rotation matrix about axis 1, 2 or 3 by an angle [rad]."""
    return turn_by(axis, ops.cos(angle), ops.sin(angle))


def turn_by(axis: int, c: Scalar, s: Scalar) -> Mat:
    """Return the rotation matrix about axis 1, 2 or 3 from cosine and sine of the angle."""
    rows = {
        1: [[1, 0, 0], [0, c, -s], [0, s, c]],
        2: [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        3: [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }[axis]
    return matrix(rows)


def matrix(rows: list[list[Scalar]]) -> Mat:
    """Return the SX matrix with these rows."""
    import casadi

    return casadi.SX(casadi.vertcat(*[casadi.horzcat(*[casadi.SX(x) for x in r]) for r in rows]))


def identity() -> Mat:
    """Return the matrix that turns nothing."""
    import casadi

    return casadi.SX.eye(3)


def axis_vector(axis: int) -> Vec:
    """Return the unit column along axis 1, 2 or 3."""
    return ops.vector(*[1.0 if k == axis else 0.0 for k in (1, 2, 3)])


def yaw_pitch_roll(rotation: Mat) -> tuple[Scalar, Scalar, Scalar]:
    """Return yaw, pitch and roll [rad] of R = Rz(yaw) Ry(pitch) Rx(roll), ISO 8855.

    Singular at a pitch of ±π/2.
    """
    yaw = ops.atan2(rotation[1, 0], rotation[0, 0])
    pitch = ops.atan2(-rotation[2, 0], ops.smooth_norm(rotation[2, 1], rotation[2, 2], 0.0))
    roll = ops.atan2(rotation[2, 1], rotation[2, 2])
    return yaw, pitch, roll
