"""The explicit pair DOP853 step by step: trial steps, their error and their dense output.

Hairer, Nørsett, Wanner (1993), Solving Ordinary Differential Equations I, sections II.4 to II.6.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np

from vehicledyn.integrate.explicit_pairs.dop853_table import (
    ALL_STAGES,
    DENSE,
    FIFTH,
    NODES,
    STAGES,
    THIRD,
    WEIGHTS,
)
from vehicledyn.kernel.engine import Vector

Rates: TypeAlias = Callable[[float, Vector], Vector]
"""Rates of the states at a time [s]; not a number where there are none."""

_ORDER = 8
_SAFETY, _SMALLEST, _LARGEST = 0.9, 0.2, 10.0


@dataclass(frozen=True)
class StepTolerances:
    """Tolerances of the local error of each state: relative to it [1], and absolute."""

    relative: float
    absolute: float

    def scale(self, sizes: Vector) -> Vector:
        """Return the error allowed for states of these sizes."""
        return self.absolute + self.relative * sizes


@dataclass(frozen=True)
class StepStart:
    """A point to start from: time [s], states and their rates there."""

    time: float
    state: Vector
    rate: Vector


@dataclass
class Trial:
    """A step that has been tried; ``error`` above one is more than the tolerance allows."""

    begin: StepStart
    end: StepStart
    error: float
    stages: Vector
    rates: Rates
    _terms: list[Vector] = field(default_factory=list)

    @property
    def size(self) -> float:
        """Step size [s]."""
        return self.end.time - self.begin.time

    def state(self, time: float) -> Vector:
        """Return the states at a time inside the step, interpolated with order 7."""
        if not self._terms:
            self._terms = self._interpolate()
        part = (time - self.begin.time) / self.size
        value = np.zeros_like(self.begin.state)
        for k, term in enumerate(reversed(self._terms)):
            value = (value + term) * (part if k % 2 == 0 else 1.0 - part)
        return value + self.begin.state

    def _interpolate(self) -> list[Vector]:
        """Return the terms of the interpolation; it takes three more evaluations."""
        h, change = self.size, self.end.state - self.begin.state
        for k in range(STAGES + 1, ALL_STAGES):
            _fill_stage(self.rates, self.begin, h, self.stages, k)
        first = h * self.begin.rate - change
        second = 2.0 * change - h * (self.end.rate + self.begin.rate)
        return [change, first, second, *(h * (DENSE @ self.stages))]


def try_step(rates: Rates, begin: StepStart, stop: float, tolerances: StepTolerances) -> Trial:
    """Take one step up to a time [s] and estimate its error."""
    size = stop - begin.time
    stages = np.empty((ALL_STAGES, begin.state.size))
    stages[0] = begin.rate
    for k in range(1, STAGES):
        _fill_stage(rates, begin, size, stages, k)
    state = begin.state + size * (WEIGHTS[STAGES, :STAGES] @ stages[:STAGES])
    end = StepStart(stop, state, rates(stop, state))
    stages[STAGES] = end.rate
    scale = tolerances.scale(np.maximum(np.abs(begin.state), np.abs(state)))
    return Trial(begin, end, _error(stages[: STAGES + 1], size, scale), stages, rates)


def next_size(trial: Trial, *, refused: bool) -> float:
    """Return the size of the step to try next [s]; ``refused`` if one was since the last good."""
    if not trial.error < 1.0:
        factor = math.pow(trial.error, -1.0 / _ORDER) if math.isfinite(trial.error) else 0.0
        return trial.size * max(_SMALLEST, _SAFETY * factor)
    most = 1.0 if refused else _LARGEST
    if trial.error == 0.0:
        return trial.size * most
    return trial.size * min(most, _SAFETY * math.pow(trial.error, -1.0 / _ORDER))


def first_size(rates: Rates, begin: StepStart, longest: float, tolerances: StepTolerances) -> float:
    """Return a size of the first step [s], from the change of the rates along a short way."""
    scale = tolerances.scale(np.abs(begin.state))
    state, rate = _mean_norm(begin.state / scale), _mean_norm(begin.rate / scale)
    usual = min(state, rate) >= 1e-5 and 0.0 < state / rate < math.inf
    short = min(0.01 * state / rate if usual else 1e-6, longest)
    ahead = rates(begin.time + short, begin.state + short * begin.rate)
    bend = _mean_norm((ahead - begin.rate) / scale) / short
    if max(rate, bend) <= 1e-15:
        guess = max(1e-6, 1e-3 * short)
    else:
        guess = math.pow(0.01 / max(rate, bend), 1.0 / _ORDER)
    return min(100.0 * short, guess, longest) if 0.0 < guess < math.inf else short


class Dop853:
    """Steps of a size that keeps the error within a tolerance, up to a time.

    Speaks like the solvers of SciPy: ``t`` and ``y`` are time [s] and states at the end of the
    last step, ``t_old`` the time at its begin, ``step_size`` its size [s], ``status`` is
    "running", "finished" or "failed"; ``order`` is that of the method.
    """

    order = _ORDER

    def __init__(
        self, rates: Rates, time: float, state: Vector, stop: float, *, tolerances: StepTolerances
    ) -> None:
        """Find the size of the first step; there must be somewhere to go."""
        self._rates, self._stop, self._tolerances = rates, stop, tolerances
        self._here = StepStart(time, state, rates(time, state))
        self._size = first_size(rates, self._here, stop - time, tolerances)
        self._last: Trial | None = None
        self.status = "running"

    @property
    def t(self) -> float:
        """Time at the end of the last step [s]."""
        return self._here.time

    @property
    def y(self) -> Vector:
        """States at the end of the last step."""
        return self._here.state

    @property
    def t_old(self) -> float:
        """Time at the begin of the last step [s]."""
        return self._here.time if self._last is None else self._last.begin.time

    @property
    def step_size(self) -> float:
        """Size of the last step [s]."""
        return 0.0 if self._last is None else self._last.size

    def dense_output(self) -> Callable[[float], Vector]:
        """Return the function that interpolates in the last step."""
        if self._last is None:
            raise ValueError("no step has been taken yet")
        return self._last.state

    def step(self) -> None:
        """Take a step, or fail where it would become too small."""
        here, refused = self._here, False
        smallest = 10.0 * float(np.spacing(abs(here.time)))
        self._size = max(self._size, smallest)
        while self._size >= smallest:
            stop = min(here.time + self._size, self._stop)
            trial = try_step(self._rates, here, stop, self._tolerances)
            self._size = next_size(trial, refused=refused)
            refused = not trial.error < 1.0
            if not refused:
                self._here, self._last = trial.end, trial
                self.status = "running" if trial.end.time < self._stop else "finished"
                return
        self.status = "failed"


def _fill_stage(rates: Rates, begin: StepStart, size: float, stages: Vector, k: int) -> None:
    state = begin.state + size * (WEIGHTS[k, :k] @ stages[:k])
    stages[k] = rates(begin.time + NODES[k] * size, state)


def _error(stages: Vector, size: float, scale: Vector) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        fifth = float(np.linalg.norm((FIFTH @ stages) / scale) ** 2)
        third = float(np.linalg.norm((THIRD @ stages) / scale) ** 2)
    both = (fifth + 0.01 * third) * scale.size
    if not math.isfinite(both):
        return math.inf
    return abs(size) * fifth / math.sqrt(both) if both > 0.0 else 0.0


def _mean_norm(values: Vector) -> float:
    with np.errstate(over="ignore"):
        # A system whose motion is all driven has no states.
        return float(np.linalg.norm(values)) / math.sqrt(max(values.size, 1))
