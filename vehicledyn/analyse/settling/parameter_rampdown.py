"""Critical values as simulation finds them: change the parameter, run until the motion repeats.

The parameter is lowered in steps, each long enough to settle, until the cycle is gone; the step in
which that happens is halved. And it is raised until a small disturbance grows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.critical import CriticalPoint, ahead, find_balance
from vehicledyn.analyse.settling.settling import Ending
from vehicledyn.analyse.settling.simulated_cycles import Disturbed, Runner, Settled

Balances = Callable[[float], CriticalPoint]

_SMALL = 0.1
"""Part of the disturbance below which what it settles to is no motion."""


_GROWING = 5
"""Periods a window in which a small disturbance grows or not; nothing else has to decay first."""


@dataclass(frozen=True)
class Bracket:
    """The values between which a cycle dies: it lives at the first. None where it does not.

    ``reason`` says why a search ended before.
    """

    between: tuple[float, float] | None = None
    reason: str = ""


def lower(
    runner: Runner,
    values: Sequence[float],
    balances: Balances,
    size: float,
    *,
    resolution: float,
    expected: Sequence[float] = (),
    report: Callable[[Settled], None],
) -> Bracket:
    """Change the parameter step by step and report each settled cycle; return where it is gone.

    A cycle that dies after a large step may live there after small ones, so that each trial
    starts from the last one that lives.

    Parameters
    ----------
    runner
        Simulates.
    values
        Those of the parameter, one after the other.
    balances
        Returns the equilibrium at a value.
    size
        Disturbance of the first of them.
    resolution
        How finely the value is found at which the cycle dies.
    expected
        Values at which it may, such as folds: they are tried first.
    report
        Called with each motion that lasts.
    """
    search = _Lowering(runner, balances, resolution, report)
    return search.run(list(values), size, expected)


@dataclass
class _Lowering:
    """A cycle on its way down."""

    runner: Runner
    balances: Balances
    resolution: float
    report: Callable[[Settled], None]
    alive: Settled = field(init=False)

    def run(self, values: list[float], size: float, expected: Sequence[float]) -> Bracket:
        """Return where the cycle dies."""
        left = self._first(values, size)
        if left is None:
            return Bracket(reason=self._spent() if self.runner.is_spent else "")
        for value in left:
            found = self._next(value)
            if found.ending is Ending.STOPPED:
                return Bracket(reason=self._stopped(found))
            if self.runner.is_spent:
                return Bracket(reason=self._spent())
            if not found.alive:
                return self._halved(value, left[-1], expected)
        return Bracket()

    def _first(self, values: list[float], size: float) -> list[float] | None:
        """Find the first cycle, that of a disturbance; return the values below, None without.

        Where the first disturbance dies, or throws the vehicle off, others are tried where
        disturbances grow.
        """
        for k, value in enumerate(values):
            balance = self.balances(value)
            if not _oscillates(balance) or (k and balance.largest_real_part <= 0.0):
                continue
            found = self.runner.settle(value, self.runner.disturbed(balance, size))
            if found.alive and found.amplitude >= _SMALL * size:
                self.alive = found
                self.report(found)
                return values[k + 1 :]
            if self.runner.is_spent:
                return None
        return None

    def _halved(self, dead: float, last: float, expected: Sequence[float]) -> Bracket:
        """Return where the cycle dies between that which lives and a value where it does not."""
        hints = self._hints(dead, expected)
        step = 0.5 * (dead - self.alive.value)
        while abs(step) >= 0.5 * self.resolution:
            is_hint = bool(hints)
            value = hints.pop(0) if hints else self.alive.value + step
            if (value - last) * step > 0.0:
                return Bracket()
            found = self._next(value)
            if found.ending is Ending.STOPPED:
                return Bracket(reason=self._stopped(found))
            if self.runner.is_spent:
                return Bracket(reason=self._spent())
            if not found.alive:
                dead, hints = value, []
            if is_hint or not found.alive:
                step = (hints[0] if hints else 0.5 * (self.alive.value + dead)) - self.alive.value
        return Bracket((self.alive.value, dead))

    def _hints(self, dead: float, expected: Sequence[float]) -> list[float]:
        """Return the values beside the nearest one expected on the way to where it is dead."""
        way = dead - self.alive.value
        half = 0.4 * self.resolution * np.sign(way)
        inside = [v for v in expected if 0.0 < (v - self.alive.value) / way < 1.0]
        for value in sorted(inside, key=lambda v: abs(v - self.alive.value)):
            beside = [value - half, value + half]
            if all(0.0 < (v - self.alive.value) / way < 1.0 for v in beside):
                return [float(v) for v in beside]
        return []

    def _next(self, value: float) -> Settled:
        """Return what the cycle settles to at another value, moved there with the equilibrium.

        A wheel that rolls turns more slowly at a lower speed: from its old rate it would slide.
        What lasts is reported and taken for the cycle from now on.
        """
        before, field = self.alive, self.runner.field
        old, new = self.balances(before.value), self.balances(value)
        state = before.states[-1].copy()
        state[field.kept] += new.state - old.state
        unknowns = before.unknowns[-1] + new.unknowns - old.unknowns
        rate = max(float(np.abs(balance.eigenvalues).max()) for balance in (old, new))
        found = self.runner.settle(value, Disturbed(state, unknowns, before.period, rate))
        if found.alive:
            self.alive = found
            self.report(found)
        return found

    def _spent(self) -> str:
        return f"{self.runner.spent:.3g} s of motion are simulated, as many as are allowed"

    def _stopped(self, found: Settled) -> str:
        name = self.runner.field.parameter
        return f"at {name} = {found.value:.6g} an event ends the motion, such as a derailment"


def growth_begins(
    runner: Runner,
    values: Sequence[float],
    balances: Balances,
    size: float,
    *,
    resolution: float,
    expected: Sequence[float] = (),
) -> tuple[float, float] | None:
    """Raise the parameter until a small disturbance grows; return values before and after.

    None if it decays at all values, or grows at the first. Values ``expected`` are tried first.
    """
    low: float | None = None
    for value in values:
        if _grows(runner, balances(value), size):
            break
        low = value
    else:
        return None
    if low is None:
        return None
    high = value
    hints = [v + side * resolution for v in expected if low < v < high for side in (-0.4, 0.4)]
    while abs(high - low) > resolution:
        middle = hints.pop(0) if hints else 0.5 * (low + high)
        if not low < middle < high:
            continue
        if _grows(runner, balances(middle), size):
            high = middle
        else:
            low = middle
    return low, high


def balances_near(field: AutonomousField, known: Sequence[CriticalPoint]) -> Balances:
    """Return a function that finds the equilibrium at a value from the nearest known one."""

    def near(value: float) -> CriticalPoint:
        start = min(known, key=lambda balance: abs(balance.value - value))
        return find_balance(field, value, *ahead(field, start, value))

    return near


def steps(first: float, last: float, count: int) -> Iterator[float]:
    """Yield equally spaced values from the first to the last."""
    return (first + (last - first) * k / (count - 1) for k in range(count))


def _oscillates(balance: CriticalPoint) -> bool:
    """Return whether anything oscillates about an equilibrium."""
    return bool(np.any(balance.eigenvalues.imag != 0.0))


def _grows(runner: Runner, balance: CriticalPoint, size: float) -> bool:
    """Return whether a small disturbance is larger after two windows than after one.

    It is seen in the state that it moves most, which the watched channel need not show.
    """
    if not _oscillates(balance):
        return False
    runner.begins(balance.value)
    runner.runs += 1
    start = runner.disturbed(balance, size)
    window = partial(runner.window, balance.value, periods=_GROWING, watched_state=start.moved)
    first = window(start)
    second = window(
        replace(start, state=first.states[-1], unknowns=first.unknowns[-1], period=first.period)
    )
    return second.amplitude > first.amplitude
