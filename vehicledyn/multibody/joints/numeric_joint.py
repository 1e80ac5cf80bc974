"""Displacement and rotation of a joint as numbers, at many values of its coordinate."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.numbers.quaternions import about, from_rows
from vehicledyn.multibody.joints.joint_type import JointType
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

Array = NDArray[np.float64]


def displacements(joint: JointType, values: Array) -> Array | None:
    """Return the displacements at values of shape (n,), shape (n, 3) [m]; None without any."""
    if joint.slides_along is not None:
        slid: Array = values[:, None] * np.eye(3)[joint.slides_along - 1]
        return slid
    q = ops.symbol("coordinate")
    slide = joint.displacement(q)
    return None if slide is None else _at(q, slide, values)


def quaternions(joint: JointType, values: Array) -> Array | None:
    """Return the rotations at values of shape (n,), shape (n, 4); None where nothing turns.

    Of a joint with several positions the values have the shape (n, positions).
    """
    if joint.angle_about is not None:
        return about(np.eye(3)[joint.angle_about - 1], values)
    if not joint.turns_otherwise:
        return None
    q = ops.symbols("position", values.shape[1] if values.ndim > 1 else 1)
    rows = _at(q, ops.flat(joint.rotation(q)), values)
    # A matrix is kept column by column.
    return np.array([from_rows(row.reshape(3, 3).T) for row in rows]).reshape(-1, 4)


def _at(q: Scalar, column: Scalar, values: Array) -> Array:
    count = len(values)
    if not count:
        return np.zeros((0, column.shape[0]))
    found = ops.numeric([q], column)(values.reshape(count, -1).T)
    return np.asarray(found.T)
