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

_FURTHER_RUNS = 40
"""Runs with gradients of each search for a further region at most."""

_CORNERS = 8
"""Searches for further regions that begin where all parameters are away from the middle."""

_SIMILAR, _APART = 0.3, 0.3
"""Part of its distance, and deviations, by which a point differs from one that is known."""

_HALF_WAY = 1e-2
"""Deviations from half-way to a known point at which a search is on its way there."""

_PART = 1e-3
"""Part of the likelihood of the nearest point below which others do not count."""

_CHECKED = 32
"""Lines of a region at most that are checked by runs at random points."""

_CLOSE = 1e-2
"""Deviations from a crossing within which no point is checked."""

_FEWEST_LINES = 2
"""Lines with a crossing that an error needs."""

_NEAR = 1e-4
"""Distance in deviations up to which the crossing of a line is found."""


@dataclass(frozen=True)
class FailingPoint:
    """A failing point that is the nearest around: parameters (n,), distance, likelihood beyond.

    ``distance`` is signed, above zero where the middle does not fail; ``first_order`` is the chance
    of failing beyond it, Φ(-distance). ``importance`` (n,) are the parts of the squared distance by
    parameter.
    """

    distance: float
    first_order: float
    parameters: Floats
    importance: Floats


@dataclass(frozen=True)
class Reliability:
    """The chance of failing a limit.

    ``points`` are the nearest failing points of the regions that were found, the nearest of all
    first; where the middle fails, those of the regions that do not. ``chance`` and its standard
    ``error`` are from lines around all of them, ``most`` is what may fail beyond the search;
    ``n_starts`` is how many searches for further regions began; ``note`` says what is not as it
    should be.
    """

    points: tuple[FailingPoint, ...]
    chance: float
    error: float
    n_starts: int
    note: str = ""
    most: float = 0.0


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
    from scipy.stats import chi2, norm

    search = _Search(laws, margin)
    points, n_starts = search.nearest()
    side = search.side
    if not points:
        note = f"no failing point within {_FARTHEST:g} deviations of the middle was found"
        chance, beyond = 0.0 if side > 0.0 else 1.0, float(chi2.sf(_FARTHEST**2, len(laws)))
        return Reliability((), chance, 0.0, n_starts, note, beyond)
    chances, squares, n_lost, n_failed, n_wrong, n_checked = 0.0, 0.0, 0, 0, 0, 0
    for k, (u, row) in enumerate(points):
        size = float(np.linalg.norm(row))
        # towards failure, away from the middle if it does not fail
        along = -row / size
        others = np.array([place for place, _ in points[:k] + points[k + 1 :]])
        lines = _Lines(laws, values, along, float(along @ u), -size, u, others.reshape(-1, len(u)))
        drawn = np.random.default_rng(seed + k).standard_normal((number, len(u)))
        crossings = lines.crossings(drawn)
        known = np.isfinite(crossings)
        found = lines.tails(drawn[known], crossings[known], side)
        if len(found) < _FEWEST_LINES:
            raise NumericalError(f"of {number} lines all but {len(found)} have a run that failed")
        chances += float(np.mean(found))
        squares += float(np.var(found, ddof=1) / len(found))
        n_lost, n_failed = n_lost + lines.n_lost, n_failed + number - len(found)
        wrong, checked = lines.wrong_sides(drawn[known], crossings[known], side)
        n_wrong, n_checked = n_wrong + wrong, n_checked + checked
    notes, n_lines = [], number * len(points)
    if n_lost:
        notes.append(f"{n_lost} of {n_lines} lines have no crossing that could be found")
    if n_failed:
        notes.append(f"{n_failed} of {n_lines} lines are left out, as a run on them failed")
    if n_wrong:
        notes.append(
            f"{n_wrong} of {n_checked} runs at random points are on the other side of the limit "
            "than the lines say, which cross it more than once: the interval does not hold, take "
            "samples"
        )
    described = []
    for u, row in points:
        distance = float(np.linalg.norm(u))
        parts = u**2 / distance**2 if distance else row**2 / float(row @ row)
        likely, x = float(norm.sf(side * distance)), to_parameters(laws, u)[0]
        described.append(FailingPoint(side * distance, likely, x, parts))
    return Reliability(
        tuple(described),
        float(np.clip(chances if side > 0.0 else 1.0 - chances, 0.0, 1.0)),
        float(np.sqrt(squares)),
        n_starts,
        "; ".join(notes),
    )


class _Search:
    """Searches for the points nearest to the middle on the other side of a limit."""

    def __init__(
        self, laws: Sequence[Distribution], margin: Callable[[Floats], tuple[float, Floats]]
    ) -> None:
        self.laws, self.margin = laws, margin
        self.side = 1.0
        self.side = 1.0 if self.at(np.zeros(len(laws)))[0] >= 0.0 else -1.0

    def at(self, u: Floats) -> tuple[float, Floats]:
        """Return the margin, above zero on the middle's side, and its gradient (n,)."""
        x, slopes = to_parameters(self.laws, u)
        found, gradient = self.margin(x)
        return self.side * found, self.side * gradient * slopes

    def nearest(self) -> tuple[list[tuple[Floats, Floats]], int]:
        """Return the points found, nearest first, with gradients of the margin as it is given.

        The first search begins in the middle, where a symmetric figure may have no slope. Others
        begin mirrored to what it finds, on both sides of each parameter and at some corners.
        """
        n = len(self.laws)
        found = self._from(np.zeros(n), _MOST_RUNS, [])
        points = [] if found is None else [found]
        reach = float(np.clip(np.linalg.norm(found[0]), 1.0, 3.0)) if found is not None else 3.0
        drawn = np.random.default_rng(1).standard_normal((_CORNERS if n > 2 else 0, n))
        corners = np.sign(drawn) if n > 2 else np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]])[:, :n]
        starts = [*(reach * np.eye(n)), *(-reach * np.eye(n))]
        starts += list(reach * corners / np.sqrt(n)) if n > 1 else []
        if found is not None:
            starts.insert(0, -found[0])
        for start in starts:
            with suppress(NumericalError):
                begin = self._begin(start, points)
                if begin is None:
                    continue
                further = self._from(begin, _FURTHER_RUNS, points)
                if further is not None and not _is_known(further[0], points, _APART):
                    points.append(further)
        points.sort(key=lambda point: float(np.linalg.norm(point[0])))
        likely = [_likely(u) for u, _ in points]
        kept = [p for p, chance in zip(points, likely, strict=True) if chance > _PART * likely[0]]
        return [(u, self.side * row) for u, row in kept], len(starts)

    def _begin(self, start: Floats, known: Sequence[tuple[Floats, Floats]]) -> Floats | None:
        """Return where a search begins, None if it leads to known points.

        It does where half-way from a failing start to one of these fails, too, or where the
        tangent of the margin leads there.
        """
        value, row = self.at(start)
        if value < 0.0:
            same = any(self.at(0.5 * (start + place))[0] < 0.0 for place, _ in known)
            return None if same else start
        size = float(row @ row)
        if size == 0.0:
            return None
        foot: Floats = row * (float(row @ start) - value) / size
        length = float(np.linalg.norm(foot))
        if length > _FARTHEST or _is_known(foot, known, _SIMILAR * max(length, 1.0)):
            return None
        return foot

    def _from(
        self, start: Floats, most_runs: int, known: Sequence[tuple[Floats, Floats]]
    ) -> tuple[Floats, Floats] | None:
        """Return the nearest point by one search with the margin's gradient, if it leads to one.

        It keeps to what is nearer to its start than to known points; what ends half-way to one of
        these is on its way there, and no point of its own.
        """
        away = np.array([start - place for place, _ in known]).reshape(-1, len(start))
        away /= np.linalg.norm(away, axis=1, keepdims=True)
        halves = np.array([0.5 * (start + place) for place, _ in known]).reshape(away.shape)

        def evaluate(u: Floats) -> Evaluated:
            value, row = self.at(u)
            rooms = np.sum((u - halves) * away, axis=1)
            return Evaluated(
                0.5 * float(u @ u), u.copy(), np.r_[-value, rooms], np.vstack([-row, away])
            )

        n = len(start)
        bounds = np.full(n, -_FARTHEST), np.full(n, _FARTHEST)
        found = optimise(evaluate, start=start, bounds=bounds, tolerance=1e-12, most_runs=most_runs)
        u, row = found.variables, -found.values.jacobian[0]
        on_the_way = np.any(np.sum((u - halves) * away, axis=1) < _HALF_WAY)
        if found.violation > 1e-4 or on_the_way or not np.any(row):
            return None
        return u, row


def _likely(u: Floats) -> float:
    from scipy.stats import norm

    return float(norm.sf(np.linalg.norm(u)))


def _is_known(u: Floats, points: Sequence[tuple[Floats, Floats]], distance: float) -> bool:
    return any(float(np.linalg.norm(u - known)) < distance for known, _ in points)


@dataclass
class _Lines:
    """Lines along a direction of standard normal variables, on which a margin falls."""

    laws: Sequence[Distribution]
    values: Callable[[Floats], float]
    along: Floats
    nearest: float
    slope: float
    place: Floats
    others: Floats
    n_lost: int = 0

    def crossings(self, drawn: Floats) -> Floats:
        """Return where the lines through free samples (k, n) cross the limit, shape (k,).

        It is not a number where a run fails.
        """
        found = np.full(len(drawn), np.nan)
        for k, row in enumerate(self._bases(drawn)):
            with suppress(NumericalError):
                found[k] = self._crossing(row)
        return found

    def tails(self, drawn: Floats, crossings: Floats, side: float) -> Floats:
        """Return how likely lines are beyond their crossings, shape (k,), within what is nearest.

        ``side`` is -1 where what does not fail is beyond.
        """
        from scipy.stats import norm

        low, high = self._beyond(drawn, crossings, side)
        upper, lower = norm.sf(low) - norm.sf(high), norm.cdf(high) - norm.cdf(low)
        found: Floats = np.maximum(np.where(low > 0.0, upper, lower), 0.0)
        return found

    def wrong_sides(self, drawn: Floats, crossings: Floats, side: float) -> tuple[int, int]:
        """Return how many points on lines are on the wrong side of the limit, and of how many.

        On each of some lines one is the sample that it goes through, unless it is nearer to
        other places, and one is drawn from what is beyond the crossing.
        """
        from scipy.stats import norm

        drawn, crossings = drawn[:_CHECKED], crossings[:_CHECKED]
        low, high = self._beyond(drawn, crossings, side)
        share = norm.cdf(drawn @ self.along)
        upper = norm.isf(norm.sf(high) + share * (norm.sf(low) - norm.sf(high)))
        lower = norm.ppf(norm.cdf(low) + share * (norm.cdf(high) - norm.cdf(low)))
        inside = self._bases(drawn) + np.outer(np.where(low > 0.0, upper, lower), self.along)
        n_wrong = n_checked = 0
        for row, crossing in zip(
            np.r_[drawn, inside[low < high]], np.r_[crossings, crossings[low < high]], strict=True
        ):
            distances = np.linalg.norm(self.others - row, axis=1)
            past = float(self.along @ row) - crossing
            if np.any(distances < np.linalg.norm(self.place - row)) or abs(past) < _CLOSE:
                continue
            with suppress(NumericalError):
                fails = self.values(to_parameters(self.laws, row)[0]) < 0.0
                n_wrong, n_checked = n_wrong + (fails != (past > 0.0)), n_checked + 1
        return n_wrong, n_checked

    def _beyond(self, drawn: Floats, crossings: Floats, side: float) -> tuple[Floats, Floats]:
        """Return from where to where lines are beyond their crossing and nearest to their place.

        What is nearer to one of the other places (m, n) is left to that one's lines: regions are
        counted once each, however they meet.
        """
        bases = self._bases(drawn)
        low, high = np.full(len(bases), -np.inf), np.full(len(bases), np.inf)
        for other in self.others:
            away = other - self.place
            # |base + t along - place|² compares linearly in t
            room = 0.5 * (other @ other - self.place @ self.place) - bases @ away
            slope = float(self.along @ away)
            if abs(slope) < 1e-12:
                high = np.where(room < 0.0, -np.inf, high)
            elif slope > 0.0:
                high = np.minimum(high, room / slope)
            else:
                low = np.maximum(low, room / slope)
        if side > 0.0:
            return np.maximum(low, crossings), high
        return low, np.minimum(high, crossings)

    def _bases(self, drawn: Floats) -> Floats:
        across: Floats = drawn - np.outer(drawn @ self.along, self.along)
        return across

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
