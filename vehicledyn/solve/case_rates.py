"""Rates of many cases at once, with the unknowns of each solved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.solve.batch import Batch
from vehicledyn.solve.engine import Ledger, Status, Vector
from vehicledyn.solve.lanes import LaneEngine

Flags = NDArray[np.bool_]


class CaseRates:
    """Evaluates the rates of cases, each with its own parameters, side by side in lanes.

    The rates of a case do not depend on the number of lanes, nor on its neighbours.
    """

    def __init__(self, batch: Batch, parameters: Vector) -> None:
        """Prepare what depends on the parameters alone; shape (n_cases, n_parameters)."""
        self._kernel, self._engine = batch.kernel, batch.engine
        if self._engine is None:
            self._constants = [
                self._kernel.engine.prepare(np.ascontiguousarray(row)) for row in parameters
            ]
        else:
            self._constants = [
                self._engine.prepare(self._engine.spread(parameters[first : first + batch.lanes]))
                for first in range(0, len(parameters), batch.lanes)
            ]

    def __call__(
        self, time: float, states: Vector, unknowns: Vector, wanted: Flags
    ) -> tuple[Vector, Flags]:
        """Solve the unknowns of cases in place and return their rates.

        Parameters
        ----------
        time
            Time [s].
        states
            Shape (n_cases, n_states).
        unknowns
            Guesses, shape (n_cases, n_unknowns); left as they are where they are not solved.
        wanted
            Which cases to evaluate, shape (n_cases,).

        Returns
        -------
        tuple
            Rates (n_cases, n_states), and which of the cases were solved and are finite.
        """
        rates = np.full(states.shape, np.nan)
        if self._engine is None:
            for index in np.flatnonzero(wanted):
                self._one(int(index), time, states, unknowns, rates)
        else:
            lanes = self._engine.lanes
            for number, first in enumerate(range(0, len(states), lanes)):
                group = slice(first, min(first + lanes, len(states)))
                if wanted[group].any():
                    self._group(self._engine, number, time, group, (states, unknowns, rates))
        return rates, wanted & np.isfinite(rates).all(axis=1)

    def _one(
        self, index: int, time: float, states: Vector, unknowns: Vector, rates: Vector
    ) -> None:
        kernel, constants = self._kernel, self._constants[index]
        x, z, ledger = np.ascontiguousarray(states[index]), unknowns[index].copy(), Ledger()
        if kernel.engine.solve(time, x, z, constants, ledger) is not Status.SOLVED:
            return
        blocks = kernel.equations.blocks
        residuals = (kernel.engine.block(k, time, x, z, constants)[0] for k in range(len(blocks)))
        for block, residual in zip(blocks, residuals, strict=True):
            if not np.abs(residual).max() <= block.tolerance:
                return
        unknowns[index], rates[index] = z, kernel.engine.rates(time, x, z, constants)

    def _group(
        self,
        engine: LaneEngine,
        number: int,
        time: float,
        group: slice,
        arrays: tuple[Vector, Vector, Vector],
    ) -> None:
        states, unknowns, rates = arrays
        x, z = engine.spread(states[group]), engine.spread(unknowns[group])
        found, fate = engine.rates(time, x, z, self._constants[number])
        solved = np.flatnonzero(fate.status[: group.stop - group.start] == Status.SOLVED)
        for lane in solved:
            rates[group.start + lane] = found[: rates.shape[1], lane]
            unknowns[group.start + lane] = z[: unknowns.shape[1], lane]
