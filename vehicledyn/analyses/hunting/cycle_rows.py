"""The cycles of a hunting study as rows of its table: the motion of the watched channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.cycle_points import CyclePoint, ahead
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.results.tables.hunt_table import CycleRow

_PHASES = 101
_BEHIND = 4
"""Points an interval at which the range of a channel is looked for."""
_PART = 1e-4
"""Part of an orbit's change along its branch with which derivatives are found by differences."""


class CycleRows:
    """Makes rows of cycles, each once.

    Parameters
    ----------
    kernel, model
        The model.
    watched
        Indices of the channels.
    """

    def __init__(self, kernel: Kernel, model: AutonomousField, watched: Sequence[int]) -> None:
        self._kernel, self._model, self._watched = kernel, model, list(watched)
        self._known: dict[int, tuple[CyclePoint, CycleRow]] = {}

    def row(self, number: int, point: CyclePoint) -> CycleRow:
        """Return a cycle of a branch with the motion of the watched channels."""
        if id(point) not in self._known:
            self._known[id(point)] = point, self._made(point)
        return replace(self._known[id(point)][1], branch=number)

    def _made(self, point: CyclePoint) -> CycleRow:
        orbit = point.orbit
        widths = orbit.widths[:, None]
        places = (orbit.mesh[:-1, None] + widths * np.arange(_BEHIND) / _BEHIND).ravel()
        values = self._channels(point, places)
        even = np.linspace(0.0, 1.0, _PHASES)
        motion = self._channels(point, even % 1.0)
        return CycleRow(
            0,
            orbit.parameter,
            orbit.period,
            point.stable,
            point.kind,
            point.multipliers.trivial,
            point.multipliers.all,
            -np.array([_top(places, -column) for column in values.T]),
            np.array([_top(places, column) for column in values.T]),
            motion,
            self._direction(point, places, values),
        )

    def _direction(self, point: CyclePoint, places: Vector, values: Vector) -> Vector | None:
        """Return the changes of parameter, period and amplitudes along the branch.

        The range of a channel changes as its values where they are extreme, since there it does
        not change with the phase. Central differences along the direction of the continuation.
        """
        orbit, along = point.orbit, point.tangent
        if along.states.shape != orbit.states.shape:
            return None
        ends = np.concatenate([values.argmax(axis=0), values.argmin(axis=0)])
        sides = [
            self._channels(replace(point, orbit=ahead(orbit, along, size)), places[ends])
            for size in (-_PART, _PART)
        ]
        change = (sides[1] - sides[0]) / (2.0 * _PART)
        count = values.shape[1]
        own = np.arange(count)
        amplitudes = 0.5 * (change[own, own] - change[count + own, own])
        return np.array([along.parameter, along.period, *amplitudes])

    def _channels(self, point: CyclePoint, places: Vector) -> Vector:
        kernel = self._kernel.with_parameters(self._model.parameters(point.orbit.parameter))
        states, unknowns = point.orbit.sample(places)
        rows = []
        for state, guess in zip(self._model.full(states), unknowns, strict=True):
            solved = kernel.solve_unknowns(0.0, state, guess) if guess.size else guess
            rows.append(kernel.outputs(0.0, state, solved)[self._watched])
        return np.array(rows)


def _top(places: Vector, values: Vector) -> float:
    """Return the largest value of a periodic channel, with a parabola through neighbours."""
    k = int(np.argmax(values))
    around = [k - 1, k, (k + 1) % len(values)]
    x = places[around] - places[k]
    x[0] -= 1.0 if x[0] > 0.0 else 0.0
    x[2] += 1.0 if x[2] < 0.0 else 0.0
    y = values[around]
    a, b, c = np.polyfit(x / x[2], y, 2)
    top = float(c - b * b / (4.0 * a)) if a < 0.0 else float(values[k])
    return top if float(values[k]) <= top < float(values[k]) + np.ptp(values) else float(values[k])
