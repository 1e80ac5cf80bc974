"""A vehicle driven along the path by a simple driver: where the search for an optimum begins.

How much each control turns and drives is found by trying it. The driver looks ahead, steers
towards the middle of the corridor there (pure pursuit) and holds the speed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.path_curves import PathCurves
from vehicledyn.analyse.optimal_control.problem import BEND, RAMP, ControlProblem, Corridor
from vehicledyn.analyse.optimal_control.trajectory import DEGREE, Trajectory, radau_points
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Ledger
from vehicledyn.kernel.kernel import Kernel

Floats = NDArray[np.float64]

_STEP = 2e-3
_PREVIEW, _NEAREST = 0.8, 4.0
"""How far the driver looks ahead [s], and at least [m]."""

_QUICKNESS, _SPEED_TIME = 8.0, 0.5
"""Angular frequency of the driver's hands [1/s], and time in which he takes speed up [s]."""

_TRIAL, _TRIED = 0.6, 0.05
"""Time for which a control is tried [s], and at which part of its size."""

_FAR = 20.0
"""Distance to the path at which a vehicle is lost [m]."""


@dataclass(frozen=True)
class Vehicle:
    """What drives: place x, y and heading among the states, and the speed to hold [m/s]."""

    place: tuple[int, int]
    heading: int
    velocity: tuple[int, int]
    speed: float


class GuessDriver:
    """Drives a vehicle along a path and makes a trajectory of that.

    Parameters
    ----------
    problem
        Whose controls drive.
    path
        That of the problem.
    kernel
        Of the same equations.
    vehicle
        What to steer.
    """

    def __init__(
        self, problem: ControlProblem, path: Corridor, kernel: Kernel, vehicle: Vehicle
    ) -> None:
        self._problem, self._vehicle = problem, vehicle
        self._kernel = kernel.with_parameters(problem.parameters)
        self._curves = PathCurves(path)
        self._lap = (0.0, np.inf)
        self._low, self._high, self._size, self._rate = (
            np.array([getattr(c, k) for c in problem.controls])
            for k in ("low", "high", "size", "rate")
        )

    def drive(self, guess: Trajectory, *, laps: int) -> Trajectory | None:
        """Return the last of some laps on the mesh of a guess, or None if no control drives.

        The guess has the states and unknowns at the start, and the distances to go.

        Raises
        ------
        NumericalError
            If the vehicle leaves the path, or does not reach the end.
        """
        first, last = guess.first_distance, float(guess.distance[-1, -1])
        self._lap = (first, last - first) if laps > 1 else (0.0, np.inf)
        answers = self._answers(guess)
        if not answers[0].any():
            return None
        log = self._log(guess, answers, first + laps * (last - first))
        return self._on_mesh(guess, log, first + (laps - 1) * (last - first))

    def _on_mesh(self, guess: Trajectory, log: tuple[Floats, ...], begin: float) -> Trajectory:
        """Return what was driven from a distance on, on the mesh of a guess."""
        times, distance, states, unknowns, controls = log
        first, mesh, n = guess.first_distance, guess.mesh, guess.n_intervals
        started = float(np.interp(begin, distance, times))
        lasted = float(times[-1]) - started
        inner = (mesh[:-1, None] + np.diff(mesh)[:, None] * radau_points()).ravel()
        nodes, at = started + lasted * mesh, started + lasted * inner
        beginning = _seen(times, states, nodes[:1])[0]
        moved = self._moved(beginning, guess.first, round((begin - first) / self._lap[1]))
        values, rates = (_seen(times, controls[:, k], nodes) for k in (0, 1))
        placed, inside = _seen(times, states, at) + moved, _seen(times, controls[:, 0], at)
        solved = self._solved(placed, _seen(times, unknowns, at), inside)
        return Trajectory(
            float(np.clip(lasted, *self._problem.duration)),
            mesh,
            beginning + moved,
            placed.reshape(n, DEGREE, -1),
            solved.reshape(n, DEGREE, -1),
            first,
            (np.interp(at, times, distance) - (begin - first)).reshape(n, DEGREE),
            values,
            rates,
            np.diff(rates, axis=0) / np.diff(nodes)[:, None],
            inside.reshape(n, DEGREE, -1),
        )

    def _moved(self, state: Floats, start: Floats, laps: int) -> Floats:
        """Return what brings states back by some laps: to the start where they are bound to it."""
        p = self._problem
        if not laps:
            return np.zeros(state.size)
        moved = np.where(p.start[:, 0] == p.start[:, 1], start - state, 0.0)
        for k, growth in p.growth.items():
            moved[k] = -laps * growth
        return moved

    def _solved(self, states: Floats, unknowns: Floats, values: Floats) -> Floats:
        """Return the unknowns at states that were moved, near those from before."""
        found = unknowns.copy()
        for x, z, value in zip(states, found, values, strict=True):
            held = np.array([value, 0.0 * value, 0.0 * value])
            self._kernel.set_parameters(self._problem.parameters_with(held))
            self._kernel.evaluate(0.0, x.copy(), z, Ledger())
        return found

    def _answers(self, guess: Trajectory) -> tuple[Floats, Floats]:
        """Return curvature and forward acceleration that a unit of each control brings.

        Each control counts for what it does most of.
        """
        n = self._low.size
        found = np.array([self._tried(guess, np.zeros(n))] * 2)
        effects = np.zeros((n, 2))
        for k in range(n):
            sign = 1.0 if self._high[k] >= -self._low[k] else -1.0
            tried = np.zeros(n)
            tried[k] = sign * _TRIED * self._size[k]
            effects[k] = (self._tried(guess, tried) - found[0]) / tried[k]
        whole = np.abs(effects) * self._size[:, None]
        leading = whole == whole.max(axis=0)
        bend, push = (np.where(leading[:, j], effects[:, j], 0.0) for j in (0, 1))
        push[bend != 0.0] = 0.0
        return bend, push

    def _tried(self, guess: Trajectory, values: Floats) -> Floats:
        """Return curvature of the way and mean acceleration under constant controls."""
        v = self._vehicle
        x, z = guess.first.copy(), guess.unknowns[0, 0].copy()
        before, held = self._forward(x), np.array([values, 0.0 * values, 0.0 * values])
        for _ in range(int(_TRIAL / _STEP)):
            x, z = self._advance(x, z, held)
        turned = float(x[v.heading] - guess.first[v.heading])
        way = 0.5 * (before + self._forward(x)) * _TRIAL
        return np.array([turned / way, (self._forward(x) - before) / _TRIAL])

    def _forward(self, x: Floats) -> float:
        v = self._vehicle
        heading = x[v.heading]
        return float(x[v.velocity[0]] * np.cos(heading) + x[v.velocity[1]] * np.sin(heading))

    def _log(
        self, guess: Trajectory, answers: tuple[Floats, Floats], end: float
    ) -> tuple[Floats, ...]:
        """Return times, distances, states, unknowns and controls up to a distance."""
        x, z = guess.first.copy(), guess.unknowns[0, 0].copy()
        held, s, rows = np.zeros((3, self._low.size)), guess.first_distance, []
        held[0] = np.clip(0.0, self._low, self._high)
        most = int(3.0 * (end - s) / max(self._vehicle.speed, 1.0) / _STEP)
        for k in range(most):
            rows.append((k * _STEP, s, x, z, held.copy()))
            if s >= end:
                return tuple(np.array(column) for column in zip(*rows, strict=True))
            held = self._steered(held, x, s, answers)
            x, z = self._advance(x, z, held)
            place = (float(x[k]) for k in self._vehicle.place)
            gap, offset = self._curves.seen(self._on_lap(s), *place)
            if abs(float(offset)) > _FAR:
                raise NumericalError(
                    f"the vehicle is {_FAR:g} m beside the path at {s:.4g} m of it"
                )
            s += float(gap)
        raise NumericalError(f"the vehicle came {s:.4g} m far in {most * _STEP:.4g} s")

    def _steered(self, held: Floats, x: Floats, s: float, answers: tuple[Floats, Floats]) -> Floats:
        """Return the controls a step later."""
        v, (bend, push) = self._vehicle, answers
        speed = self._forward(x)
        ahead = max(_PREVIEW * speed, _NEAREST)
        place = self._middle(self._on_lap(s + ahead))
        to = place[0] - x[v.place[0]], place[1] - x[v.place[1]]
        error = np.arctan2(to[1], to[0]) - x[v.heading]
        error = np.arctan2(np.sin(error), np.cos(error))
        curvature = 2.0 * np.sin(error) / np.hypot(*to)
        wanted = np.zeros(self._low.size)
        wanted[bend != 0.0] = curvature / bend[bend != 0.0]
        wanted[push != 0.0] = (v.speed - speed) / _SPEED_TIME / push[push != 0.0]
        wanted = np.clip(wanted, self._low, self._high)
        value, rate = held[0], held[1]
        bent = _QUICKNESS**2 * (wanted - value) - 2.0 * _QUICKNESS * rate
        moved = np.clip(rate + _STEP * bent, -self._rate, self._rate)
        following = value + _STEP * moved
        return np.array([following, moved, (moved - rate) / _STEP])

    def _on_lap(self, s: float) -> float:
        """Return a distance on the first lap."""
        first, length = self._lap
        return s if np.isinf(length) else first + (s - first) % length

    def _middle(self, s: float) -> tuple[float, float]:
        """Return the place in the middle of the corridor."""
        x, y = (float(t.value(s)) for t in self._curves.tables[:2])
        dx, dy = (float(t.slope(s)) for t in self._curves.tables[:2])
        right, left = (float(v) for v in self._curves.sides(s))
        offset = 0.5 * (left - right) / np.hypot(dx, dy)
        return float(x - offset * dy), float(y + offset * dx)

    def _advance(self, x: Floats, z: Floats, held: Floats) -> tuple[Floats, Floats]:
        """Return states and unknowns a step later, by the classical Runge-Kutta method."""
        controls = held.copy()
        for k, item in enumerate(self._problem.controls):
            if item.order != BEND:
                controls[2, k] = 0.0
            if item.order not in (BEND, RAMP):
                controls[1, k] = 0.0
        self._kernel.set_parameters(self._problem.parameters_with(controls))
        z, rates = z.copy(), list[Floats]()
        for weight in (0.0, 0.5, 0.5, 1.0):
            at = x + weight * _STEP * rates[-1] if rates else x
            rates.append(self._kernel.evaluate(0.0, at, z, Ledger()))
        total = rates[0] + 2.0 * rates[1] + 2.0 * rates[2] + rates[3]
        following = x + _STEP / 6.0 * total
        if not np.isfinite(following).all():
            raise NumericalError("the vehicle left the finite numbers")
        return following, z


def _seen(times: Floats, table: Floats, at: Floats) -> Floats:
    """Return the columns of a table over time at other times, shape (n_at, n_columns)."""
    columns = [np.interp(at, times, column) for column in table.T]
    return np.array(columns).reshape(table.shape[1], len(at)).T
