"""Derivatives of a linearised system with inputs and outputs by all parameters at once.

With the matrix S = [A B; C D] of the motions that keep the loops closed, and rows l and columns r
that do not depend on the parameters,

    d(l S r) = d(l' J r'),    l' = l and the multipliers of the loops, r' = r and how they follow,

where J holds the partial derivatives of rates, loops and outputs. One reverse derivative gives it
for all parameters; how the equilibrium moves is added.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.eigenvalues import LinearPoint
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.kernel.interpreted import BufferedFunction
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]

_SINGULAR = 1e-11
"""Part of the largest singular value below which an equilibrium is free to move along a motion."""

_NEGLIGIBLE = 1e-7
"""Part of a gradient that may lie along such a motion, as rounding leaves it."""


@dataclass(frozen=True)
class Following:
    """How an equilibrium moves with the parameters.

    ``pushes`` are parameters that keep it balanced besides the free states, such as a thrust that
    holds the speed; ``by_held`` (n_states, n_parameters) is how states follow that are not free,
    known but for motions ``loose`` (n_loose, n_states).
    """

    pushes: tuple[int, ...]
    by_held: Floats
    loose: Floats | None = None

    def check(self, by_state: Complex | Floats) -> None:
        """Raise NumericalError if something with derivatives by states depends on loose motions."""
        if self.loose is not None and self.loose.size:
            _refuse_loose(self.loose, by_state)


class SystemDerivatives:
    """Derivatives of the linear system of some equations, of chosen inputs and outputs."""

    def __init__(
        self, equations: Equations, inputs: Sequence[int] = (), outputs: Sequence[int] = ()
    ) -> None:
        """Derive the functions; inputs are numbers of parameters, outputs of channels.

        Raises
        ------
        InputError
            If the states hold quaternions.
        """
        import casadi

        e = equations
        if e.attitudes:
            raise InputError(
                f"'{e.name}' has quaternions among its states, whose linear model has no "
                "derivatives here; give its joints three angles"
            )
        self.n_states, self.n_unknowns, self.inputs = len(e.states), len(e.unknowns), list(inputs)
        rows = [e.output[k] for k in outputs]
        values = casadi.cse(casadi.densify(casadi.vertcat(e.rate, e.residual, *rows)))
        driven = casadi.vertcat(e.state, e.algebraic, *[e.parameter[k] for k in inputs])
        everything = casadi.vertcat(e.state, e.algebraic, e.parameter)
        self.n_values = int(values.numel())
        left = casadi.SX.sym("left", self.n_values)
        right = casadi.SX.sym("right", driven.numel())
        point = [e.time, e.state, e.algebraic, e.parameter]

        def gradient(scalar: Any) -> Any:
            return casadi.densify(ops.jacobian(scalar, everything)).T

        first = gradient(casadi.dot(left, values))
        second = gradient(casadi.dot(left, ops.derivative(values, driven, right)))
        self.first = BufferedFunction(casadi.Function("first", [*point, left], [first]))
        self.second = BufferedFunction(casadi.Function("second", [*point, left, right], [second]))

    def at(self, point: LinearPoint, following: Following) -> LinearisedSlopes:
        """Return the system about a point, ready to be differentiated.

        Raises
        ------
        NumericalError
            If the loops are singular or derivatives are no finite numbers.
        """
        return LinearisedSlopes(self, point, following)


class LinearisedSlopes:
    """The linear system about a point: ``matrix`` is S = [A B; C D], with its derivatives.

    ``outputs`` are the derivatives of the outputs at the point, (n_outputs, n_parameters),
    ``states`` (n_states, n_parameters) how the point follows the parameters, ``loose`` the motions
    of free states and pushes along which nothing holds it, one a row.
    """

    def __init__(
        self, derivatives: SystemDerivatives, point: LinearPoint, following: Following
    ) -> None:
        """Evaluate the system at a point; see :meth:`SystemDerivatives.at`."""
        self._derivatives = derivatives
        self._given = (point.time, point.state, point.unknowns, point.parameters)
        n, m, size = derivatives.n_states, derivatives.n_unknowns, derivatives.n_values
        rows = [derivatives.first(*self._given, row)[0].ravel() for row in np.eye(size)]
        partial = np.array(rows).reshape(size, n + m + len(point.parameters))
        if not np.isfinite(partial).all():
            raise NumericalError("derivatives are no finite numbers where the model is linearised")
        try:
            inverse = np.linalg.inv(partial[n : n + m, n : n + m])
        except np.linalg.LinAlgError:
            raise NumericalError("the loops are singular where the model is linearised") from None
        kept = [*range(n), *range(n + m, size)]
        self._driven = [*range(n), *(n + m + k for k in derivatives.inputs)]
        self._follow = -inverse @ partial[n : n + m]
        self._multipliers = -partial[kept, n : n + m] @ inverse
        total = partial[kept] + partial[kept, n : n + m] @ self._follow
        self.matrix: Floats = np.asarray(total[:, self._driven], dtype=float)
        self._following, self._pushes = following, list(following.pushes)
        self._free = list(point.pairs[0])
        self.states, self._pushed, self.loose = self._equilibrium(
            total[:n], following.by_held, list(point.pairs[1])
        )
        self.outputs: Floats = np.array([self._followed(row).real for row in total[n:]]).reshape(
            len(total) - n, len(point.parameters)
        )

    @property
    def n_states(self) -> int:
        """Number of states: of the first rows and columns of the matrix."""
        return self._derivatives.n_states

    def slope(self, left: Complex, right: Complex) -> Complex:
        """Return the derivative of left S right by all parameters, shape (n_parameters,).

        Parameters
        ----------
        left
            Weights of rates and outputs, held fixed, shape (n_states + n_outputs,).
        right
            Weights of states and inputs, held fixed, shape (n_states + n_inputs,).

        Raises
        ------
        NumericalError
            If the equilibrium is not isolated and the value depends on where it is.
        """
        n, m = self._derivatives.n_states, self._derivatives.n_unknowns
        rows = np.concatenate([left[:n], left @ self._multipliers, left[n:]])
        follow = self._follow[:, self._driven] @ right
        columns = np.concatenate([right[:n], follow, right[n:]])
        gradient = np.zeros(n + m + len(self._given[3]), dtype=complex)
        for i, one in enumerate((rows.real, rows.imag)):
            for j, other in enumerate((columns.real, columns.imag)):
                if one.any() and other.any():
                    found = self._derivatives.second(*self._given, one, other)[0].ravel()
                    gradient += 1j ** (i + j) * found
        if not np.isfinite(gradient).all():
            raise NumericalError("second derivatives are no finite numbers at this point")
        return self._followed(gradient + gradient[n : n + m] @ self._follow)

    def matrix_slopes(self) -> Floats:
        """Return the derivatives of all entries, (n_rows, n_columns, n_parameters)."""
        n_rows, n_columns = self.matrix.shape
        left, right = np.eye(n_rows, dtype=complex), np.eye(n_columns, dtype=complex)
        found = [[self.slope(one, other).real for other in right] for one in left]
        return np.array(found).reshape(n_rows, n_columns, len(self._given[3]))

    def _followed(self, gradient: Any) -> Complex:
        """Return the derivative by parameters of what has one by states and parameters."""
        n, m = self._derivatives.n_states, self._derivatives.n_unknowns
        by_state, by_parameter = gradient[:n], np.array(gradient[n + m :], dtype=complex)
        by_push = by_parameter[self._pushes]
        effects = np.concatenate([by_state[self._free], by_push])
        if self.loose.size:
            _refuse_loose(self.loose, effects)
        self._following.check(by_state)
        by_parameter[self._pushes] = 0.0
        moved = by_parameter + by_state @ self.states + by_push @ self._pushed
        return np.asarray(moved, dtype=complex)

    def _equilibrium(
        self, total: Floats, by_held: Floats, balanced: list[int]
    ) -> tuple[Floats, Floats, Floats]:
        """Return how states and pushes move, and motions along which the point is loose."""
        n, m, free = self._derivatives.n_states, self._derivatives.n_unknowns, self._free
        states, by_parameter = by_held.copy(), total[:, n + m :].copy()
        states[free] = 0.0
        pushes = [n + m + k for k in self._pushes]
        if not free and not pushes:
            return states, np.zeros((0, by_parameter.shape[1])), np.zeros((0, 0))
        by_parameter[:, self._pushes] = 0.0
        drive = (by_parameter + total[:, :n] @ states)[balanced]
        left, sizes, right = np.linalg.svd(total[np.ix_(balanced, [*free, *pushes])])
        rank = int(np.sum(sizes > _SINGULAR * np.max(sizes, initial=0.0)))
        found = -right[:rank].T @ ((left[:, :rank].T @ drive) / sizes[:rank, None])
        states[free] = found[: len(free)]
        return states, np.asarray(found[len(free) :], dtype=float), right[rank:]


def _refuse_loose(loose: Floats, effects: Complex | Floats) -> None:
    """Refuse derivatives by what may move by itself."""
    if np.any(np.abs(loose @ effects) > _NEGLIGIBLE * np.max(np.abs(effects), initial=1e-300)):
        raise NumericalError("the equilibrium has no derivative: it is not isolated")


def mode_slope(system: LinearisedSlopes, value: complex, shape: Complex, fixed: int) -> Complex:
    """Return the derivative of a mode shape whose element ``fixed`` is held at 1.

    (A - λ) dv - v dλ = -dA v,    dv_fixed = 0

    Parameters
    ----------
    system
        The linearised system.
    value
        Its eigenvalue λ, which must be simple [1/s].
    shape
        The eigenvector v with the fixed element 1, shape (n_states,).
    fixed
        Number of the element.

    Returns
    -------
    Complex
        Shape (n_states, n_parameters).

    References
    ----------
    Nelson (1976), AIAA Journal 14(9), 1201-1205; here with dλ among the unknowns.
    """
    n = system.n_states
    right = np.concatenate([shape, np.zeros(system.matrix.shape[1] - n)])
    units = np.eye(len(system.matrix), dtype=complex)[:n]
    driven = np.array([system.slope(unit, right) for unit in units])
    bordered = np.zeros((n + 1, n + 1), dtype=complex)
    bordered[:n, :n] = system.matrix[:n, :n] - value * np.eye(n)
    bordered[:n, n], bordered[n, fixed] = -shape, 1.0
    found = np.linalg.solve(bordered, np.vstack([-driven, np.zeros((1, driven.shape[1]))]))
    return np.asarray(found[:n], dtype=complex)
