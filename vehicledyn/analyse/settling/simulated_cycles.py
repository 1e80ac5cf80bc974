"""Limit cycles as simulation finds them: run until the motion repeats.

How long that takes is judged by :mod:`.settling`; :mod:`.lowering` finds critical values so.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.basis import basis
from vehicledyn.analyse.periodic.critical import CriticalPoint
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.settling.settling import Ending, judged, spread
from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel

SAMPLES = 200
"""Samples a period."""

WINDOW = 10
"""Periods a window."""

STIFF = 0.5
"""Largest product of step and eigenvalue [1]."""


@dataclass(frozen=True)
class Settled:
    """What a simulation reached at a value of the parameter, and how it ended.

    ``amplitude`` is half the range of the watched channel, ``middle`` the middle of that,
    ``period`` [s], ``states`` and ``unknowns`` the samples of the last period and a little more,
    ``times`` [s] theirs. ``gap`` is by what part of the amplitude the last period differs from the
    one before. ``spread`` is by what part of itself the amplitude still varies from
    window to window where the motion has not settled. ``seconds`` [s] is how long it was
    simulated.
    """

    value: float
    amplitude: float
    middle: float
    period: float
    times: Vector
    states: Vector
    unknowns: Vector
    gap: float = 0.0
    ending: Ending = Ending.SETTLED
    spread: float = 0.0
    seconds: float = 0.0

    @property
    def alive(self) -> bool:
        """Whether it lasts."""
        return self.ending not in (Ending.GONE, Ending.STOPPED)

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
    """A disturbed motion to simulate: full state and unknowns, and the period of it [s].

    ``rate`` [1/s] is the fastest eigenvalue, ``moved`` the state that is disturbed most.
    """

    state: Vector
    unknowns: Vector
    period: float
    rate: float
    moved: int = 0


@dataclass
class Runner:
    """Simulates a model at values of the parameter, watching one channel.

    No more than ``allowed`` seconds of motion are simulated [s], ``spent`` were so far in
    ``runs`` motions. ``begins`` receives the value of each.
    """

    kernel: Kernel
    field: AutonomousField
    channel: int
    allowed: float = math.inf
    begins: Callable[[float], None] = lambda value: None
    spent: float = 0.0
    runs: int = 0

    @property
    def is_spent(self) -> bool:
        """Whether no more may be simulated."""
        return self.spent >= self.allowed

    def settle(self, value: float, start: Disturbed) -> Settled:
        """Return what a motion settles to.

        Raises
        ------
        NumericalError
            If the simulation cannot go on.
        """
        self.begins(value)
        self.runs += 1
        sizes: list[float] = []
        begun = self.spent
        while True:
            result = self.window(value, start)
            sizes.append(result.amplitude)
            ending = judged(sizes, result.gap)
            if result.ending is Ending.STOPPED:
                ending = Ending.STOPPED
            elif ending is None and self.is_spent:
                ending = Ending.CUT
            if ending is not None:
                varies = 0.0 if ending is Ending.SETTLED else spread(sizes)
                seconds = self.spent - begun
                return replace(result, ending=ending, spread=varies, seconds=seconds)
            start = replace(
                start, state=result.states[-1], unknowns=result.unknowns[-1], period=result.period
            )

    def window(
        self,
        value: float,
        start: Disturbed,
        *,
        periods: int = WINDOW,
        watched_state: int | None = None,
    ) -> Settled:
        """Return the end of a simulation over some periods; a state may be watched instead."""
        compute = partial(self._window, value, start, periods, watched_state)
        given = value, start, periods, watched_state, self.channel
        found = self.field.memory.recall_or_raise("window", given, compute)
        self.spent += found.seconds
        return found

    def _window(
        self, value: float, start: Disturbed, periods: int, watched_state: int | None
    ) -> Settled:
        kernel = self.kernel.with_parameters(self.field.parameters(value))
        interval = start.period / SAMPLES
        steps = max(1, math.ceil(interval * start.rate / STIFF))
        parts: list[tuple[Vector, ...]] = []
        done = simulate(
            kernel,
            RungeKutta4(step=interval / steps),
            start=0.0,
            stop=interval * SAMPLES * periods,
            state=start.state,
            unknowns=start.unknowns,
            interval=interval,
            sink=lambda *samples: parts.append(samples),
        )
        times, states, others, outputs = (
            np.concatenate([part[k] for part in parts]) for k in range(4)
        )
        watched = outputs[:, self.channel] if watched_state is None else states[:, watched_state]
        found = _period_of(times, watched) or start.period
        last = np.searchsorted(times, times[-1] - 1.05 * found)
        tail = slice(max(0, int(last)), None)
        two = watched[np.searchsorted(times, times[-1] - 2.0 * found) :]
        highest, lowest = _peak(two), -_peak(-two)
        return Settled(
            value,
            0.5 * (highest - lowest),
            0.5 * (highest + lowest),
            found,
            times[tail],
            states[tail],
            others[tail],
            _gap(times, watched, found) / max(0.5 * (highest - lowest), np.finfo(float).tiny),
            Ending.STOPPED if done.ended_by else Ending.SETTLED,
            seconds=float(times[-1]),
        )

    def disturbed(self, balance: CriticalPoint, size: float) -> Disturbed:
        """Return a disturbed equilibrium.

        It is disturbed in the shape of the oscillation that decays least, whose largest
        position gets the size, in its unit.
        """
        found = self.field.evaluate(balance.state[None], balance.unknowns[None], balance.value)
        values, vectors = np.linalg.eig(found.by_state[0])
        turning = np.flatnonzero(values.imag > 1e-6 * np.abs(values).max())
        if not turning.size:
            name = self.field.parameter
            raise NumericalError(f"nothing oscillates at {name} = {balance.value:.6g}")
        chosen = turning[np.argmax(values[turning].real)]
        index = leading(self.field, vectors[:, chosen])
        shape = vectors[:, chosen] / vectors[index, chosen]
        state = self.field.full(balance.state + size * shape.real)
        guess = balance.unknowns - size * (found.follow[0] @ shape).real
        rate = float(np.abs(values).max())
        period = 2.0 * math.pi / float(values[chosen].imag)
        return Disturbed(state, guess, period, rate, self.field.kept[index])

    def beside(self, orbit: Orbit, balance: CriticalPoint, part: float) -> Disturbed:
        """Return a periodic orbit's begin, moved by a part of its way to the equilibrium."""
        states, unknowns = orbit.sample(np.zeros(1))
        rate = float(np.abs(balance.eigenvalues).max())
        moved = self.field.full(states[0] + part * (balance.state - states[0]))
        guess = unknowns[0] + part * (balance.unknowns - unknowns[0])
        return Disturbed(moved, guess, orbit.period, rate)


def leading(field: AutonomousField, shape: Vector) -> int:
    """Return the index, among the states kept, of the position that moves most in a shape."""
    positions = set(field.equations.positions)
    among = [k for k, state in enumerate(field.kept) if state in positions]
    among = among or list(range(field.size))
    return among[int(np.argmax(np.abs(shape[among])))]


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


def _gap(times: Vector, values: Vector, period: float) -> float:
    """Return the largest difference of the last period from the one before."""
    last = times >= times[-1] - period
    before = np.interp(times[last] - period, times, values)
    return float(np.abs(values[last] - before).max())


def _peak(values: Vector) -> float:
    """Return the largest value, with a parabola through its neighbours."""
    k = int(np.argmax(values))
    if not 0 < k < len(values) - 1:
        return float(values[k])
    left, top, right = values[k - 1 : k + 2]
    bend = left - 2.0 * top + right
    return float(top - (right - left) ** 2 / (8.0 * bend)) if bend else float(top)
