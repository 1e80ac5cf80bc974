"""Steps of Newmark's family on the rates of a kernel, with a kept iteration matrix.

Velocities get the generalised-alpha formulas for second-order equations, all other states those
for first-order ones with the same weights, so both are of order two. The loops are solved inside
the rates, so the unknowns of a step are the accelerations of the independent coordinates.

Chung, Hulbert (1993), Journal of Applied Mechanics 60, 371-375; Arnold, Brüls (2007), Multibody
System Dynamics 18, 185-202; Jansen, Whiting, Hulbert (2000), Computer Methods in Applied Mechanics
and Engineering 190, 305-319 (first-order states).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.events import Point
from vehicledyn.integrate.newmark.weights import Weights
from vehicledyn.integrate.rate_slopes import slopes_of_rates
from vehicledyn.integrate.task import Task
from vehicledyn.kernel.engine import Vector

_MOST_ITERATIONS = 20
_CLOSE = 1e-12
"""Error of Newton's iteration allowed in each state, for one plus its size."""
_SLOW = 0.3
"""Contraction above which the Jacobian is found anew at the next step."""
_ROUNDING = 1e-10
"""Change that is taken for rounding where it no longer falls."""


@dataclass(frozen=True)
class ReducedPlace:
    """A point with its rates and the auxiliary rates that a step of size ``size`` [s] left.

    ``change`` is what the step added to the auxiliary rates, None where the motion starts.
    """

    point: Point
    rates: Vector
    auxiliary: Vector
    size: float
    change: Vector | None = None


class ReducedForm:
    """Places and weights of the states of some equations in a step, and their Jacobian.

    ``rows`` are all states but positions; ``pairs`` say where velocities stand among them.
    ``new_mass`` and ``gamma`` are the weights of each row.
    """

    def __init__(self, task: Task, weights: Weights) -> None:
        """Derive the Jacobian, or take that which was derived for these equations before."""
        self._task, self._weights = task, weights
        equations = task.kernel.equations
        self._slopes = slopes_of_rates(task.kernel, task.progress)
        self.positions, self.velocities = list(equations.positions), list(equations.velocities)
        is_position = np.isin(np.arange(len(equations.states)), self.positions)
        self.rows = np.flatnonzero(~is_position)
        second = np.isin(self.rows, self.velocities)
        w = weights
        self.new_mass = np.where(second, 1.0 - w.alpha_m, w.first_order_mass)
        self.gamma = np.where(second, w.gamma, w.first_order_gamma)
        self.pairs = np.searchsorted(self.rows, self.velocities)

    def jacobian(self, point: Point) -> Vector:
        """Return the derivatives of the rates of the rows by all states, along closed loops."""
        found: Vector = self._slopes(*point, self._task.kernel.parameters)[self.rows]
        return found

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

    newmark.c holds the same algorithm; change both together.
    """

    def __init__(self, task: Task, weights: Weights) -> None:
        """Begin without a Jacobian."""
        self._task, self._weights = task, weights
        form = self._form = ReducedForm(task, weights)
        self._positions, self._velocities = form.positions, form.velocities
        self._rows, self._pairs = form.rows, form.pairs
        self._new_mass, self._gamma = form.new_mass, form.gamma
        self._jacobian: Vector | None = None
        self._factors: Any = None
        self._size = 0.0
        self._is_stale = True

    def start(self, point: Point) -> ReducedPlace:
        """Return the place from which the motion starts, or starts anew."""
        unknowns = point.unknowns.copy()
        kernel = self._task.kernel
        rates = kernel.evaluate(point.time, point.state, unknowns, self._task.ledger)
        self._is_stale = True
        return ReducedPlace(Point(point.time, point.state, unknowns), rates, rates[self._rows], 0.0)

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
        for iteration in range(_MOST_ITERATIONS):
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
            if size * contraction / max(1.0 - contraction, 1e-3) < _CLOSE and iteration:
                return self._accepted(Point(end, x + moved, z), new, known, h, old)
            if size == 0.0 or (contraction > 0.5 and size < _ROUNDING):
                return self._accepted(Point(end, x + moved, z), new, known, h, old)
            if contraction > 0.9:
                return None
            before = size
        return None

    def _accepted(
        self, point: Point, new: Vector, known: Vector, h: float, old: Vector
    ) -> ReducedPlace:
        """Return the end of a step, with the rates that it demands there."""
        rates = np.zeros(len(point.state))
        rates[self._rows] = (self._new_mass * new + known) / (1.0 - self._weights.alpha_f)
        return ReducedPlace(point, rates, new, h, new - old)

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

    def _prepare(self, point: Point, h: float) -> None:
        """Find Jacobian and factors where they are missing, stale or of another size."""
        from scipy.linalg import lu_factor  # slow to import, so only where it is needed

        if self._is_stale or self._jacobian is None:
            self._jacobian = self._form.jacobian(point)
            self._is_stale, self._size = False, 0.0
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
