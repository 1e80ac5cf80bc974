"""Peaks of a signal between its samples."""

from __future__ import annotations

import numpy as np

from vehicledyn.road.standards.signals import Floats


def peak(time: Floats, values: Floats) -> tuple[float, float]:
    """Return time and value of the largest value, of the parabola through it and its neighbours.

    At either end, or where the samples are uneven or level, that of the sample.
    """
    k = int(np.argmax(values))
    if not 0 < k < len(values) - 1:
        return float(time[k]), float(values[k])
    before, largest, after = (float(v) for v in values[k - 1 : k + 2])
    step, other = float(time[k] - time[k - 1]), float(time[k + 1] - time[k])
    bend = before - 2.0 * largest + after
    if bend >= 0.0 or abs(step - other) > 1e-6 * step:
        return float(time[k]), largest
    share = 0.5 * (before - after) / bend
    return float(time[k]) + share * step, largest - 0.25 * (before - after) * share
