"""Whether two runs cover the same time and were sampled at the same instants."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SAME_INSTANT = 1e-9  # share of the smallest sampling step by which equal times may differ


def range_difference(result: Floats, reference: Floats) -> str:
    """Return how a result falls short of the reference's time range, empty if it does not.

    Both arguments are rising times [s] with at least one sample.
    """
    slack = _slack(reference)
    if result[-1] < reference[-1] - slack:
        return f"the result ends at t = {result[-1]:.9g} s, the reference at {reference[-1]:.9g} s"
    if result[0] > reference[0] + slack:
        return f"the result starts at t = {result[0]:.9g} s, the reference at {reference[0]:.9g} s"
    return ""


def grid_difference(result: Floats, reference: Floats) -> str:
    """Return how the sample times differ, empty if they are equal but for rounding."""
    advice = "ask for interpolation to compare them all the same"
    if len(result) != len(reference):
        return f"{len(result)} samples, the reference has {len(reference)}; {advice}"
    apart = np.abs(result - reference)
    at = int(np.argmax(apart))
    if apart[at] > _slack(reference):
        return (
            f"sample {at} lies at t = {result[at]:.12g} s, in the reference at "
            f"{reference[at]:.12g} s; {advice}"
        )
    return ""


def _slack(reference: Floats) -> float:
    steps = np.diff(reference)
    smallest = float(np.min(steps[steps > 0.0], initial=np.inf))
    return SAME_INSTANT * smallest if math.isfinite(smallest) else 0.0
