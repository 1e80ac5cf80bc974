"""Derivatives of the eigenvalues of a linearised motion by all parameters at once.

For A v = λ v, yᴴ A = λ yᴴ and an equilibrium x(p) the derivative is that of a scalar,

    dλ = d(yᴴ A(x(p), p) v) / yᴴ v

The loops are kept by multipliers that make the scalar stationary, so one reverse derivative gives
it for all parameters; a second one adds how the equilibrium moves.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.interpreted import BufferedFunction
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations

Complex = NDArray[np.complex128]

_ALIKE = 1e-8
"""Distance of eigenvalues, as a part of their size, within which they have no derivative."""

_SMALL = 20_000
"""Operations up to which all partial derivatives are one function, which grows faster than they;
of larger equations they are evaluated row by row."""


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
        self._first = BufferedFunction(casadi.Function("first", [*point, left], [first]))
        self._whole: BufferedFunction | None = None
        if casadi.Function("values", point, [values]).n_instructions() <= _SMALL:
            whole = casadi.densify(ops.jacobian(values, everything))
            self._whole = BufferedFunction(casadi.Function("whole", point, [whole]))
        self._latest: tuple[LinearPoint, _Motions] | None = None
        self._second = BufferedFunction(casadi.Function("second", [*point, left, right], [second]))

    def eigenvalues(self, point: LinearPoint) -> Complex:
        """Return the eigenvalues about a point, shape (n_states,) [1/s]."""
        found: Complex = np.linalg.eigvals(self._motions(point).matrix).astype(complex)
        return found

    def equilibrium(self, point: LinearPoint) -> tuple[Vector, Vector]:
        """Return the derivatives of an equilibrium's states and unknowns by all parameters.

        Raises
        ------
        NumericalError
            If the loops are singular, or the equilibrium is not isolated.
        """
        motions = self._motions(point)
        rows = [motions.equilibrium_left(unit.astype(complex)).real for unit in np.eye(self._n_x)]
        weights = np.array(rows).reshape(self._n_x, self._n_x)
        loops, n = motions.partial[self._n_x :, self._n :], self._n
        closed = -np.linalg.solve(motions.loops, loops)
        rates = motions.partial[: self._n_x, n:] + motions.by_unknown @ closed
        states = weights @ rates
        return states, motions.follow @ states + closed

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
            rows = np.array([self._first(*given, row)[0].ravel() for row in np.eye(n)])
        else:
            rows = self._whole(*given)[0]
        partial = rows.reshape(n, n + len(point.parameters))
        if not np.isfinite(partial[:, :n]).all():
            raise NumericalError("derivatives are no finite numbers where eigenvalues are wanted")
        try:
            follow = -np.linalg.solve(partial[n_x:, n_x:n], partial[n_x:, :n_x])
        except np.linalg.LinAlgError:
            raise NumericalError("the loops are singular where eigenvalues are wanted") from None
        return _Motions(partial, follow, point.pairs, n_x)

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
        by_parameter = gradient[n:] + weights @ motions.partial[:, n:]
        by_held = by_state + moved @ motions.matrix
        by_held[motions.free] = 0.0
        return np.concatenate([by_held, by_parameter])


class _Motions:
    """Motions that keep the loops closed and the equilibrium balanced."""

    def __init__(self, partial: Any, follow: Any, pairs: Any, n_x: int) -> None:
        n = n_x + len(follow)
        self.partial, self.follow, self._n_x = partial, follow, n_x
        self.matrix = partial[:n_x, :n_x] + partial[:n_x, n_x:n] @ follow
        self.by_unknown, self.loops = partial[:n_x, n_x:n], partial[n_x:, n_x:n]
        self.free, self._balanced = list(pairs[0]), list(pairs[1])

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
        """Return the multipliers of the balanced rates that take a derivative by free states."""
        weights = np.zeros(self._n_x, dtype=complex)
        if not self.free:
            return weights
        square = self.matrix[np.ix_(self._balanced, self.free)]
        found = -np.linalg.lstsq(square.T, by_state[self.free], rcond=1e-12)[0]
        missed = np.abs(square.T @ found + by_state[self.free])
        if np.any(missed > 1e-6 * np.max(np.abs(by_state[self.free]), initial=1e-300)):
            raise NumericalError("the equilibrium has no derivative: it is not isolated")
        weights[self._balanced] = found
        return weights


def is_apart(values: Complex, k: int) -> bool:
    """Return whether an eigenvalue is simple."""
    others = np.delete(values, k)
    size = max(1.0, float(np.max(np.abs(values), initial=0.0)))
    return bool(np.all(np.abs(others - values[k]) > _ALIKE * size))
