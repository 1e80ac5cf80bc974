"""Constrained optimisation with exact gradients: scaling, optimiser and first-order optimality.

The optimisers are scipy's and IPOPT; here are the scaling of variables to their bounds and of
figures to their sizes, evaluations that are kept, and the check of the Karush-Kuhn-Tucker
conditions.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.first_order_optimality import ACTIVE, stationarity
from vehicledyn.analyse.interior_point import NonlinearProgram, Pattern, minimise
from vehicledyn.analyse.objective import Evaluated, FigureValue, parts_of
from vehicledyn.analyse.trust_region.figure_models import EvaluatedPoint
from vehicledyn.analyse.trust_region.search import PENALTY, VAGUE, ScaledTerms
from vehicledyn.analyse.trust_region.search import search as search_by_models
from vehicledyn.analyse.variable_box import VariableBox
from vehicledyn.base.errors import NumericalError

Floats = NDArray[np.float64]

_STATIONARY = 1e-5
"""Optimality below which a point is an optimum, however the search ended."""

_NEAR = 1e-6
"""Part of the squares of what is missed that the last step towards the constraints may gain."""

_LAST_STEP = 1e-12
"""Relative step and scaled gradient at which a search of least squares ends."""

METHODS = ("trust_region", "slsqp", "ipopt")
"""Optimisers for constrained problems."""

_WORSE = 10.0
"""Sizes of the objective that a point without a motion is worse than the start."""


@dataclass(frozen=True)
class Optimum:
    """The best point that was found.

    ``variables`` (n,) in SI, :class:`Evaluated` there; ``optimality`` is the largest part of
    the scaled gradient that no active constraint or bound takes, ``violation`` the largest scaled
    one; ``multipliers`` (m,) are zero where a constraint is not active; ``n_runs`` counts
    evaluations, ``failures`` those that came to nothing. ``message`` says how the search ended,
    ``was_stopped`` that it was for want of runs, before it came to a stationary point. ``size`` is
    what one of the scaled objective is.
    """

    variables: Floats
    values: Evaluated
    optimality: float
    violation: float
    multipliers: Floats
    at_bound: list[int]
    n_runs: int
    failures: list[str]
    message: str
    history: list[tuple[Floats, float, float]] = field(default_factory=list)
    was_stopped: bool = False
    size: float = 1.0

    @property
    def is_feasible(self) -> bool:
        """Whether all constraints are kept."""
        return self.violation <= ACTIVE


def optimise(
    evaluate: Callable[[Floats], Evaluated],
    *,
    start: Floats,
    bounds: tuple[Floats, Floats],
    tolerance: float,
    most_runs: int,
    method: str = "trust_region",
    least_size: float = 0.0,
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
        One of :data:`METHODS`: a trust region with models of all figures, which takes the fewest
        runs, or SLSQP, in whose place scipy's trust-region least squares seeks sums of squares
        without constraints, or IPOPT.
    least_size
        Size of the objective at least; at a start where it is near zero and stationary, nothing
        else tells it.

    Raises
    ------
    NumericalError
        If nothing can be evaluated at the start.

    References
    ----------
    Kraft (1988), A software package for sequential quadratic programming, DFVLR-FB 88-28.
    Branch, Coleman, Li (1999), SIAM Journal on Scientific Computing 21, 1-23, least squares.
    """
    search = _Search(evaluate, bounds, most_runs, least_size)
    scaled = search.box.shares(start)
    first = search.at(scaled)

    def sought(begin: Floats) -> str:
        if method == "trust_region":
            return search_by_models(search, begin, tolerance)
        if method == "ipopt":
            return _by_ipopt(search, begin, tolerance, most_runs)
        if first.residuals is not None and not len(first.constraints):
            return _by_least_squares(search, begin, tolerance)
        return _by_slsqp(search, begin, tolerance, most_runs)

    stopped = f"stopped after {most_runs} runs, the most allowed"
    try:
        message = sought(scaled)
    except _EnoughError:
        message = stopped
    if search.is_feasible:
        return search.best(message, was_stopped=message == stopped)
    search.approach()
    try:
        nearest = _least_missed(search, search.nearest)
        message = sought(nearest) if search.is_feasible else message
    except _EnoughError:
        message = stopped
    return search.best(message, was_stopped=message == stopped)


_ENDS = {
    8: "no step gains anything, though the point is not stationary; figures may have corners",
    9: "it took the most iterations allowed",
}
"""What SLSQP's ends mean, by its own numbers."""

_NO_WAY = "it found no way on from linear constraints that exclude each other"


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
    return np.asarray(found.x, dtype=float), "" if found.success else VAGUE


class _EnoughError(Exception):
    """Ends a search after the runs that it may take."""


@dataclass(frozen=True)
class _Known:
    """A point, scaled and not, with its evaluation by variables and by scaled variables."""

    shares: Floats
    point: Floats
    values: Evaluated
    scaled: Evaluated


class _Search:
    """Evaluations of a search, in variables between 0 and 1."""

    def __init__(
        self,
        evaluate: Callable[[Floats], Evaluated],
        bounds: tuple[Floats, Floats],
        most: int,
        least_size: float,
    ) -> None:
        self._evaluate, self._most = evaluate, most
        self._is_approaching = False
        self.box = VariableBox(*bounds)
        self._known: dict[bytes, Evaluated] = {}
        self._points: list[_Known] = []
        self._least_size = least_size
        self.size, self.failures = 1.0, list[str]()
        self._lost: set[bytes] = set()
        self._scales = np.zeros(0)

    def at(self, x: Floats) -> Evaluated:
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

    def _new(self, x: Floats) -> Evaluated:
        """Return an evaluation with derivatives by the scaled variables."""
        point = self.box.point(x)
        try:
            found = self._evaluate(point)
        except NumericalError as error:
            if not self._points:
                raise
            self.failures.append(str(error))
            self._lost.add(x.tobytes())
            first = self._points[0].scaled
            worse = first.objective + _WORSE * self.size
            return replace(
                first,
                objective=worse,
                residuals=None if first.residuals is None else first.residuals * _WORSE,
            )
        scaled = self.box.by_shares(found, point)
        if not self._points:
            own = max(abs(found.objective), float(np.max(np.abs(scaled.gradient))))
            self.size = max(own, self._least_size) or 1.0
            slopes = np.max(np.abs(scaled.jacobian), axis=1, initial=0.0)
            self._scales = np.maximum(np.abs(found.constraints), slopes)
            self._scales[self._scales == 0.0] = 1.0
        self._points.append(_Known(x.copy(), point, found, scaled))
        return scaled

    def scaled(self, x: Floats) -> tuple[float, Floats, Floats, Floats]:
        """Return scaled objective, gradient, constraints and their gradients at a point."""
        found = self._terms(self.at(x))
        return found.objective, found.gradient, found.constraints, found.jacobian

    def _terms(self, found: Evaluated) -> ScaledTerms:
        """Return what is scaled of an evaluation."""
        rows = found.jacobian / self._scales[:, None]
        gradient, constraints = found.gradient / self.size, found.constraints / self._scales
        return ScaledTerms(found.objective / self.size, gradient, constraints, rows)

    def run(self, x: Floats) -> tuple[EvaluatedPoint, ScaledTerms] | None:
        """Return a run at a point with gradients by the scaled variables, None if it fails."""
        found = self.at(x)
        if np.clip(x, 0.0, 1.0).tobytes() in self._lost:
            return None
        return EvaluatedPoint(x, parts_of(found).figures), self._terms(found)

    def terms(self, figures: Mapping[str, FigureValue]) -> ScaledTerms:
        """Return what figures make together."""
        return self._terms(parts_of(self._points[0].scaled).compose(figures))

    @property
    def is_squares(self) -> bool:
        """Whether the objective is a sum of squares."""
        return self._points[0].scaled.residuals is not None

    def optimality(self, x: Floats, terms: ScaledTerms) -> float:
        """Return the largest part of the gradient that no active constraint or bound takes."""
        return stationarity(x, terms)[0]

    def price(self, x: Floats, terms: ScaledTerms) -> float:
        """Return the sum of the multipliers of constraints, what a violation of all would gain."""
        return float(stationarity(x, terms)[1].sum())

    def residuals(self, x: Floats) -> tuple[Floats, Floats]:
        """Return residuals and their gradients of the scaled objective."""
        found, size = self.at(x), np.sqrt(self.size)
        assert found.residuals is not None
        assert found.residual_slopes is not None
        return found.residuals / size, found.residual_slopes / size

    def missed(self, x: Floats) -> tuple[Floats, Floats]:
        """Return by how much scaled constraints are missed, zero where kept, and the gradients."""
        _, _, constraints, rows = self.scaled(x)
        is_missed = constraints < 0.0
        return np.where(is_missed, -constraints, 0.0), np.where(is_missed[:, None], -rows, 0.0)

    @property
    def nearest(self) -> Floats:
        """The known point with the least squares of what constraints are missed by."""
        return min(self._points, key=self._squares).shares

    @property
    def is_feasible(self) -> bool:
        """Whether a known point keeps all constraints."""
        return any(self._violation(item) <= ACTIVE for item in self._points)

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

    def _squares(self, item: _Known) -> float:
        """Return the squares of what scaled constraints are missed by."""
        return float(np.sum(np.minimum(item.scaled.constraints / self._scales, 0.0) ** 2))

    def _violation(self, item: _Known) -> float:
        return self._terms(item.scaled).violation

    def best(self, message: str, *, was_stopped: bool) -> Optimum:
        """Return the best point that keeps the constraints, with a price on what is let through."""
        allowed = [item for item in self._points if self._violation(item) <= ACTIVE]
        if allowed:
            best = min(allowed, key=lambda item: self._terms(item.scaled).merit(PENALTY))
        else:
            best = min(self._points, key=self._squares)
        left, multipliers, at_bound = stationarity(best.shares, self._terms(best.scaled))
        if allowed and left <= _STATIONARY:
            message, was_stopped = "", False
        return Optimum(
            best.point,
            best.values,
            left,
            self._violation(best),
            multipliers * self.size / self._scales if multipliers.size else multipliers,
            at_bound,
            len(self._known),
            self.failures,
            message or "converged",
            [(item.point, item.values.objective, self._violation(item)) for item in self._points],
            was_stopped,
            self.size,
        )
