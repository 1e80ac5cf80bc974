"""The cycles of a hunting study as rows of its table: the motion of the watched channels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.cycle_points import CyclePoint
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.results.tables.hunt_table import CycleRow

_PHASES = 101
_BEHIND = 4
"""Points an interval at which the range of a channel is looked for."""


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
        )

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
