"""Steps of Radau's method IIA with exact tangents, many side by side.

The method is implicit and collocates, its last stage lies at the end of the step; motions that
decay do so however long the step is. Everything is scaled: states, rates and derivatives count
states in their scales.

References
----------
Hairer, Wanner (1996), Solving Ordinary Differential Equations II, section IV.5.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector

STAGES = 4
ORDER = 2 * STAGES - 1

_ITERATIONS = 7
_CONVERGED = 1e-7
"""Change of a state, part of its scale, from which on Newton's next step would be rounding."""

_ASTRAY = 1e3
"""Change at which Newton's method is given up."""


def _nodes_and_weights() -> tuple[Vector, Vector]:
    """Return the nodes of the method, the last one 1, and its weights A, square."""
    ahead = np.polynomial.legendre.Legendre.basis(STAGES)
    behind = np.polynomial.legendre.Legendre.basis(STAGES - 1)
    nodes = np.sort(0.5 * (1.0 + (ahead - behind).roots().real))
    nodes[-1] = 1.0
    powers = np.arange(1, STAGES + 1)
    return nodes, nodes[:, None] ** powers / powers @ np.linalg.inv(nodes[:, None] ** (powers - 1))


NODES, _WEIGHTS = _nodes_and_weights()


@dataclass
class TriedSteps:
    """Steps that were tried, k of them; ``found`` (k,) says where there is one.

    ``ends`` (k, n), their derivatives ``by_state`` (k, n, n) and ``by_parameter`` (k, n);
    ``rates`` (k, n) are those at the ends [1/s].
    """

    found: NDArray[np.bool_]
    ends: Vector
    by_state: Vector
    by_parameter: Vector
    rates: Vector

    @staticmethod
    def none(count: int, n: int) -> TriedSteps:
        """Return steps of which nothing is found yet."""
        return TriedSteps(
            np.zeros(count, dtype=bool),
            np.ones((count, n)),
            np.zeros((count, n, n)),
            np.ones((count, n)),
            np.ones((count, n)),
        )

    def enter(self, which: NDArray[np.intp], system: _System, stages: Vector) -> None:
        """Enter steps that are found, with their linear equations just before."""
        self.found[which] = True
        self.ends[which] = stages[:, -1]
        change = (stages - system.stages)[:, -1, :, None]
        self.rates[which] = system.rates[:, -1] + (system.by_state[:, -1] @ change)[:, :, 0]
        self.by_state[which], self.by_parameter[which] = system.tangents()


@dataclass(frozen=True)
class ParameterPoint:
    """A field at a value of its parameter, its states counted in scales (n,)."""

    field: AutonomousField
    scales: Vector
    parameter: float


def radau_steps(
    place: ParameterPoint, begin: Vector, stages: Vector, unknowns: Vector, durations: Vector
) -> TriedSteps:
    """Return steps from some states, found by Newton's method from a guess of their stages.

    Parameters
    ----------
    place
        The equations.
    begin
        States at the beginnings, shape (k, n).
    stages, unknowns
        Guess of the states and of the algebraic unknowns at the stages, (k, s, n) and (k, s, m).
    durations
        Lengths of the steps, shape (k,) [s].

    Raises
    ------
    NumericalError
        If the rates are no finite numbers, or the equations are singular.
    """
    count, _, n = stages.shape
    stages, unknowns = stages.copy(), unknowns.copy()
    weights = _WEIGHTS * durations[:, None, None]
    going, found = np.ones(count, dtype=bool), TriedSteps.none(count, n)
    for _ in range(_ITERATIONS):
        k = np.flatnonzero(going)
        system = _System.at(place, stages[k], unknowns[k], weights[k])
        change = system.newton(begin[k])
        size = np.abs(change).max(axis=(1, 2))
        stages[k] += change
        unknowns[k] -= system.followed(change)
        small = size < _CONVERGED
        if small.any():
            found.enter(k[small], system.part(small), stages[k[small]])
        going[k] = ~small & (size < _ASTRAY)
        if not going.any():
            break
    return found


@dataclass(frozen=True)
class _System:
    """The linear equations of Newton's method for the stages of steps, all scaled.

    Over k pieces and s stages: ``stages``, ``rates`` and ``by_parameter`` (k, s, n), ``by_state``
    (k, s, n, n), ``weights`` (k, s, s) [s] and ``matrix`` (k, s n, s n); ``gap`` (k, s, m) and
    ``follow`` (k, s, m, n) correct the m unknowns.
    """

    stages: Vector
    rates: Vector
    by_state: Vector
    by_parameter: Vector
    gap: Vector
    follow: Vector
    weights: Vector
    matrix: Vector

    @staticmethod
    def at(place: ParameterPoint, stages: Vector, unknowns: Vector, weights: Vector) -> _System:
        """Return the equations at stages."""
        count, n = len(stages), stages.shape[2]
        field, scales = place.field, place.scales
        found = field.evaluate(
            stages.reshape(-1, n) * scales,
            unknowns.reshape(STAGES * count, -1)
            if unknowns.size
            else np.zeros((STAGES * count, 0)),
            place.parameter,
        )
        by_state = (found.by_state * (scales / scales[:, None])).reshape(count, STAGES, n, n)
        pull = weights[:, :, :, None, None] * by_state[:, None]
        matrix = -np.transpose(pull, (0, 1, 3, 2, 4)).reshape(count, STAGES * n, STAGES * n)
        matrix[:, np.arange(STAGES * n), np.arange(STAGES * n)] += 1.0
        return _System(
            stages,
            (found.rates / scales).reshape(count, STAGES, n),
            by_state,
            (found.by_parameter / scales).reshape(count, STAGES, n),
            found.gap.reshape(count, STAGES, field.n_unknowns),
            (found.follow * scales).reshape(count, STAGES, field.n_unknowns, n),
            weights,
            matrix,
        )

    def newton(self, begin: Vector) -> Vector:
        """Return the change of the stages, shape (k, s, n)."""
        residual = self.stages - begin[:, None] - self.weights @ self.rates
        return _solve(self.matrix, -residual.reshape(len(begin), -1, 1)).reshape(self.stages.shape)

    def followed(self, change: Vector) -> Vector:
        """Return by how much the unknowns fall with a change of the stages, (k, s, m)."""
        return np.asarray(self.gap + (self.follow @ change[:, :, :, None])[:, :, :, 0])

    def tangents(self) -> tuple[Vector, Vector]:
        """Return the derivatives of the ends by the beginnings and by the parameter."""
        count, _, n = self.stages.shape
        known = np.empty((count, STAGES, n, n + 1))
        known[:, :, :, :n] = np.eye(n)
        known[:, :, :, n] = self.weights @ self.by_parameter
        solved = _solve(self.matrix, known.reshape(count, STAGES * n, n + 1))[:, -n:]
        return solved[:, :, :n], solved[:, :, n]

    def part(self, chosen: NDArray[np.bool_]) -> _System:
        """Return the equations of some of the steps."""
        if chosen.all():
            return self
        return _System(*(getattr(self, item.name)[chosen] for item in fields(self)))


def _solve(matrix: Vector, right: Vector) -> Vector:
    try:
        return np.asarray(np.linalg.solve(matrix, right))
    except np.linalg.LinAlgError:
        raise NumericalError("the equations of a step along a cycle are singular") from None
