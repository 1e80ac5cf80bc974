"""Derivatives of an equilibrium, and of the rates at a point, by parameters and states."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.bundle import Bundle
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.tangent_code import MotionPoint, TangentCode

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class BalancedState:
    """An equilibrium: all parameters, time [s], states and unknowns, and what was balanced.

    ``pairs`` are the states that were free and the rates that are zero.
    """

    parameters: Vector
    time: float
    point: tuple[Vector, Vector]
    pairs: tuple[list[int], list[int]]


def start_slopes(
    code: TangentCode, balance: BalancedState, by_parameter: Matrix, held: Matrix | None = None
) -> Matrix:
    """Return the derivatives of an equilibrium's states, shape (n_states, n_directions).

    0 = f_b(x, p) for the balanced rates b and the free states: dx = -(∂f_b/∂x)⁻¹ df_b.

    Parameters
    ----------
    code
        Compiled derivatives.
    balance
        The equilibrium.
    by_parameter
        Tangents of the parameters, shape (n_parameters, n_directions).
    held
        Tangents of the states that are not free, shape (n_states, n_directions).

    Raises
    ------
    NumericalError
        If the equilibrium does not follow the parameters.
    """
    free, balanced = balance.pairs
    slopes = np.zeros((len(balance.point[0]), by_parameter.shape[1])) if held is None else held
    slopes = slopes.copy()
    slopes[free] = 0.0
    rates = rate_slopes(code, balance, by_parameter)
    by_free, given = rates[0][np.ix_(balanced, free)], (rates[1] + rates[0] @ slopes)[balanced]
    found = -np.linalg.lstsq(by_free, given, rcond=1e-12)[0]
    missed = np.abs(by_free @ found + given)
    if np.any(missed > 1e-7 * np.max(np.abs(given), axis=0, initial=1e-12)):
        raise NumericalError("the equilibrium has no derivative: it is not isolated")
    slopes[free] = found
    return slopes


@dataclass(frozen=True)
class GivenSlopes:
    """Derivatives of the states that a start is given, each (n_states, n_directions).

    ``moving`` are those of the start, ``still`` those of the state that is balanced before.
    """

    moving: Matrix
    still: Matrix


@dataclass(frozen=True)
class BalancedStart:
    """A start in equilibrium, with ``others``, speeds that are given after the balance."""

    balance: BalancedState
    others: tuple[int, ...]

    def slopes(self, code: TangentCode, by_parameter: Matrix, given: GivenSlopes) -> Matrix:
        """Return the derivatives of the start (n_states, n_directions), see start_slopes."""
        found = start_slopes(code, self.balance, by_parameter, given.still)
        others = list(self.others)
        found[others] = given.moving[others]
        return found

    def with_tangents(
        self, tangents: Matrix, still: Matrix, direction: Vector, unknowns: int
    ) -> BalancedStart:
        """Return the same of equations with their tangents, along a direction of the parameters.

        ``tangents`` (n_states,) are those of the start, ``still`` those of the state that is
        balanced, of which the given ones count.
        """
        b, n = self.balance, len(tangents)
        own = still.copy()
        own[b.pairs[0]] = tangents[b.pairs[0]]
        point = np.concatenate([b.point[0], own]), np.pad(b.point[1], (0, unknowns))
        free, balanced = ([*part, *(k + n for k in part)] for part in b.pairs)
        parameters = np.concatenate([b.parameters, direction])
        balance = BalancedState(parameters, b.time, point, (free, balanced))
        return BalancedStart(balance, (*self.others, *(k + n for k in self.others)))


def rate_slopes(
    code: TangentCode, balance: BalancedState, by_parameter: Matrix
) -> tuple[Matrix, Matrix]:
    """Return dẋ/dx (n_states, n_states) and dẋ/dp (n_states, n_directions) on closed loops."""
    state, guess = (np.ascontiguousarray(item) for item in balance.point)
    n = len(state)
    constants = code.constants(balance.parameters)
    moved = np.asarray(code.constant_slopes(balance.parameters) @ by_parameter)
    bundle = Bundle(code, np.hstack([np.zeros((len(moved), n)), moved]))
    bundle.state = np.hstack([np.eye(n), np.zeros((n, by_parameter.shape[1]))])
    unknowns = code.solved(balance.time, state, guess, constants)
    found = bundle.rate_slopes(MotionPoint(balance.time, state, unknowns, constants))
    return found[:, :n], found[:, n:]
