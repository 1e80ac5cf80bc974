"""Hands the samples of a run on in the order of its first equations, whatever kernel made them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.integrate.accuracy.monitor import AccuracyMonitor
from vehicledyn.integrate.task import Sink
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic.equations import Equations

Vector = NDArray[np.float64]


@dataclass
class Delivery:
    """Takes samples of any kernel of a run, shows them to the watch and hands them on.

    A channel, state or unknown that a later kernel lacks is not a number.
    """

    first: Equations
    sink: Sink
    watch: AccuracyMonitor | None = None
    _pick: tuple[Equations, list[list[int]]] | None = field(default=None, init=False)

    def take(
        self, kernel: Kernel, times: Vector, states: Vector, unknowns: Vector, outputs: Vector
    ) -> None:
        """Hand samples on, one row each.

        Raises
        ------
        DivergenceError
            If a state has grown beyond all measure; the samples before are handed on.
        """
        if not len(times):
            return
        parts = [states, unknowns, outputs]
        if kernel.equations is not self.first:
            parts = self._in_first_order(kernel.equations, unknowns, outputs)
        sound = len(times)
        if self.watch is not None:
            sound = self.watch.take(kernel, times, states, unknowns, parts[2])
        if sound:
            self.sink(times[:sound], *[part[:sound] for part in parts])
        if self.watch is not None:
            self.watch.refuse_divergence()

    def _in_first_order(
        self, equations: Equations, unknowns: Vector, outputs: Vector
    ) -> list[Vector]:
        """Return states, unknowns and outputs of the first equations."""
        if self._pick is None or self._pick[0] is not equations:
            columns = {c.name: k for k, c in enumerate(equations.channels)}
            columns.update({u.name: k + len(columns) for k, u in enumerate(equations.unknowns)})
            first: list[Any] = [self.first.states, self.first.unknowns, self.first.channels]
            self._pick = equations, [[columns.get(i.name, -1) for i in items] for items in first]
        table = np.hstack([outputs, unknowns, np.full((len(outputs), 1), np.nan)])
        return [table[:, pick] for pick in self._pick[1]]
