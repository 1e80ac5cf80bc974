"""How likely a figure passes a limit: the nearest failing point, and lines beside it.

Parameters are taken to independent standard normal variables u, in which the likelihood falls
with the distance from the middle. First-order reliability: Rackwitz, Fiessler (1978), Computers
and Structures 9, 489-494. Line sampling: Koutsourelakis, Pradlwarter, Schuëller (2004),
Probabilistic Engineering Mechanics 19, 409-417.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.objective import Evaluated
from vehicledyn.analyse.optimise import optimise
from vehicledyn.analyse.uncertainty import Distribution
from vehicledyn.base.errors import NumericalError

Floats = NDArray[np.float64]

_FARTHEST = 8.0
"""Distance in deviations beyond which nothing is sought; less likely than 1e-15."""

_MOST_RUNS, _MOST_STEPS = 100, 12
"""Runs with gradients of a search, and runs along a line, at most."""

_FEWEST_LINES = 2
"""Lines with a crossing that an error needs."""

_NEAR = 1e-4
"""Distance in deviations up to which the crossing of a line is found."""


@dataclass(frozen=True)
class Reliability:
    """The chance of failing a limit.

    ``index`` is the signed distance of the nearest failing point in deviations, above zero where
    the middle does not fail; ``first_order`` = Φ(-index). ``point`` (n,) are its parameters,
    ``importance`` (n,) the parts of the squared distance by parameter. ``chance`` and its standard
    ``error`` are from lines; ``note`` says what is not as it should be.
    """

    index: float
    first_order: float
    point: Floats
    importance: Floats
    chance: float
    error: float
    note: str = ""


def to_parameters(laws: Sequence[Distribution], u: Floats) -> tuple[Floats, Floats]:
    """Return the parameters (n,) at standard normal variables (n,), and dx/du (n,)."""
    from scipy.stats import norm

    shares = np.clip(norm.cdf(u), 1e-16, 1.0 - 1e-16)
    beyond = norm.sf(u)
    x = np.array(
        [
            law.law.ppf(p) if p < 0.5 else law.law.isf(q)
            for law, p, q in zip(laws, shares, np.clip(beyond, 1e-16, 1.0), strict=True)
        ]
    )
    densities = np.array([law.law.pdf(v) for law, v in zip(laws, x, strict=True)])
    slopes = np.divide(norm.pdf(u), densities, out=np.zeros_like(x), where=densities > 0.0)
    return x, slopes


def failing_chance(
    laws: Sequence[Distribution],
    margin: Callable[[Floats], tuple[float, Floats]],
    values: Callable[[Floats], float],
    number: int,
    seed: int,
) -> Reliability:
    """Return how likely a margin is below zero.

    Parameters
    ----------
    laws
        Independent distributions of the n parameters.
    margin
        Returns margin and gradient (n,) at parameters (n,).
    values
        Returns the margin alone.
    number
        Lines beside the nearest failing point, on each of which its crossing is found.
    seed
        Equal seeds give equal lines.
    """
    from scipy.stats import norm

    n = len(laws)
    start = np.zeros(n)
    side = 1.0 if margin(to_parameters(laws, start)[0])[0] >= 0.0 else -1.0

    def evaluate(u: Floats) -> Evaluated:
        x, slopes = to_parameters(laws, u)
        found, gradient = margin(x)
        row = -side * gradient * slopes
        return Evaluated(0.5 * float(u @ u), u.copy(), np.array([-side * found]), row[None, :])

    bounds = np.full(n, -_FARTHEST), np.full(n, _FARTHEST)
    found = optimise(evaluate, start=start, bounds=bounds, tolerance=1e-12, most_runs=_MOST_RUNS)
    u, row = found.variables, -side * found.values.jacobian[0]
    steepest = float(np.linalg.norm(row))
    distance = float(np.linalg.norm(u))
    if found.violation > 1e-4 or steepest == 0.0:
        note = f"no failing point within {_FARTHEST:g} deviations of the middle was found"
        chance = 0.0 if side > 0.0 else 1.0
        return Reliability(
            side * np.inf, chance, to_parameters(laws, u)[0], np.zeros(n), chance, 0.0, note
        )
    # towards failure, away from the middle if it does not fail
    along = -row / steepest
    lines = _Lines(laws, values, along, float(along @ u), -steepest)
    crossings = lines.crossings(u, number, seed)
    chances = norm.sf(crossings[np.isfinite(crossings)])
    if len(chances) < _FEWEST_LINES:
        raise NumericalError(f"of {number} lines all but {len(chances)} have a run that failed")
    error = float(np.std(chances, ddof=1) / np.sqrt(len(chances)))
    notes = []
    if lines.n_lost:
        notes.append(f"{lines.n_lost} of {number} lines have no crossing that could be found")
    if failed := number - len(chances):
        notes.append(f"{failed} of {number} lines are left out, as a run on them failed")
    note = "; ".join(notes)
    return Reliability(
        side * distance,
        float(norm.sf(side * distance)),
        to_parameters(laws, u)[0],
        u**2 / distance**2 if distance else along**2,
        float(np.mean(chances)),
        error,
        note,
    )


@dataclass
class _Lines:
    """Lines along a direction of standard normal variables, on which a margin falls."""

    laws: Sequence[Distribution]
    values: Callable[[Floats], float]
    along: Floats
    nearest: float
    slope: float
    n_lost: int = 0

    def crossings(self, u: Floats, number: int, seed: int) -> Floats:
        """Return where the lines through free samples cross the limit, shape (number,).

        It is not a number where a run fails.
        """
        drawn = np.random.default_rng(seed).standard_normal((number, len(u)))
        across = drawn - np.outer(drawn @ self.along, self.along)
        found = np.full(number, np.nan)
        for k, row in enumerate(across):
            with suppress(NumericalError):
                found[k] = self._crossing(row)
        return found

    def _crossing(self, base: Floats) -> float:
        """Return the place on a line where the margin is zero, by secants."""
        at, slope = self.nearest, self.slope
        known = self._margin(base, at)
        for _ in range(_MOST_STEPS):
            step = float(np.clip(-known / slope, -2.0, 2.0)) if slope else 1.0
            if abs(step) <= _NEAR:
                return at + step
            following = float(np.clip(at + step, -_FARTHEST, _FARTHEST))
            if following == at:
                break
            after = self._margin(base, following)
            slope = (after - known) / (following - at)
            at, known = following, after
        self.n_lost += 1
        return at if abs(at) < _FARTHEST else float(np.sign(at)) * _FARTHEST

    def _margin(self, base: Floats, at: float) -> float:
        return self.values(to_parameters(self.laws, base + at * self.along)[0])
