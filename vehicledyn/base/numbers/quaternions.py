"""Unit quaternions (w, x, y, z) of rotations, v_parent = R v_child, many at once.

The quaternion of a turn by θ about the unit axis n is (cos θ/2, n sin θ/2); q and -q are the same
rotation.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def multiplied(a: Array, b: Array) -> Array:
    """Return the products a b of quaternions, shape (..., 4)."""
    aw, ax, ay, az = (a[..., k] for k in range(4))
    bw, bx, by, bz = (b[..., k] for k in range(4))
    product = np.empty((*np.broadcast_shapes(aw.shape, bw.shape), 4))
    product[..., 0] = aw * bw - ax * bx - ay * by - az * bz
    product[..., 1] = aw * bx + ax * bw + ay * bz - az * by
    product[..., 2] = aw * by - ax * bz + ay * bw + az * bx
    product[..., 3] = aw * bz + ax * by - ay * bx + az * bw
    return product


def rotated(quaternion: Array, vector: Array) -> Array:
    """Return vectors turned by quaternions, v + 2 w (u × v) + 2 u × (u × v)."""
    w, u = quaternion[..., :1], quaternion[..., 1:]
    across = _cross(u, vector)
    turned: Array = vector + 2.0 * (w * across + _cross(u, across))
    return turned


def _cross(a: Array, b: Array) -> Array:
    """Return a × b as ``numpy.cross`` does, which takes five times as long for a few."""
    ax, ay, az = (a[..., k] for k in range(3))
    bx, by, bz = (b[..., k] for k in range(3))
    product = np.empty((*np.broadcast_shapes(ax.shape, bx.shape), 3))
    product[..., 0] = ay * bz - az * by
    product[..., 1] = az * bx - ax * bz
    product[..., 2] = ax * by - ay * bx
    return product


def about(axis: Array, angle: Array) -> Array:
    """Return the quaternions of turns about a unit axis, shape (n, 4)."""
    half = 0.5 * angle
    return np.concatenate([np.cos(half)[:, None], np.sin(half)[:, None] * axis], axis=1)


def from_rows(rows: Any) -> Array:
    """Return the unit quaternion of a rotation matrix; of None that of no rotation."""
    if rows is None:
        return np.array([1.0, 0.0, 0.0, 0.0])
    r = np.array(rows, dtype=float)
    # The largest of the four squared components is at least a quarter: no cancellation.
    squares = np.array([1.0 + np.trace(r), *(1.0 + 2.0 * np.diag(r) - np.trace(r))])
    k = int(np.argmax(squares))
    skew = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    if k == 0:
        found = np.array([squares[0], *skew])
    else:
        i = k - 1
        found = np.array([skew[i], *(r[:, i] + r[i, :])])
        found[1 + i] = squares[k]
    unit: Array = found / np.linalg.norm(found)
    return unit


def continuous(quaternions: Array) -> Array:
    """Return the same rotations along the first axis with signs that do not jump, one at least."""
    inner = np.einsum("k...i,k...i->k...", quaternions[1:], quaternions[:-1])
    flips = np.where(np.nan_to_num(inner) < 0.0, -1.0, 1.0)
    signs = np.concatenate([np.ones((1, *flips.shape[1:])), np.cumprod(flips, axis=0)])
    kept: Array = quaternions * signs[..., None]
    return kept
