"""Points of a beam with deflections of any size in numbers, for pictures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.numbers.quaternions import about, from_rows, multiplied, rotated

Array = NDArray[np.float64]


def deflected_exactly(point: Mapping[str, Any], q: Array) -> tuple[Array, Array]:
    """Return position (n, 3) [m] and attitude (n, 4) of a point in the axes of its beam.

    Parameters
    ----------
    point
        What :meth:`~vehicledyn.multibody.bodies.exact_beam.ExactBeam.drawn` gives, with numbers.
    q
        Amplitudes, shape (n, coordinates).
    """
    shapes = [np.array(rows, dtype=float) for rows in point["nodes"]]
    in_space = any(np.any(rows[2]) or (np.any(rows[1]) and np.any(rows[0])) for rows in shapes)
    position = np.zeros((len(q), 3))
    unloaded = [from_rows(rows) for rows in point.get("turns", [None] * (len(shapes) + 1))]
    for rows, weight, turn in zip(shapes, point["weights"], unloaded[:-1], strict=True):
        strain = q @ rows[3:].T
        strain[:, 0] += 1.0
        attitude = multiplied(turn, _attitude(q @ rows[:3].T, is_spatial=in_space))
        position += weight * rotated(attitude, strain)
    end = np.array(point["end"], dtype=float)
    return position, multiplied(unloaded[-1], _attitude(q @ end[:3].T, is_spatial=in_space))


def _attitude(angles: Array, *, is_spatial: bool) -> Array:
    """Return the rotations of sections by their angles along y and z and their twist."""
    a, b, twist = angles.T
    if not is_spatial:
        turn = about(np.array([0.0, 0.0, 1.0]), a)
        return multiplied(turn, about(np.array([0.0, -1.0, 0.0]), b))
    y, z = -0.25 * b, 0.25 * a
    size = y * y + z * z
    bend = np.stack([1.0 - size, np.zeros_like(y), 2.0 * y, 2.0 * z], axis=1)
    bend /= (1.0 + size)[:, None]
    return multiplied(bend, about(np.array([1.0, 0.0, 0.0]), twist))
