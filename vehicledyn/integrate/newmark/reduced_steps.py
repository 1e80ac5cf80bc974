"""Steps of Newmark's family on the rates of a kernel, with a kept iteration matrix.

Velocities get the generalised-alpha formulas for second-order equations, all other states those
for first-order ones with the same weights, so both are of order two. The loops are solved inside
the rates, so the unknowns of a step are the accelerations of the independent coordinates.

Chung, Hulbert (1993), Journal of Applied Mechanics 60, 371-375; Arnold, Brüls (2007), Multibody
System Dynamics 18, 185-202; Jansen, Whiting, Hulbert (2000), Computer Methods in Applied Mechanics
and Engineering 190, 305-319 (first-order states).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.course import MethodState
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.newmark.matrix_pattern import matrix_pattern
from vehicledyn.integrate.newmark.weights import Weights
from vehicledyn.integrate.task import Task
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.kernel.engine import Ledger, Vector
from vehicledyn.kernel.kernel import Kernel

_MOST_ITERATIONS, _MOST_TO_THE_END = 20, 60
_CLOSE, _COARSEST = 1e-13, 1e-6
"""Bounds of the error of Newton's iteration allowed in each state, for one plus its size."""
_SLOW = 0.3
"""Contraction above which the Jacobian is found anew at the next step."""
_ROUNDING = 1e-10
"""Change that is taken for rounding where it no longer falls."""
_SMALL_SHARE = 1e-3
"""Part of the local error below which Newton's method takes more iterations."""


@dataclass(frozen=True)
class ReducedPlace:
    """A point with its rates and the auxiliary rates that a step of size ``size`` [s] left.

    ``change`` and ``drift`` are what the step added to the auxiliary rates and to the unknowns,
    None where the motion starts.
    """

    point: ConsistentPoint
    rates: Vector
    auxiliary: Vector
    size: float
    change: Vector | None = None
    drift: Vector | None = None


class ReducedForm:
    """Places and weights of the states of some equations in a step, and their Jacobian.

    ``rows`` are all states but positions; ``pairs`` say where velocities stand among them.
    ``new_mass`` and ``gamma`` are the weights of each row.
    """

    def __init__(self, kernel: Kernel, weights: Weights) -> None:
        """Find the places and weights."""
        self._kernel, self._weights = kernel, weights
        equations = kernel.equations
        self.positions, self.velocities = list(equations.positions), list(equations.velocities)
        is_position = np.isin(np.arange(len(equations.states)), self.positions)
        self.rows = np.flatnonzero(~is_position)
        second = np.isin(self.rows, self.velocities)
        w = weights
        self.new_mass = np.where(second, 1.0 - w.alpha_m, w.first_order_mass)
        self.gamma = np.where(second, w.gamma, w.first_order_gamma)
        self.pairs = np.searchsorted(self.rows, self.velocities)

    def start(self, point: ConsistentPoint, ledger: Ledger) -> ReducedPlace:
        """Return the place from which the motion starts, or starts anew."""
        unknowns = point.unknowns.copy()
        rates = self._kernel.evaluate(point.time, point.state, unknowns, ledger)
        return ReducedPlace(
            ConsistentPoint(point.time, point.state, unknowns), rates, rates[self.rows], 0.0
        )

    def resumed(self, point: ConsistentPoint, numbers: Vector, ledger: Ledger) -> ReducedPlace:
        """Return the place from which steps go on that end a piece of a run with these numbers."""
        begun, n = self.start(point, ledger), len(self.rows)
        size, lead, change, drift = np.split(numbers, [1, 1 + n, 1 + 2 * n])
        return replace(
            begun, auxiliary=begun.auxiliary + lead, size=float(size[0]), change=change, drift=drift
        )

    def numbers(self, place: ReducedPlace) -> Vector | None:
        """Return what steps go on with behind a place, None where the motion starts anew there."""
        if place.change is None or place.drift is None:
            return None
        lead = place.auxiliary - place.rates[self.rows]
        return np.concatenate([[place.size], lead, place.change, place.drift])

    def jacobian(self, point: ConsistentPoint) -> Vector:
        """Return the derivatives of the rates of the rows by all states, along closed loops."""
        kernel = self._kernel
        if "total derivatives" not in kernel.made:
            kernel.made["total derivatives"] = Derivatives(
                kernel.equations, outputs=False, often=not kernel.key
            )
        derivatives: Derivatives = kernel.made["total derivatives"]
        return derivatives.total(*point, kernel.parameters).rates[self.rows]

    def error(self, before: ReducedPlace, after: ReducedPlace) -> float:
        """Return the largest local error of a step about, for one plus the size of each state."""
        if after.change is None:
            return 0.0
        by_rates = self._weights.error_of_rates(
            after.size, after.change, before.size, before.change
        )
        error = np.zeros(len(after.point.state))
        error[self.rows] = by_rates
        moved = after.change[self.pairs]
        error[self.positions] = self._weights.error_of_positions(after.size, moved)
        return float(np.abs(error / (1.0 + np.abs(after.point.state))).max(initial=0.0))


class ReducedSteps:
    """Takes steps of any size, keeping Jacobian and factors while Newton's method converges.

    kernel/newmark/step.c holds the same algorithm; change both together. The Jacobian here is
    exact, that of the compiled code consists of differences.
    """

    def __init__(self, task: Task, weights: Weights) -> None:
        """Begin without a Jacobian."""
        self._task, self._weights = task, weights
        form = self._form = ReducedForm(task.kernel, weights)
        self._positions, self._velocities = form.positions, form.velocities
        self._rows, self._pairs = form.rows, form.pairs
        self._new_mass, self._gamma = form.new_mass, form.gamma
        self._jacobian: Vector | None = None
        self._fewest = self._wasted = 0
        self._factors: Any = None
        self._size = 0.0
        self._is_stale = True

    def start(self, point: ConsistentPoint) -> ReducedPlace:
        """Return the place from which the motion starts, or starts anew."""
        self._is_stale = True
        return self._form.start(point, self._task.ledger)

    def resumed(self, point: ConsistentPoint, numbers: Vector) -> ReducedPlace:
        """Return the place from which a run goes on, see :meth:`ReducedForm.resumed`."""
        return self._form.resumed(point, numbers, self._task.ledger)

    def carried(self, place: ReducedPlace) -> MethodState:
        """Return what a run goes on with behind a place."""
        return MethodState(self._form.numbers(place))

    def step(self, place: ReducedPlace, end: float) -> ReducedPlace | None:
        """Return the end of a step, or None where Newton's method does not converge."""
        was_stale = self._is_stale or self._jacobian is None
        found = self._iterate(place, end)
        if found is None and not was_stale:
            self._is_stale = True
            found = self._iterate(place, end)
        return found

    def _iterate(self, place: ReducedPlace, end: float) -> ReducedPlace | None:
        """Iterate from auxiliary rates that change as they did in the step before."""
        (time, state, unknowns), w = place.point, self._weights
        h, rows = end - time, self._rows
        ratio = h / place.size if place.size else 1.0
        old = place.rates[rows] + ratio * (place.auxiliary - place.rates[rows])
        self._prepare(place.point, h)
        known = (1.0 - self._new_mass) * old - w.alpha_f * place.rates[rows]
        guess = old if place.change is None else old + ratio * place.change
        new, z, before = guess.copy(), unknowns.copy(), np.inf
        if place.drift is not None:
            z += ratio * place.drift
        for iteration in range(_MOST_TO_THE_END if w.share < _SMALL_SHARE else _MOST_ITERATIONS):
            x = self._moved(state, h, old, new)
            try:
                rates = self._rates(end, x, z)
            except NumericalError:
                return None
            residual = self._new_mass * new + known - (1.0 - w.alpha_f) * rates[rows]
            change = self._solve(residual)
            new = new - change
            moved = self._moved(state, h, old, new) - x
            size = float(np.abs(moved / (1.0 + np.abs(x))).max(initial=0.0))
            if not np.isfinite(size):
                return None
            contraction = size / before if iteration else 0.0
            self._is_stale = self._is_stale or (contraction > _SLOW and size > _ROUNDING)
            reached = self._reached(ConsistentPoint(end, x + moved, z), new, known, old, place)
            allowed = min(max(w.share * self.error(place, reached), _CLOSE), _COARSEST)
            settled = size * contraction / max(1.0 - contraction, 1e-3) < allowed and iteration
            if settled or size == 0.0 or (contraction > 0.5 and size < _ROUNDING):
                self._count_waste(iteration + 1)
                return reached
            if contraction > 0.9:
                return None
            before = size
        return None

    def _count_waste(self, evaluations: int) -> None:
        """Find a Jacobian anew that has cost more evaluations than a new one takes."""
        self._fewest = min(self._fewest or evaluations, evaluations)
        self._wasted += evaluations - self._fewest
        if self._wasted and self._wasted > len(matrix_pattern(self._task.kernel).colour_starts) - 1:
            self._is_stale = True

    def _reached(
        self, point: ConsistentPoint, new: Vector, known: Vector, old: Vector, before: ReducedPlace
    ) -> ReducedPlace:
        """Return the end of a step, with the rates that it demands there."""
        rates = np.zeros(len(point.state))
        rates[self._rows] = (self._new_mass * new + known) / (1.0 - self._weights.alpha_f)
        size, drift = point.time - before.point.time, point.unknowns - before.point.unknowns
        return ReducedPlace(point, rates, new, size, new - old, drift)

    def outputs(self, place: ReducedPlace) -> Vector | None:
        """Return nothing: the channels are those of the equations."""
        return None

    def error(self, before: ReducedPlace, after: ReducedPlace) -> float:
        """Return the largest local error of a step about, see :meth:`ReducedForm.error`."""
        return self._form.error(before, after)

    def _rates(self, time: float, x: Vector, z: Vector) -> Vector:
        return self._task.kernel.evaluate(time, x, z, self._task.ledger)

    def _moved(self, state: Vector, h: float, old: Vector, new: Vector) -> Vector:
        """Return the state at the end of a step by Newmark's formulas."""
        x, w, pairs = state.copy(), self._weights, self._pairs
        x[self._rows] += h * ((1.0 - self._gamma) * old + self._gamma * new)
        bend = (0.5 - w.beta) * old[pairs] + w.beta * new[pairs]
        x[self._positions] += h * (state[self._velocities] + h * bend)
        return x

    def _prepare(self, point: ConsistentPoint, h: float) -> None:
        """Find Jacobian and factors where they are missing, stale or of another size."""
        from scipy.linalg import lu_factor  # slow to import, so only where it is needed

        if self._is_stale or self._jacobian is None:
            self._jacobian = self._form.jacobian(point)
            self._is_stale, self._size = False, 0.0
            self._fewest = self._wasted = 0
        if self._size and abs(h - self._size) <= 1e-9 * self._size:
            return
        by_new = self._jacobian[:, self._rows] * (h * self._gamma)
        bend = self._weights.beta * h**2
        by_new[:, self._pairs] += bend * self._jacobian[:, self._positions]
        matrix = np.diag(self._new_mass) - (1.0 - self._weights.alpha_f) * by_new
        self._factors, self._size = lu_factor(matrix) if matrix.size else None, h

    def _solve(self, residual: Vector) -> Vector:
        from scipy.linalg import lu_solve

        if self._factors is None:
            return residual
        return np.asarray(lu_solve(self._factors, residual, check_finite=False), dtype=float)
