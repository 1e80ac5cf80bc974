"""Rotations and the axes of the program.

Right-handed axes, x forward, y to the left, z up (ISO 8855). ``turn(axis, angle)`` is the
matrix R with v_parent = R v_child when the child frame is turned by ``angle`` about the axis
of the parent; the book writes its transpose.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

from vehicledyn.base.errors import InputError
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
    entries = [x for column in zip(*rows, strict=True) for x in column]
    return ops.filled(len(rows), len(rows[0]), entries)


def symmetric(diagonal: Sequence[Scalar], beside: Sequence[Scalar]) -> Mat:
    """Return the symmetric matrix of the elements xx, yy, zz and xy, xz, yz."""
    (xx, yy, zz), (xy, xz, yz) = diagonal, beside
    return matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def congruent(rotation: Mat, tensor: Mat) -> Mat:
    """Return R T Rᵀ of a symmetric T: its elements in the frame that R leads to.

    Only one triangle is computed, which is why this is not two products; a rotation about an
    axis of the frame costs a fifth.
    """
    axis = elementary_axis(rotation)
    if axis is not None:
        return _turned_about(axis, rotation, tensor)
    half = rotation @ tensor

    def element(i: int, j: int) -> Scalar:
        return ops.dot(half[i, :], rotation[j, :])

    return symmetric(
        [element(k, k) for k in range(3)], [element(0, 1), element(0, 2), element(1, 2)]
    )


def similar(rotation: Mat, tensor: Mat) -> Mat:
    """Return R T Rᵀ of any T: its elements in the frame that R leads to."""
    axis = elementary_axis(rotation)
    return rotation @ tensor @ rotation.T if axis is None else _turned_about(axis, rotation, tensor)


def _turned_about(axis: int, rotation: Mat, tensor: Mat) -> Mat:
    """Return R T Rᵀ of any T, where R turns about axis 1, 2 or 3 alone.

    Trace and skew part of the block across the axis stay, which spares half of its products.
    """
    i, j, k = axis - 1, axis % 3, (axis + 1) % 3
    c, s = rotation[j, j], rotation[k, j]
    tensor = _by_place(tensor)
    difference, both = tensor[j, j] - tensor[k, k], tensor[j, k] + tensor[k, j]
    moved = s * s * difference + c * s * both
    crossed = c * s * difference - s * s * both
    turned = {
        (i, i): tensor[i, i],
        (j, j): tensor[j, j] - moved,
        (k, k): tensor[k, k] + moved,
        (j, k): tensor[j, k] + crossed,
        (k, j): tensor[k, j] + crossed,
        (i, j): c * tensor[i, j] - s * tensor[i, k],
        (i, k): s * tensor[i, j] + c * tensor[i, k],
        (j, i): c * tensor[j, i] - s * tensor[k, i],
        (k, i): s * tensor[j, i] + c * tensor[k, i],
    }
    return matrix([[turned[m, n] for n in range(3)] for m in range(3)])


def elementary_axis(rotation: Mat) -> int | None:
    """Return the axis, 1 to 3, about which a rotation turns whatever its symbols, if any."""
    entry = _by_place(rotation)
    for i in range(3):
        others = [(i, n) for n in range(3) if n != i] + [(n, i) for n in range(3) if n != i]
        if entry[i, i].is_one() and all(entry[pair].is_zero() for pair in others):
            return i + 1
    return None


def _by_place(matrix: Mat) -> dict[tuple[int, int], Scalar]:
    """Return the entries of a matrix of three rows by row and column."""
    return {(k % 3, k // 3): item for k, item in enumerate(ops.entries_of(matrix))}


def is_diagonal(tensor: Mat) -> bool:
    """Return whether a matrix is diagonal whatever the values of its symbols."""
    return all(item.is_zero() for (i, j), item in _by_place(tensor).items() if i != j)


def identity() -> Mat:
    """Return the matrix that turns nothing."""
    import casadi

    return casadi.SX.eye(3)


def product(*factors: Mat | None) -> Mat:
    """Return the product of the matrices that are there."""
    found = identity()
    for factor in factors:
        found = found if factor is None else found @ factor
    return found


def axis_vector(axis: int) -> Vec:
    """Return the unit column along axis 1, 2 or 3."""
    import casadi

    return casadi.SX(_unit(axis))


@cache
def _unit(axis: int) -> Vec:
    return ops.vector(*[1.0 if k == axis else 0.0 for k in (1, 2, 3)])


def columns(first: Vec, second: Vec, third: Vec) -> Mat:
    """Return the matrix with these three columns."""
    return matrix([[first[k], second[k], third[k]] for k in range(3)])


def tait_bryan(rotation: Mat, sequence: tuple[int, int, int]) -> tuple[Scalar, Scalar, Scalar]:
    """Return the angles (a, b, c) of R = turn(i, a) turn(j, b) turn(k, c) [rad].

    Parameters
    ----------
    rotation
        Rotation matrix.
    sequence
        Three different axes (i, j, k). Singular where the second angle is ±π/2.
    """
    i, j, k = (axis - 1 for axis in sequence)
    cyclic = 1.0 if (j - i) % 3 == 1 else -1.0
    first = ops.atan2(-cyclic * rotation[j, k], rotation[k, k])
    third = ops.atan2(-cyclic * rotation[i, j], rotation[i, i])
    across = ops.sqrt(rotation[i, i] * rotation[i, i] + rotation[i, j] * rotation[i, j])
    return first, ops.atan2(cyclic * rotation[i, k], across), third


def yaw_pitch_roll(rotation: Mat) -> tuple[Scalar, Scalar, Scalar]:
    """Return yaw, pitch and roll [rad] of R = Rz(yaw) Ry(pitch) Rx(roll), ISO 8855."""
    return tait_bryan(rotation, (3, 2, 1))


def direction(given: Sequence[Scalar]) -> Vec:
    """Return three numbers or symbols as a column of length one.

    Numbers that have that length already stay as they are.

    Raises
    ------
    InputError
        If all are zero, which points nowhere.
    """
    numbers = [float(item) for item in given if isinstance(item, int | float)]
    if len(numbers) < len(given):
        return ops.unit(ops.vector(*given))
    size = math.hypot(*numbers)
    if size == 0.0:
        raise InputError("a direction is zero; give a vector that points somewhere")
    is_unit = abs(size - 1.0) < 1e-12
    return ops.vector(*(given if is_unit else [n / size for n in numbers]))
