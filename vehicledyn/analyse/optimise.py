"""Constrained optimisation with exact gradients: scaling, optimiser and first-order optimality.

The optimisers are scipy's; here are the scaling of variables to their bounds and of figures to
their sizes, evaluations that are kept, and the check of the Karush-Kuhn-Tucker conditions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.interior_point import NonlinearProgram, Pattern, minimise
from vehicledyn.base.errors import NumericalError

Floats = NDArray[np.float64]

_ACTIVE = 1e-5
"""Distance of a constraint or bound to its limit, scaled, within which it is active."""

_STATIONARY = 1e-5
"""Optimality below which a point is an optimum, however the search ended."""

_NEAR = 1e-6
"""Part of the squares of what is missed that the last step towards the constraints may gain."""

_LAST_STEP = 1e-12
"""Relative step and scaled gradient at which a search of least squares ends."""

METHODS = ("slsqp", "ipopt")
"""Optimisers for constrained problems."""

_WORSE = 10.0
"""Sizes of the objective that a point without a motion is worse than the start."""


@dataclass(frozen=True)
class Values:
    """An objective, its gradient (n,), constraints c >= 0 (m,) and their gradients (m, n).

    ``residuals`` (r,) and ``residual_slopes`` (r, n) are those whose squares, halved, add up to the
    objective, none where it is no such sum.
    """

    objective: float
    gradient: Floats
    constraints: Floats
    jacobian: Floats
    residuals: Floats | None = None
    residual_slopes: Floats | None = None


@dataclass(frozen=True)
class Optimum:
    """The best point that was found.

    ``variables`` (n,) in SI with the :class:`Values` there; ``optimality`` is the largest part of
    the scaled gradient that no active constraint or bound takes, ``violation`` the largest scaled
    one; ``multipliers`` (m,) are zero where a constraint is not active; ``n_runs`` counts
    evaluations, ``failures`` those that came to nothing. ``message`` says how the search ended.
    """

    variables: Floats
    values: Values
    optimality: float
    violation: float
    multipliers: Floats
    at_bound: list[int]
    n_runs: int
    failures: list[str]
    message: str
    history: list[tuple[Floats, float, float]] = field(default_factory=list)

    @property
    def is_feasible(self) -> bool:
        """Whether all constraints are kept."""
        return self.violation <= _ACTIVE


def optimise(
    evaluate: Callable[[Floats], Values],
    *,
    start: Floats,
    bounds: tuple[Floats, Floats],
    tolerance: float,
    most_runs: int,
    method: str = "slsqp",
) -> Optimum:
    """Return where an objective is least within bounds and constraints.

    Where the search finds no point that keeps all constraints, the squares of what they are
    missed by are made least: either the search goes on from there, or no such point is near.

    Parameters
    ----------
    evaluate
        Returns objective and constraints; raises NumericalError where there are none.
    start
        Point to begin at, shape (n,), within the bounds.
    bounds
        Lowest and highest values, shape (n,) each.
    tolerance
        Part of the objective's size that the last step may still gain.
    most_runs
        Evaluations after which the best point so far is returned.
    method
        One of :data:`METHODS`; sums of squares without constraints are sought by scipy's
        trust-region least squares instead of SLSQP.

    Raises
    ------
    NumericalError
        If nothing can be evaluated at the start.

    References
    ----------
    Kraft (1988), A software package for sequential quadratic programming, DFVLR-FB 88-28.
    Branch, Coleman, Li (1999), SIAM Journal on Scientific Computing 21, 1-23, least squares.
    """
    search = _Search(evaluate, bounds, most_runs)
    scaled = (start - bounds[0]) / search.width
    first = search.at(scaled)

    def sought(begin: Floats) -> str:
        if method == "ipopt":
            return _by_ipopt(search, begin, tolerance, most_runs)
        if first.residuals is not None and not len(first.constraints):
            return _by_least_squares(search, begin, tolerance)
        return _by_slsqp(search, begin, tolerance, most_runs)

    stopped = f"stopped after {most_runs} runs"
    try:
        message = sought(scaled)
    except _EnoughError:
        message = stopped
    if search.is_feasible:
        return search.best(message)
    search.approach()
    try:
        nearest = _least_missed(search, search.nearest)
        message = sought(nearest) if search.is_feasible else message
    except _EnoughError:
        message = stopped
    return search.best(message)


_ENDS = {
    8: "no step gains anything, though the point is not stationary; figures may have corners",
    9: "it took the most iterations allowed",
}
"""What SLSQP's ends mean, by its own numbers."""

_NO_WAY = "it found no way on from linear constraints that exclude each other"
_VAGUE = "steps gain nothing any more, though the point is not stationary"


def _by_slsqp(search: _Search, start: Floats, tolerance: float, most: int) -> str:
    from scipy.optimize import minimize

    found = minimize(
        lambda x: search.scaled(x)[0],
        start,
        jac=lambda x: search.scaled(x)[1],
        bounds=[(0.0, 1.0)] * len(start),
        constraints=search.constraints,
        method="SLSQP",
        options={"ftol": tolerance, "maxiter": most},
    )
    return "" if found.success else _ENDS.get(int(found.status), _NO_WAY)


def _by_ipopt(search: _Search, start: Floats, tolerance: float, most: int) -> str:
    n, m = len(start), len(search.scaled(start)[2])
    dense = Pattern(np.tile(np.arange(m), n), np.arange(n + 1) * m)

    def values(x: Floats) -> tuple[float, Floats]:
        value, _, constraints, _ = search.scaled(x)
        return value, constraints

    def slopes(x: Floats) -> tuple[Floats, Floats]:
        _, gradient, _, jacobian = search.scaled(x)
        return gradient, np.reshape(jacobian, (m, n)).T.ravel()

    limits = np.zeros(m), np.full(m, np.inf)
    program = NonlinearProgram((np.zeros(n), np.ones(n)), limits, values, slopes, dense)
    found = minimise(program, start, {"tol": tolerance, "max_iter": most})
    return "" if found.is_optimal else found.status.replace("_", " ").lower()


def _by_least_squares(search: _Search, start: Floats, tolerance: float) -> str:
    return _squared(search.residuals, start, tolerance)[1]


def _least_missed(search: _Search, start: Floats) -> Floats:
    """Return where the squares of what constraints are missed by are least, near a start."""
    return _squared(search.missed, start, _NEAR)[0]


def _squared(
    residuals: Callable[[Floats], tuple[Floats, Floats]], start: Floats, tolerance: float
) -> tuple[Floats, str]:
    """Return where a sum of squares is least, and how the search ended if not well."""
    from scipy.optimize import least_squares

    found = least_squares(
        lambda x: residuals(x)[0],
        start,
        jac=lambda x: residuals(x)[1],
        bounds=(0.0, 1.0),
        xtol=_LAST_STEP,
        ftol=tolerance,
        gtol=_LAST_STEP,
    )
    return np.asarray(found.x, dtype=float), "" if found.success else _VAGUE


class _EnoughError(Exception):
    """Ends a search after the runs that it may take."""


class _Search:
    """Evaluations of a search, in variables between 0 and 1."""

    def __init__(
        self, evaluate: Callable[[Floats], Values], bounds: tuple[Floats, Floats], most: int
    ) -> None:
        self._evaluate, self._most = evaluate, most
        self._is_approaching = False
        self._low, self.width = bounds[0], bounds[1] - bounds[0]
        self._known: dict[bytes, Values] = {}
        self._points: list[tuple[Floats, Values]] = []
        self.size, self.failures = 1.0, list[str]()
        self._scales = np.zeros(0)

    def at(self, x: Floats) -> Values:
        """Return what is known of a point; one without a motion is far worse than the start."""
        x = np.clip(x, 0.0, 1.0)
        key = x.tobytes()
        if key not in self._known:
            if len(self._known) >= self._allowed():
                raise _EnoughError
            self._known[key] = self._new(x)
        return self._known[key]

    def approach(self) -> None:
        """Spend on the way to the constraints what was saved for it."""
        self._is_approaching = True

    def _allowed(self) -> int:
        """Return how many runs may be taken: half of them while no point keeps the constraints."""
        return self._most if self._is_approaching or self.is_feasible else (self._most + 1) // 2

    def _new(self, x: Floats) -> Values:
        point = self._low + self.width * x
        try:
            found = self._evaluate(point)
        except NumericalError as error:
            if not self._points:
                raise
            self.failures.append(str(error))
            first = self._points[0][1]
            worse = first.objective + _WORSE * self.size
            return replace(
                first,
                objective=worse,
                residuals=None if first.residuals is None else first.residuals * _WORSE,
            )
        if not self._points:
            self.size = max(
                abs(found.objective), float(np.max(np.abs(found.gradient * self.width)))
            )
            self.size = self.size or 1.0
            slopes = np.max(np.abs(found.jacobian * self.width), axis=1, initial=0.0)
            self._scales = np.maximum(np.abs(found.constraints), slopes)
            self._scales[self._scales == 0.0] = 1.0
        self._points.append((x.copy(), found))
        return found

    def scaled(self, x: Floats) -> tuple[float, Floats, Floats, Floats]:
        """Return scaled objective, gradient, constraints and their gradients at a point."""
        found = self.at(x)
        rows = found.jacobian * self.width / self._scales[:, None]
        gradient = found.gradient * self.width / self.size
        return found.objective / self.size, gradient, found.constraints / self._scales, rows

    def residuals(self, x: Floats) -> tuple[Floats, Floats]:
        """Return residuals and their gradients of the scaled objective."""
        found, size = self.at(x), np.sqrt(self.size)
        assert found.residuals is not None
        assert found.residual_slopes is not None
        return found.residuals / size, found.residual_slopes * self.width / size

    def missed(self, x: Floats) -> tuple[Floats, Floats]:
        """Return by how much scaled constraints are missed, zero where kept, and the gradients."""
        _, _, constraints, rows = self.scaled(x)
        is_missed = constraints < 0.0
        return np.where(is_missed, -constraints, 0.0), np.where(is_missed[:, None], -rows, 0.0)

    @property
    def nearest(self) -> Floats:
        """The known point with the least squares of what constraints are missed by."""
        return min(self._points, key=self._squares)[0]

    @property
    def is_feasible(self) -> bool:
        """Whether a known point keeps all constraints."""
        return any(self._violation(found) <= _ACTIVE for _, found in self._points)

    @property
    def constraints(self) -> list[dict[str, object]]:
        """Constraints as scipy takes them."""
        if not self._scales.size:
            return []
        return [
            {
                "type": "ineq",
                "fun": lambda x: self.scaled(x)[2],
                "jac": lambda x: self.scaled(x)[3],
            }
        ]

    def _squares(self, item: tuple[Floats, Values]) -> float:
        """Return the squares of what scaled constraints are missed by."""
        return float(np.sum(np.minimum(item[1].constraints / self._scales, 0.0) ** 2))

    def _violation(self, found: Values) -> float:
        return float(np.max(-found.constraints / self._scales, initial=0.0))

    def best(self, message: str) -> Optimum:
        """Return the best point: the least objective of those that keep the constraints."""
        allowed = [item for item in self._points if self._violation(item[1]) <= _ACTIVE]
        if allowed:
            x, found = min(allowed, key=lambda item: item[1].objective)
        else:
            x, found = min(self._points, key=self._squares)
        optimality, multipliers, at_bound = self._stationarity(x, found)
        if allowed and optimality <= _STATIONARY:
            message = ""
        history = [
            (self._low + self.width * x, item.objective, self._violation(item))
            for x, item in self._points
        ]
        return Optimum(
            self._low + self.width * x,
            found,
            optimality,
            self._violation(found),
            multipliers * self.size / self._scales if multipliers.size else multipliers,
            at_bound,
            len(self._known),
            self.failures,
            message or "converged",
            history,
        )

    def _stationarity(self, x: Floats, found: Values) -> tuple[float, Floats, list[int]]:
        """Return what no active constraint takes of the gradient, and the multipliers."""
        from scipy.optimize import nnls

        gradient = found.gradient * self.width / self.size
        scaled = found.constraints / self._scales
        active = [k for k, value in enumerate(scaled) if value <= _ACTIVE]
        lower, upper = np.flatnonzero(x <= _ACTIVE), np.flatnonzero(x >= 1.0 - _ACTIVE)
        unit = np.eye(len(x))
        rows = found.jacobian[active] * self.width / self._scales[active][:, None]
        columns = np.vstack([rows, unit[lower], -unit[upper]]).T
        multipliers = np.zeros(len(scaled))
        if not columns.shape[1]:
            return float(np.max(np.abs(gradient))), multipliers, []
        weights, _ = nnls(columns, gradient)
        multipliers[active] = weights[: len(active)]
        left = float(np.max(np.abs(columns @ weights - gradient)))
        return left, multipliers, sorted({*map(int, lower), *map(int, upper)})
