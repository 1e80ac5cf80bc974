"""Search of an optimum where each step goes to the best point of models of all figures.

The models, through all that runs so far gave, cost no run; scipy's SLSQP seeks their best point
within a region around the best run. The region grows while a run gains what the models promised,
and shrinks otherwise.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.objective import FigureValue
from vehicledyn.analyse.trust_region.figure_models import EvaluatedPoint, FigureModels, ModelErrors

Floats = NDArray[np.float64]

_FIRST, _LEAST = 0.25, 1e-7
"""Reach of the region at first and at last, as parts of the variables' ranges."""

_GOOD, _BAD = 0.7, 0.2
"""Parts of the promised gain above and below which the region grows and shrinks."""

_KEPT = 1e-6
"""Scaled violation up to which constraints are kept at the end."""

_NEAR = 1e-5
"""Scaled distance to its limit within which a constraint may count as active."""

_STATIONARY = 1e-6
"""Optimality at which a search ends."""

PENALTY, _HARDEST = 10.0, 1e6
"""What a violation of one costs, at first and at most, in sizes of the objective."""

_SHRUNK = 0.7
"""Reach of the region after a bad step, as a part of that step: models know more by then."""

_LEAST_PRICE, _CHEAPER = 0.5, 0.5
"""What a violation costs at least in the comparison of runs, and as a part of what it did before.

It costs twice the sum of multipliers: more would forbid steps along a curved constraint.
"""

_MOST_DATA = 400
"""Values and gradients that a model is made of, of the runs closest to the best one."""

_TRIES = 6
"""How often a smaller region is tried where models promise nothing."""

_ROUNDING = 1e-18
"""Part of the first sum of squares that is rounding."""

_FINER = 1e-4
"""Part of the least gain wanted up to which models are searched."""

VAGUE = "steps gain nothing any more, though the point is not stationary"


class Scaled(Protocol):
    """Scaled objective and constraints, with their gradients by variables between 0 and 1."""

    @property
    def is_squares(self) -> bool:
        """Whether the objective is a sum of squares, which may vanish."""

    def run(self, x: Floats) -> tuple[EvaluatedPoint, ScaledTerms] | None:
        """Return a run at a point, None if it fails."""

    def terms(self, figures: Mapping[str, FigureValue]) -> ScaledTerms:
        """Return what figures, with gradients by the scaled variables, make together."""

    def optimality(self, x: Floats, terms: ScaledTerms) -> float:
        """Return what no active constraint or bound takes of the gradient."""

    def price(self, x: Floats, terms: ScaledTerms) -> float:
        """Return the sum of multipliers."""


@dataclass(frozen=True)
class ScaledTerms:
    """Scaled objective, gradient (n,), constraints c >= 0 (m,) and their gradients (m, n)."""

    objective: float
    gradient: Floats
    constraints: Floats
    jacobian: Floats

    @property
    def violation(self) -> float:
        """The largest violation of a constraint."""
        return float(np.max(-self.constraints, initial=0.0))

    def merit(self, penalty: float) -> float:
        """Return the objective and what the violation costs."""
        return self.objective + penalty * self.violation


def search(problem: Scaled, start: Floats, tolerance: float) -> str:
    """Seek an optimum from a start; return how the search ended, if not well.

    Parameters
    ----------
    problem
        What is sought; it keeps the runs.
    start
        Scaled variables, shape (n,).
    tolerance
        Part of the objective's size that a run must promise to gain, of what is left of it where
        it is a sum of squares.

    References
    ----------
    Alexandrov, Dennis, Lewis, Torczon (1998), Structural Optimization 15, 16-23, a trust-region
    framework for managing the use of approximation models.
    """
    first = problem.run(start)
    if first is None:
        return VAGUE
    state = _State(problem, [first], first)
    while True:
        is_kept = state.best[1].violation <= _KEPT
        if is_kept and not problem.is_squares and state.is_stationary(tolerance):
            return ""
        if not state.go_on(tolerance):
            return "" if is_kept else VAGUE
        if state.reach < _LEAST:
            return VAGUE


@dataclass
class _State:
    """Where a search has come to: its runs, the best of them, and what the next one may do."""

    problem: Scaled
    runs: list[tuple[EvaluatedPoint, ScaledTerms]]
    best: tuple[EvaluatedPoint, ScaledTerms]
    reach: float = _FIRST
    penalty: float = PENALTY
    price: float = PENALTY
    errors: ModelErrors = field(default_factory=ModelErrors)

    def optimality(self) -> float:
        """Return what no active constraint or bound takes of the gradient at the best run."""
        return self.problem.optimality(self.best[0].point, self.best[1])

    def is_stationary(self, tolerance: float) -> bool:
        """Return whether active constraints take the gradient and leave no more to be gained."""
        at = self.best[0].point, self.best[1]
        slack = float(
            np.max(self.best[1].constraints, initial=0.0, where=self.best[1].constraints <= _NEAR)
        )
        return self.optimality() <= _STATIONARY and self.problem.price(*at) * slack <= tolerance

    def go_on(self, tolerance: float) -> bool:
        """Take the run that promises most; return whether any promises enough."""
        enough = tolerance
        if self.problem.is_squares:
            enough = max(tolerance * self.best[1].objective, _ROUNDING)
        models = FigureModels([run for run, _ in self._closest()], self.errors)
        step = self._step(models, self.reach, enough)
        for _ in range(_TRIES):
            if step.gain > enough:
                break
            step = self._step(models, 0.1 * step.reach, enough)
        if step.gain <= enough:
            return False
        self._take(step, models)
        return True

    def _take(self, step: _Step, models: FigureModels) -> None:
        """Run the point of a step, and learn from it."""
        moved = float(np.max(np.abs(step.point - self.best[0].point)))
        found = self.problem.run(step.point)
        if found is None:
            self.reach = 0.3 * moved
            return
        self.errors.note(models, found[0])
        self.runs.append(found)
        gain = self.best[1].merit(self.price) - found[1].merit(self.price)
        if gain > _GOOD * step.gain and moved > 0.9 * step.reach:
            self.reach = min(1.0, 2.0 * step.reach)
        elif gain < _BAD * step.gain:
            self.reach = _SHRUNK * moved
        if gain > 0.0:
            self.best = found

    def _closest(self) -> list[tuple[EvaluatedPoint, ScaledTerms]]:
        """Return the best run, then the closest others, as many as a model is made of."""
        centre = self.best[0].point
        others = [item for item in self.runs if item is not self.best]
        others.sort(key=lambda item: float(np.max(np.abs(item[0].point - centre))))
        return [self.best, *others[: max(1, _MOST_DATA // (1 + len(centre)) - 1)]]

    def _step(self, models: FigureModels, reach: float, enough: float) -> _Step:
        """Return the best point of models; a violation costs more from now on if it need not be."""
        run, terms = self.best
        if terms.violation <= _KEPT:  # what led here may have asked for more than is needed now
            self.penalty = max(PENALTY, 2.0 * self.problem.price(run.point, terms))
        known: dict[bytes, ScaledTerms] = {}

        def at(x: Floats) -> ScaledTerms:
            if x.tobytes() not in known:
                known[x.tobytes()] = self.problem.terms(models.at(x))
            return known[x.tobytes()]

        box = np.maximum(0.0, run.point - reach), np.minimum(1.0, run.point + reach)
        point = _least(at, run.point, box, (1.0, self.penalty), enough)
        while at(point).violation > _KEPT and self.penalty < _HARDEST:
            kept = _least(at, point, box, (0.0, 1.0), enough)
            if at(kept).violation > 0.9 * at(point).violation:
                break
            self.penalty *= 10.0
            point = _least(at, kept, box, (1.0, self.penalty), enough)
        is_kept = at(point).violation <= _KEPT
        needed = self.penalty  # no multipliers of a step that it led to are larger
        if is_kept:
            needed = min(needed, 2.0 * self.problem.price(point, at(point)))
        self.price = max(needed, _CHEAPER * self.price, _LEAST_PRICE)
        return _Step(point, terms.merit(self.price) - at(point).merit(self.price), reach)


@dataclass(frozen=True)
class _Step:
    """A point that models find best within a reach, and their gain of merit."""

    point: Floats
    gain: float
    reach: float


def _least(
    at: Callable[[Floats], ScaledTerms],
    start: Floats,
    box: tuple[Floats, Floats],
    weights: tuple[float, float],
    enough: float,
) -> Floats:
    """Return where weighted objective and violation are least, a variable of its own for that."""
    from scipy.optimize import minimize

    n, (own, missed) = len(start), weights
    first = at(start)
    constraints = []
    if len(first.constraints):
        column = np.ones((len(first.constraints), 1))
        constraints = [
            {
                "type": "ineq",
                "fun": lambda z: at(z[:n]).constraints + z[n],
                "jac": lambda z: np.hstack([at(z[:n]).jacobian, column]),
            }
        ]
    most = None if constraints else 0.0
    found = minimize(
        lambda z: own * at(z[:n]).objective + missed * z[n],
        np.append(start, first.violation),
        jac=lambda z: np.append(own * at(z[:n]).gradient, missed),
        bounds=[*zip(*box, strict=True), (0.0, most)],
        constraints=constraints,
        method="SLSQP",
        options={"ftol": _FINER * enough, "maxiter": 200},
    )
    return np.asarray(np.clip(found.x[:n], *box), dtype=float)
