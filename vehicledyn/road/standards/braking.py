"""Stopping distance and mean fully developed deceleration of braking on the straight."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.road.standards.entries import entry
from vehicledyn.road.standards.signals import Floats, Signals

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry

STOPPED = 0.1
"""Speed that counts as standing [m/s]."""

_FIRST, _LAST = 0.8, 0.1
"""Parts of the initial speed between which the deceleration is fully developed [1]."""


def deceleration_figures(braked: Signals) -> Iterator[SummaryEntry]:
    """Yield initial speed, stopping distance and mean fully developed deceleration.

    d_m = (v_b² - v_e²) / (2 (s_e - s_b)), with v_b = 0.8 v_0 and v_e = 0.1 v_0 at the ways s_b and
    s_e. What a run does not reach is left out.

    Parameters
    ----------
    braked
        Signals from the begin of braking on, two samples at least.

    References
    ----------
    Mean fully developed deceleration: UN R13-H, annex 3; stopping distance: ISO 21994.
    """
    way, first = _way(braked), float(braked.speed[0])
    yield from entry("initial_speed", first, "m/s", "Speed at which the brakes begin")
    slowest = float(braked.speed.min())
    if slowest <= STOPPED:
        stop = _way_at(braked, way, STOPPED)
        yield from entry("stopping_distance", stop, "m", "Way from the begin of braking to rest")
    if first > STOPPED and slowest <= _LAST * first:
        developed = _way_at(braked, way, _LAST * first) - _way_at(braked, way, _FIRST * first)
        mean = (_FIRST**2 - _LAST**2) * first**2 / (2.0 * developed)
        words = "Mean fully developed deceleration, between 80 % and 10 % of the speed"
        yield from entry("mean_deceleration", mean, "m/s^2", words)


def _way(braked: Signals) -> Floats:
    steps = np.diff(braked.time) * 0.5 * (braked.speed[1:] + braked.speed[:-1])
    return np.concatenate([[0.0], np.cumsum(steps)])


def _way_at(braked: Signals, way: Floats, speed: float) -> float:
    """Return the way to the first instant at which the car is as slow as ``speed`` [m]."""
    slow = int(np.argmax(braked.speed <= speed))
    if slow == 0:
        return float(way[0])
    before, after = float(braked.speed[slow - 1]), float(braked.speed[slow])
    part = (before - speed) / (before - after)
    return float(way[slow - 1] + part * (way[slow] - way[slow - 1]))
