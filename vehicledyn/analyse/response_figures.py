"""Key figures of a frequency response: peak and bandwidth, refined between the samples."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

HALF_POWER = 1.0 / math.sqrt(2.0)
"""-3 dB as a part of the static gain [1]."""

_FINE = 1e-10


@dataclass(frozen=True)
class KeyFigures:
    """Key figures of one output to one input.

    ``static_gain`` is None where the output does not settle; ``peak`` the largest magnitude
    with its ``peak_frequency`` [Hz], None where it lies at an end of the range; ``bandwidth``
    the first frequency at which the magnitude has fallen to 1/√2 of the static gain [Hz], None
    where it does not in the range.
    """

    static_gain: float | None
    peak: float | None
    peak_frequency: float | None
    bandwidth: float | None


def key_figures(
    magnitude: Callable[[float], float],
    frequencies: Any,
    static_gain: float,
    poles: Sequence[float] = (),
) -> KeyFigures:
    """Return the key figures of a magnitude |G(f)| in a range of frequencies.

    Parameters
    ----------
    magnitude
        |G| at a frequency [Hz].
    frequencies
        Rising, shape (n,) [Hz]; the ends are the range.
    static_gain
        Response at rest; nan if there is none.
    poles
        Frequencies near which the magnitude may have a narrow peak [Hz].
    """
    low, high = float(frequencies[0]), float(frequencies[-1])
    inside = [pole for pole in poles if low < pole < high]
    grid = np.unique(np.concatenate([np.asarray(frequencies, dtype=float), inside]))
    sizes = np.array([magnitude(f) for f in grid])
    peak, place = _peak(magnitude, grid, sizes)
    known = math.isfinite(static_gain)
    limit = abs(static_gain) * HALF_POWER if known else 0.0
    bandwidth = _fall(magnitude, grid, sizes, limit) if limit > 0.0 else None
    return KeyFigures(static_gain if known else None, peak, place, bandwidth)


def _peak(
    magnitude: Callable[[float], float], grid: Any, sizes: Any
) -> tuple[float | None, float | None]:
    from scipy.optimize import minimize_scalar

    k = int(np.argmax(sizes))
    if k in (0, len(grid) - 1) or not sizes[k] > 0.0:
        return None, None
    if not math.isfinite(sizes[k]):
        return math.inf, float(grid[k])
    span = (float(grid[k - 1]), float(grid[k + 1]))
    found = minimize_scalar(
        lambda f: -magnitude(f), bounds=span, method="bounded", options={"xatol": _FINE * span[1]}
    )
    best = (-float(found.fun), float(found.x))
    return max(best, (float(sizes[k]), float(grid[k])))


def _fall(magnitude: Callable[[float], float], grid: Any, sizes: Any, limit: float) -> float | None:
    from scipy.optimize import brentq

    below = np.flatnonzero(sizes < limit)
    if not below.size or below[0] == 0:
        return None
    k = int(below[0])
    root = brentq(lambda f: magnitude(f) - limit, grid[k - 1], grid[k], xtol=_FINE * grid[k])
    return float(root)
