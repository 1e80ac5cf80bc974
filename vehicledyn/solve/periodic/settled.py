"""Limit cycles as simulation finds them: run until the motion repeats, change the parameter.

This is how critical speeds are found by simulation: the parameter is lowered in steps, each
long enough to settle, until the cycle is gone; the step in which that happens is halved.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from vehicledyn.solve.engine import Vector
from vehicledyn.solve.kernel import Kernel
from vehicledyn.solve.methods.rk4 import RungeKutta4
from vehicledyn.solve.periodic.autonomous import AutonomousField
from vehicledyn.solve.periodic.basis import basis
from vehicledyn.solve.periodic.critical import Balance, ahead, find_balance
from vehicledyn.solve.periodic.orbit import Orbit
from vehicledyn.solve.simulate import simulate

SAMPLES = 200
"""Samples a period."""

_WINDOW = 10
_MOST_WINDOWS = 80
_SETTLED = 1e-5
_LOOKED_BACK = 8
"""Windows over which a motion that does not repeat is compared with the same number before."""

_DRIFT, _SHRINKING = 0.25, 0.5
"""Largest change of the mean amplitude, part of its spread, with which a motion does not go
anywhere, and how far the spread of one that settles shrinks from one comparison to the next."""

_TURNS = 2
"""Turns of the amplitude in that time, which one that dies slowly does not make."""

_GONE = 0.02
_STIFF = 0.5
"""Largest product of step and eigenvalue [1]."""


@dataclass(frozen=True)
class Settled:
    """Where a simulation came to at a value of the parameter.

    ``amplitude`` is half the range of the watched channel, ``period`` [s], ``states`` and
    ``unknowns`` the samples of the last period and a little more, ``times`` [s] theirs.
    ``alive`` tells a lasting motion from one that died away. ``spread`` is by what part of itself
    the amplitude still varies from window to window: more than rounding where a motion lasts but
    does not repeat, as one of two frequencies does.
    """

    value: float
    amplitude: float
    period: float
    alive: bool
    times: Vector
    states: Vector
    unknowns: Vector
    spread: float = 0.0

    def orbit(self, field: AutonomousField, *, intervals: int, degree: int) -> Orbit:
        """Return the last period as a guess of a periodic orbit."""
        from scipy.interpolate import CubicSpline

        mesh = np.linspace(0.0, 1.0, intervals + 1)
        empty = np.zeros((intervals * degree, 0))
        bare = Orbit(basis(degree), mesh, empty, empty, self.period, self.value)
        own, gauss = bare.times_of(mesh)
        kept = CubicSpline(self.times, field.reduced(self.states))
        others = CubicSpline(self.times, self.unknowns)
        begin = self.times[0]
        return replace(
            bare,
            states=kept(begin + own * self.period),
            unknowns=np.asarray(others(begin + gauss * self.period)).reshape(len(gauss), -1),
        )


@dataclass(frozen=True)
class Disturbed:
    """A disturbed equilibrium: full state and unknowns, period [s] of the oscillation.

    ``rate`` [1/s] is the fastest eigenvalue, ``moved`` the state that is disturbed most.
    """

    state: Vector
    unknowns: Vector
    period: float
    rate: float
    moved: int


@dataclass
class Runner:
    """Simulates a model at values of the parameter, watching one channel."""

    kernel: Kernel
    field: AutonomousField
    channel: int

    def settle(
        self, value: float, state: Vector, unknowns: Vector, period: float, *, rate: float
    ) -> Settled:
        """Return what a motion settles to, ``rate`` being the fastest eigenvalue [1/s].

        Raises
        ------
        NumericalError
            If the simulation cannot go on.
        """
        sizes: list[float] = []
        while True:
            result = self.window(value, state, unknowns, period, rate=rate)
            state, unknowns, period = result.states[-1], result.unknowns[-1], result.period
            sizes.append(result.amplitude)
            if sizes[-1] < _GONE * max(sizes):
                return replace(result, alive=False)
            if len(sizes) > 1 and abs(sizes[-1] - sizes[-2]) < _SETTLED * sizes[-1]:
                return result
            if len(sizes) == _MOST_WINDOWS or _wanders(sizes):
                return replace(result, spread=float(np.ptp(sizes[-_LOOKED_BACK:]) / sizes[-1]))

    def window(
        self,
        value: float,
        state: Vector,
        unknowns: Vector,
        period: float,
        *,
        rate: float,
        watched_state: int | None = None,
    ) -> Settled:
        """Return the end of a simulation over some periods; a state may be watched instead."""
        kernel = self.kernel.with_parameters(self.field.parameters(value))
        interval = period / SAMPLES
        steps = max(1, math.ceil(interval * rate / _STIFF))
        parts: list[tuple[Vector, ...]] = []
        simulate(
            kernel,
            RungeKutta4(step=interval / steps),
            start=0.0,
            stop=interval * SAMPLES * _WINDOW,
            state=state,
            unknowns=unknowns,
            interval=interval,
            sink=lambda *samples: parts.append(samples),
        )
        times, states, others, outputs = (
            np.concatenate([part[k] for part in parts]) for k in range(4)
        )
        watched = outputs[:, self.channel] if watched_state is None else states[:, watched_state]
        found = _period_of(times, watched) or period
        last = np.searchsorted(times, times[-1] - 1.05 * found)
        tail = slice(max(0, int(last)), None)
        two = watched[np.searchsorted(times, times[-1] - 2.0 * found) :]
        amplitude = 0.5 * (_peak(two) + _peak(-two))
        return Settled(value, amplitude, found, True, times[tail], states[tail], others[tail])

    def disturbed(self, balance: Balance, size: float) -> Disturbed:
        """Return a disturbed equilibrium.

        It is disturbed in the shape of the oscillation that decays least, whose largest
        position gets the size, in its unit.
        """
        found = self.field.evaluate(balance.state[None], balance.unknowns[None], balance.value)
        values, vectors = np.linalg.eig(found.by_state[0])
        turning = np.flatnonzero(values.imag > 1e-6 * np.abs(values).max())
        chosen = turning[np.argmax(values[turning].real)]
        index = leading(self.field, vectors[:, chosen])
        shape = vectors[:, chosen] / vectors[index, chosen]
        state = self.field.full(balance.state + size * shape.real)
        guess = balance.unknowns - size * (found.follow[0] @ shape).real
        rate = float(np.abs(values).max())
        period = 2.0 * math.pi / float(values[chosen].imag)
        return Disturbed(state, guess, period, rate, self.field.kept[index])


def _wanders(sizes: Sequence[float]) -> bool:
    """Return whether amplitudes of one window after the other vary without going anywhere."""
    if len(sizes) < 2 * _LOOKED_BACK:
        return False
    before, last = np.array(sizes[-2 * _LOOKED_BACK :]).reshape(2, _LOOKED_BACK)
    if np.count_nonzero(np.diff(np.sign(np.diff(last)))) < _TURNS:
        return False
    drift = abs(last.mean() - before.mean())
    return bool(drift < _DRIFT * np.ptp(last) and np.ptp(last) > _SHRINKING * np.ptp(before))


def leading(field: AutonomousField, shape: Vector) -> int:
    """Return the index, among the states kept, of the position that moves most in a shape."""
    positions = set(field.equations.positions)
    among = [k for k, state in enumerate(field.kept) if state in positions]
    among = among or list(range(field.size))
    return among[int(np.argmax(np.abs(shape[among])))]


def lower(
    runner: Runner,
    values: Sequence[float],
    balances: Callable[[float], Balance],
    size: float,
    *,
    resolution: float,
    told: Callable[[Settled], None],
) -> tuple[float, float] | None:
    """Change the parameter step by step and tell each settled cycle; return where it is gone.

    The cycle lives at the first of the two values returned and dies at the second. None if
    there is no cycle to begin with, or if it lives at all values. A cycle that dies after a large
    step may live there after small ones, so that each trial starts from the last one that lives.
    """
    first = balances(values[0])
    d = runner.disturbed(first, size)
    alive = runner.settle(values[0], d.state, d.unknowns, d.period, rate=d.rate)
    if not alive.alive or alive.amplitude < 0.1 * size:
        return None
    told(alive)
    for value in values[1:]:
        found = _next(runner, alive, value, balances)
        if not found.alive:
            break
        alive = found
        told(found)
    else:
        return None
    dead, step = value, 0.5 * (value - alive.value)
    while abs(step) >= 0.5 * resolution:
        value = alive.value + step
        if (value - values[-1]) * step > 0.0:
            return None
        found = _next(runner, alive, value, balances)
        if found.alive:
            alive = found
            told(found)
        else:
            dead, step = value, 0.5 * step
    return alive.value, dead


def _next(
    runner: Runner, before: Settled, value: float, balances: Callable[[float], Balance]
) -> Settled:
    """Return what a cycle settles to at another value, moved there with the equilibrium.

    A wheel that rolls turns more slowly at a lower speed: from its old rate it would slide.
    """
    old, new = balances(before.value), balances(value)
    state = before.states[-1].copy()
    state[runner.field.kept] += new.state - old.state
    unknowns = before.unknowns[-1] + new.unknowns - old.unknowns
    rate = max(float(np.abs(balance.eigenvalues).max()) for balance in (old, new))
    return runner.settle(value, state, unknowns, before.period, rate=rate)


def growth_begins(
    runner: Runner,
    values: Sequence[float],
    balances: Callable[[float], Balance],
    size: float,
    *,
    resolution: float,
) -> tuple[float, float] | None:
    """Raise the parameter until a small disturbance grows; return values before and after.

    None if it decays at all values, or grows at the first.
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
    while abs(high - low) > resolution:
        middle = 0.5 * (low + high)
        if _grows(runner, balances(middle), size):
            high = middle
        else:
            low = middle
    return low, high


def balances_near(field: AutonomousField, known: Sequence[Balance]) -> Callable[[float], Balance]:
    """Return a function that finds the equilibrium at a value from the nearest known one."""

    def near(value: float) -> Balance:
        start = min(known, key=lambda balance: abs(balance.value - value))
        return find_balance(field, value, *ahead(field, start, value))

    return near


def steps(first: float, last: float, count: int) -> Iterator[float]:
    """Yield equally spaced values from the first to the last."""
    return (first + (last - first) * k / (count - 1) for k in range(count))


def _grows(runner: Runner, balance: Balance, size: float) -> bool:
    """Return whether a small disturbance is larger after two windows than after one.

    It is seen in the state that it moves most, which the watched channel need not show.
    """
    d = runner.disturbed(balance, size)
    window = partial(runner.window, balance.value, rate=d.rate, watched_state=d.moved)
    first = window(d.state, d.unknowns, d.period)
    second = window(first.states[-1], first.unknowns[-1], first.period)
    return second.amplitude > first.amplitude


def _period_of(times: Vector, values: Vector) -> float | None:
    """Return the mean time between upward passages through the middle of the range."""
    last = values[len(values) // 2 :]
    middle = 0.5 * (float(last.max()) + float(last.min()))
    rising = np.flatnonzero((values[:-1] < middle) & (values[1:] >= middle))
    if rising.size < 3:
        return None
    part = (middle - values[rising]) / (values[rising + 1] - values[rising])
    moments = times[rising] + part * (times[rising + 1] - times[rising])
    return float(np.median(np.diff(moments)))


def _peak(values: Vector) -> float:
    """Return the largest value, with a parabola through its neighbours."""
    k = int(np.argmax(values))
    if not 0 < k < len(values) - 1:
        return float(values[k])
    left, top, right = values[k - 1 : k + 2]
    bend = left - 2.0 * top + right
    return float(top - (right - left) ** 2 / (8.0 * bend)) if bend else float(top)
