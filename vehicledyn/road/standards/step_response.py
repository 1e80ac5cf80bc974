"""Response times, peaks and overshoots of a step of the steering wheel (ISO 7401)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.road.standards.peaks import peak
from vehicledyn.road.standards.signals import Floats

RESPONDED = 0.9
"""Part of the steady value that ends the response time [1]."""


@dataclass(frozen=True)
class StepResponse:
    """How a signal answers a step.

    ``steady`` is its value at the end, ``response_time`` runs from the reference time to 90 % of
    it, ``peak_time`` to the largest value [s]; ``overshoot`` is that over the steady value less
    one [1]. Times are NaN where the value is not reached.
    """

    steady: float
    response_time: float
    peak_time: float
    overshoot: float


def half_of_step(time: Floats, steering: Floats) -> float:
    """Return the reference time of a step: when the steering angle is half of its final value.

    NaN where the final value is zero.
    """
    if steering[-1] == 0.0:
        return float("nan")
    return first_crossing(time, steering / steering[-1], 0.5)


def step_response(
    time: Floats, values: Floats, *, reference: float, settled: float
) -> StepResponse:
    """Return the quantities of a signal.

    Parameters
    ----------
    time, values
        The signal, shape (n_times,).
    reference
        Time from which response and peak are counted [s].
    settled
        Time from which on the mean of the signal is its steady value [s].
    """
    steady = float(values[time >= settled].mean())
    if steady == 0.0:
        return StepResponse(0.0, np.nan, np.nan, np.nan)
    answer = values / steady
    at, largest = peak(time, answer)
    reached = first_crossing(time, answer, RESPONDED)
    return StepResponse(steady, reached - reference, at - reference, largest - 1.0)


def first_crossing(time: Floats, values: Floats, level: float) -> float:
    """Return the first time at which rising values reach a level, between samples; else NaN."""
    above = np.flatnonzero(values >= level)
    if not above.size:
        return float("nan")
    k = int(above[0])
    if k == 0:
        return float(time[0])
    part = (level - values[k - 1]) / (values[k] - values[k - 1])
    return float(time[k - 1] + part * (time[k] - time[k - 1]))
