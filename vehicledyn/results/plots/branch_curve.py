"""The curve of a branch between the cycles that continuation found, from its own directions.

Between two neighbours stands the cubic Hermite polynomial with the directions of both, in the
plane of the figure. Where a direction is unknown, or turns so far that the branch must have a
corner between them, that end follows the chord.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

POINTS = 12
"""Points drawn between two cycles."""

_CORNER = np.cos(np.radians(75.0))
"""Cosine of the angle between direction and chord from which on a corner is assumed."""


def branch_curve(points: Floats, directions: Floats) -> list[Floats]:
    """Return the curve between each two neighbours, shapes (POINTS + 1, 2).

    Parameters
    ----------
    points
        Places in the figure, shape (n, 2).
    directions
        Changes along the branch at them, of any length and sign, NaN where unknown, shape (n, 2).
    """
    points = np.asarray(points, dtype=float)
    if len(points) < 2:
        return []
    size = np.ptp(points, axis=0)
    size[size == 0.0] = 1.0
    scaled = points / size
    along = _oriented(scaled, np.asarray(directions, dtype=float) / size)
    return [_hermite(scaled[k : k + 2], along[k : k + 2]) * size for k in range(len(points) - 1)]


def _oriented(points: Floats, directions: Floats) -> Floats:
    """Return unit directions that lead on, from each point to the next."""
    lengths = np.linalg.norm(directions, axis=1, keepdims=True)
    known = np.isfinite(lengths) & (lengths > 0.0)
    unit = np.where(known, directions / np.where(known, lengths, 1.0), np.nan)
    before, after = np.maximum(np.arange(len(points)) - 1, 0), np.arange(len(points)) + 1
    ways = points[np.minimum(after, len(points) - 1)] - points[before]
    backwards = np.einsum("ki,ki->k", np.nan_to_num(unit), ways) < 0.0
    return np.asarray(np.where(backwards[:, None], -unit, unit))


def _hermite(ends: Floats, along: Floats) -> Floats:
    chord = ends[1] - ends[0]
    length = float(np.linalg.norm(chord))
    if not length > 0.0:
        return np.repeat(ends[:1], POINTS + 1, axis=0)
    first, last = (_slope(direction, chord, length) for direction in along)
    t = np.linspace(0.0, 1.0, POINTS + 1)[:, None]
    blends: Sequence[Floats] = (
        2.0 * t**3 - 3.0 * t**2 + 1.0,
        t**3 - 2.0 * t**2 + t,
        3.0 * t**2 - 2.0 * t**3,
        t**3 - t**2,
    )
    return np.asarray(
        blends[0] * ends[0] + blends[1] * first + blends[2] * ends[1] + blends[3] * last
    )


def _slope(direction: Floats, chord: Floats, length: float) -> Floats:
    """Return the derivative at an end; that of the chord where the direction leads elsewhere."""
    if not np.isfinite(direction).all() or float(direction @ chord) < _CORNER * length:
        return chord
    return np.asarray(direction * length)
