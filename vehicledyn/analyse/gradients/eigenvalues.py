"""Derivatives of the eigenvalues of a linearised motion by all parameters at once.

For A v = λ v, yᴴ A = λ yᴴ and an equilibrium x(p) the derivative is that of a scalar,

    dλ = d(yᴴ A(x(p), p) v) / yᴴ v

The loops are kept by multipliers that make the scalar stationary, so one reverse derivative gives
it for all parameters; a second one adds how the equilibrium moves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.interpreted import BufferedFunction
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations

Complex = NDArray[np.complex128]

_ALIKE = 1e-8
"""Distance of eigenvalues, as a part of their size, within which they have no derivative."""

_CHORDS, _GAIN = 15, 0.5
"""Steps with the slopes of a point beside an equilibrium, and what the rates must fall by in each,
which ends where rounding does not let them."""

_SMALL = 20_000
"""Operations up to which the derivatives by all motions are one function, which grows faster than
they; of larger equations they are evaluated row by row."""

_DIFFERENCE = 1e-6
"""How far a state is moved to both sides to see roughly how the rates follow [its unit]."""


@dataclass(frozen=True)
class LinearPoint:
    """A point to linearise about: all parameters, time [s], states and unknowns.

    ``pairs`` are the states that were free to find it and the rates that are zero, both empty for
    a point that is given.
    """

    parameters: Vector
    time: float
    state: Vector
    unknowns: Vector
    pairs: tuple[Sequence[int], Sequence[int]] = ((), ())


@dataclass(frozen=True)
class EigenSlopes:
    """Eigenvalues (n,) and their derivatives by parameters (n, n_parameters).

    ``by_held`` (n, n_states) are those by states that are not free, zero for the others. Of
    eigenvalues that coincide with another they are not numbers.
    """

    values: Complex
    by_parameter: Complex
    by_held: Complex


class EigenDerivatives:
    """Derivatives of the eigenvalues of some equations."""

    def __init__(self, equations: Equations) -> None:
        """Derive the functions.

        Raises
        ------
        InputError
            If the states hold quaternions.
        """
        import casadi

        if equations.attitudes:
            raise InputError(
                f"'{equations.name}' has quaternions among its states, whose eigenvalues have no "
                "derivatives here; give its joints three angles"
            )
        e = self._equations = equations
        self._n_x, self._n_z = len(e.states), len(e.unknowns)
        n_x, n_z = self._n_x, self._n_z
        self._n = n_x + n_z
        motion = casadi.vertcat(e.state, e.algebraic)
        everything = casadi.vertcat(motion, e.parameter)
        values = casadi.cse(casadi.densify(casadi.vertcat(e.rate, e.residual)))
        left, right = casadi.SX.sym("left", self._n), casadi.SX.sym("right", self._n)
        point = [e.time, e.state, e.algebraic, e.parameter]

        def gradient(scalar: Any) -> Any:
            return casadi.densify(ops.jacobian(scalar, everything)).T

        first = gradient(casadi.dot(left, values))
        second = gradient(casadi.dot(left, ops.derivative(values, motion, right)))
        step = casadi.SX.sym("step", e.parameter.numel())
        forward = casadi.densify(ops.derivative(values, e.parameter, step))
        self._forward = BufferedFunction(casadi.Function("forward", [*point, step], [forward]))
        self._first = BufferedFunction(casadi.Function("first", [*point, left], [first]))
        self._whole: BufferedFunction | None = None
        if casadi.Function("values", point, [values]).n_instructions() <= _SMALL:
            whole = casadi.densify(ops.jacobian(values, motion))
            self._whole = BufferedFunction(casadi.Function("whole", point, [whole]))
        self._latest: tuple[LinearPoint, _Motions] | None = None
        self._second = BufferedFunction(casadi.Function("second", [*point, left, right], [second]))

    def eigenvalues(self, point: LinearPoint) -> Complex:
        """Return the eigenvalues about a point, shape (n_states,) [1/s]."""
        found: Complex = np.linalg.eigvals(self._motions(point).matrix).astype(complex)
        return found

    def equilibrium(self, point: LinearPoint, held: Vector) -> tuple[Vector, Vector]:
        """Return the derivatives of an equilibrium's states and unknowns by all parameters.

        ``held`` (n_states, n_parameters) are those of the states that are not free.

        Raises
        ------
        NumericalError
            If the loops are singular, or the equilibrium is not isolated.
        """
        motions = self._motions(point)
        weights = motions.equilibrium_left(np.eye(self._n_x, dtype=complex)).real.T
        by_parameter = self._rows(point)[:, self._n :]
        closed = -np.linalg.solve(motions.loops, by_parameter[self._n_x :])
        held = held.copy()
        held[motions.free] = 0.0
        rates = by_parameter[: self._n_x] + motions.by_unknown @ closed + motions.matrix @ held
        states = weights @ rates + held
        return states, motions.follow @ states + closed

    def along(self, point: LinearPoint, parameter: int, held: Vector) -> Vector:
        """Return how the states of an equilibrium follow one parameter, shape (n_states,).

        ``held`` (n_states,) is how those follow it that are not free.
        """
        motions, n_x = self._motions(point), self._n_x
        unit = np.eye(len(point.parameters))[parameter]
        given = (point.time, point.state, point.unknowns, point.parameters)
        column = self._forward(*given, unit)[0].ravel()
        rates = column[:n_x] - motions.by_unknown @ np.linalg.solve(motions.loops, column[n_x:])
        moved = held.copy()
        moved[motions.free] = 0.0
        if motions.free:
            rates = (rates + motions.matrix @ moved)[list(point.pairs[1])]
            moved[motions.free] = -np.linalg.lstsq(motions.balance, rates, rcond=1e-12)[0]
        return moved

    def balanced(
        self, point: LinearPoint, kernel: Kernel, state: Vector, tolerance: float
    ) -> LinearPoint | None:
        """Return the equilibrium near a state, sought with the slopes of a point beside it.

        Parameters
        ----------
        point
            An equilibrium beside it, of other parameters.
        kernel
            The model with the parameters of the one that is sought.
        state
            States to start from, shape (n_states,).
        tolerance
            Largest rate that counts as zero.

        Returns
        -------
        LinearPoint | None
            The equilibrium, or None where these slopes do not lead to it.
        """
        motions = self._motions(point)
        free, rows = list(point.pairs[0]), list(point.pairs[1])
        if not free:
            return None
        trial, unknowns = state.copy(), point.unknowns
        best, least = None, np.inf
        try:
            for _ in range(_CHORDS):
                guess = unknowns + motions.follow @ (trial - point.state)
                solved = kernel.solve_unknowns(point.time, trial, guess)
                rates = kernel.rates(point.time, trial, solved)[rows]
                size = float(np.max(np.abs(rates)))
                if not size < _GAIN * least:
                    break
                least = size
                if size <= tolerance:
                    best = replace(
                        point, parameters=kernel.parameters, state=trial.copy(), unknowns=solved
                    )
                trial[free] -= np.linalg.lstsq(motions.balance, rates, rcond=1e-12)[0]
        except NumericalError:
            return best
        return best

    def rough_eigenvalues(self, point: LinearPoint, base: LinearPoint, kernel: Kernel) -> Complex:
        """Return the eigenvalues about a point from differences of rates, good to some digits.

        Compiled rates make them in a part of the time that exact derivatives take. ``base`` is a
        point beside it, whose loops move alike, ``kernel`` the model with the point's parameters.
        """
        follow, matrix = self._motions(base).follow, []
        for column, unit in enumerate(_DIFFERENCE * np.eye(self._n_x)):
            found = []
            for moved in (unit, -unit):
                state, solved = point.state + moved, point.unknowns
                if solved.size:
                    guess = solved + moved[column] * follow[:, column]
                    solved = kernel.solve_unknowns(point.time, state, guess)
                found.append(kernel.rates(point.time, state, solved))
            matrix.append((found[0] - found[1]) / (2.0 * _DIFFERENCE))
        values: Complex = np.linalg.eigvals(np.array(matrix).T).astype(complex)
        return values

    def at(
        self, point: LinearPoint, chosen: Callable[[Complex], Sequence[int]] | None = None
    ) -> EigenSlopes:
        """Return eigenvalues about a point and their derivatives.

        Parameters
        ----------
        point
            The point.
        chosen
            Returns the numbers of those wanted, given all of them; all are wanted if None.

        Raises
        ------
        NumericalError
            If the loops are singular, or the equilibrium is not isolated.
        """
        n_x, motions = self._n_x, self._motions(point)
        given = (point.time, point.state, point.unknowns, point.parameters)
        values, vectors = np.linalg.eig(motions.matrix)
        values, vectors = values.astype(complex), vectors.astype(complex)
        which = list(range(n_x) if chosen is None else chosen(values))
        try:
            lefts = np.linalg.inv(vectors)
        except np.linalg.LinAlgError:
            raise NumericalError(
                "the linearised motion has a defective eigenvalue, which has no derivative"
            ) from None
        rows = [
            self._slope(given, motions, lefts[k], vectors[:, k])
            if is_apart(values, k)
            else np.full(n_x + len(point.parameters), np.nan + 0j)
            for k in which
        ]
        whole = np.array(rows).reshape(len(which), n_x + len(point.parameters))
        return EigenSlopes(values[which], whole[:, n_x:], whole[:, :n_x])

    def _motions(self, point: LinearPoint) -> _Motions:
        """Return the motions at a point; those of the latest point are kept."""
        if self._latest is None or self._latest[0] is not point:
            self._latest = point, self._new_motions(point)
        return self._latest[1]

    def _new_motions(self, point: LinearPoint) -> _Motions:
        n_x, n = self._n_x, self._n
        given = (point.time, point.state, point.unknowns, point.parameters)
        if self._whole is None:
            partial = self._rows(point)[:, :n]
        else:
            partial = self._whole(*given)[0].reshape(n, n)
        if not np.isfinite(partial).all():
            raise NumericalError("derivatives are no finite numbers where eigenvalues are wanted")
        try:
            follow = -np.linalg.solve(partial[n_x:, n_x:n], partial[n_x:, :n_x])
        except np.linalg.LinAlgError:
            raise NumericalError("the loops are singular where eigenvalues are wanted") from None
        return _Motions(partial, follow, point.pairs, n_x)

    def _rows(self, point: LinearPoint) -> Vector:
        """Return derivatives of rates and residuals by motions and parameters, row by row."""
        given = (point.time, point.state, point.unknowns, point.parameters)
        rows = [self._first(*given, row)[0].ravel() for row in np.eye(self._n)]
        return np.array(rows).reshape(self._n, self._n + len(point.parameters))

    def _by_parameter(self, given: Any, weights: Complex) -> Complex:
        """Return the derivative of weighted rates and residuals by the parameters."""
        found = np.zeros(len(given[3]), dtype=complex)
        for power, part in enumerate((weights.real, weights.imag)):
            if part.any():
                found += 1j**power * self._first(*given, part)[0].ravel()[self._n :]
        return found

    def _slope(self, given: Any, motions: _Motions, left: Complex, right: Complex) -> Complex:
        """Return the derivative by the states that are not free and by the parameters."""
        n_x, n = self._n_x, self._n
        y, v = motions.closed_left(left), motions.closed_right(right)
        gradient = np.zeros(n + len(given[3]), dtype=complex)
        for i, one in enumerate((y.real, y.imag)):
            for j, other in enumerate((v.real, v.imag)):
                if one.any() and other.any():
                    gradient += 1j ** (i + j) * self._second(*given, one, other)[0].ravel()
        by_state = gradient[:n_x] + motions.follow.T @ gradient[n_x:n]
        moved = motions.equilibrium_left(by_state)
        loops = motions.loops_left(gradient[n_x:n])
        weights = np.concatenate([moved, motions.loops_left_of(moved) + loops])
        by_parameter = gradient[n:] + self._by_parameter(given, weights)
        by_held = by_state + moved @ motions.matrix
        by_held[motions.free] = 0.0
        return np.concatenate([by_held, by_parameter])


class _Motions:
    """Motions that keep the loops closed and the equilibrium balanced."""

    def __init__(self, partial: Any, follow: Any, pairs: Any, n_x: int) -> None:
        n = n_x + len(follow)
        self.follow, self._n_x = follow, n_x
        self.matrix = partial[:n_x, :n_x] + partial[:n_x, n_x:n] @ follow
        self.by_unknown, self.loops = partial[:n_x, n_x:n], partial[n_x:, n_x:n]
        self.free, self._balanced = list(pairs[0]), list(pairs[1])

    @property
    def balance(self) -> Vector:
        """Derivatives of the balanced rates by the free states."""
        return np.asarray(self.matrix[np.ix_(self._balanced, self.free)], dtype=float)

    def closed_right(self, vector: Complex) -> Complex:
        """Return a motion of the states with that of the unknowns."""
        return np.concatenate([vector, self.follow @ vector])

    def closed_left(self, vector: Complex) -> Complex:
        """Return a left vector with the multipliers of the loops."""
        return np.concatenate([vector, self.loops_left_of(vector)])

    def loops_left_of(self, vector: Complex) -> Complex:
        """Return the multipliers that go with a left vector of the rates."""
        return self.loops_left(vector @ self.by_unknown)

    def loops_left(self, by_unknown: Complex) -> Complex:
        """Return the multipliers that take a derivative by the unknowns to the loops."""
        return np.asarray(-np.linalg.solve(self.loops.T, by_unknown), dtype=complex)

    def equilibrium_left(self, by_state: Complex) -> Complex:
        """Return the multipliers of the balanced rates that take derivatives by free states.

        One derivative, shape (n_states,), or several, one a column.
        """
        weights = np.zeros_like(by_state)
        if not self.free:
            return weights
        square, effects = self.balance, by_state[self.free]
        found = -np.linalg.lstsq(square.T, effects, rcond=1e-12)[0]
        missed = np.abs(square.T @ found + effects)
        if np.any(missed > 1e-6 * np.max(np.abs(effects), axis=0, initial=1e-300)):
            raise NumericalError("the equilibrium has no derivative: it is not isolated")
        weights[self._balanced] = found
        return weights


def is_apart(values: Complex, k: int) -> bool:
    """Return whether an eigenvalue is simple."""
    others = np.delete(values, k)
    size = max(1.0, float(np.max(np.abs(values), initial=0.0)))
    return bool(np.all(np.abs(others - values[k]) > _ALIKE * size))
