"""A scenario at many values of its uncertain parameters."""

from __future__ import annotations

import os
from collections.abc import Generator, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.polynomial_chaos import fit_chaos
from vehicledyn.analyse.uncertainty import Distribution, Shares, Spread
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.known_analyses import analysis_of
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.step_memory import Memory, Shelf
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.figures.by_analysis import figures_of
from vehicledyn.studies.figures.run_figures import ScenarioFigures
from vehicledyn.studies.mistakes import Mistakes
from vehicledyn.studies.uncertainty.checks import check_limits, places_of, read_laws
from vehicledyn.studies.uncertainty.report import Risk, UncertaintyReport

Floats = NDArray[np.float64]

_ROUNDING = 1e-20
"""Part of the variance below which a parameter brings nothing but rounding."""

_NOTHING = 1e-6
"""Part of the variance, with its error, below which a fitted parameter brings nothing."""

_AT_ONCE = 1024
"""Runs that wait for a core at most."""

_FITTED = 256
"""Samples that tell which parameters do nothing."""

_AT_MEANS = {
    "first_order": "first order",
    "reliability": "first order",
    "second_order": "second order",
}
"""Methods that know shares at the means alone, and how far."""

_STEP = 0.1
"""Step of differences of first derivatives, in deviations of the parameter."""


@dataclass(frozen=True)
class Limited:
    """A limit of the figure at a place, in SI."""

    place: int
    value: float
    is_upper: bool


@dataclass
class RandomCases:
    """A scenario at many values of its uncertain parameters."""

    of_scenario: ScenarioFigures
    names: list[str]
    laws: list[Distribution]
    mistakes: Mistakes
    progress: Progress
    limits: Mapping[str, Mapping[str, Any]]
    runs: Memory = field(default_factory=lambda: Memory(Shelf()))
    known: list[Floats] = field(default_factory=list)
    points: list[Floats] = field(default_factory=list)
    asked_for: set[tuple[Any, ...]] = field(default_factory=set)
    lost: dict[tuple[Any, ...], str] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)
    quantities: tuple[Quantity, ...] = ()

    @staticmethod
    def of(
        loaded: LoadedScenario,
        *,
        of: list[str],
        parameters: Mapping[str, Mapping[str, Any]],
        limits: Mapping[str, Mapping[str, Any]],
        mistakes: Mistakes,
        progress: Progress,
    ) -> RandomCases:
        """Prepare a scenario, the figures of whose run were checked; read the rest.

        Raises
        ------
        InputError
            If anything is wrong with them.
        """
        if len({analysis_of(name) for name in of}) != 1:
            mistakes.wrong(("of",), "name figures of one analysis, of the run or another one")
            mistakes.refuse()
        found = figures_of(mistakes, loaded, places_of(mistakes, of), progress)
        if not found:
            mistakes.refuse()
        laws = read_laws(mistakes, loaded, parameters, found[0].parameters, found[0].model)
        check_limits(mistakes, limits, found[0].units)
        mistakes.refuse()
        return RandomCases(found[0], list(laws), list(laws.values()), mistakes, progress, limits)

    @property
    def means(self) -> Floats:
        """Expected values of the parameters, shape (n,)."""
        return np.array([law.mean for law in self.laws])

    @property
    def about(self) -> dict[str, Quantity]:
        """Parameters of the model by name."""
        return {name: about for name, (about, _) in self.of_scenario.parameters.items()}

    @property
    def notes(self) -> list[str]:
        """What is to be said of the figures."""
        return self.of_scenario.notes

    def limited(self) -> Iterator[Limited]:
        """Yield the limits, once the figures are known."""
        places = {item.name: k for k, item in enumerate(self.quantities)}
        for name, given in self.limits.items():
            k = places[name]
            for key, value in given.items():
                limit = to_si(value, self.quantities[k].unit)
                yield Limited(k, limit, key == "at_most")

    def gradients_at(self, point: Floats) -> tuple[Floats, Floats]:
        """Return the figures (m,) at a point and their derivatives (m, n).

        Raises
        ------
        NumericalError
            If the run fails or a figure has no derivative there.
        """
        entry = self._entry(["gradients", *point.tolist()], point, follows=True)
        return np.array(entry["values"]), np.array(entry["slopes"])

    def curvatures(self) -> tuple[Floats, Floats, Floats]:
        """Return figures, first (m, n) and second derivatives (m, n, n) at the means.

        The latter are central differences of exact first derivatives.
        """
        means, columns = self.means, []
        for k, law in enumerate(self.laws):
            step = np.zeros(len(means))
            step[k] = _STEP * law.deviation
            self.progress("computing second derivatives", k / len(means))
            after, before = self.gradients_at(means + step)[1], self.gradients_at(means - step)[1]
            columns.append((after - before) / (2.0 * step[k]))
        return *self.gradients_at(means), np.stack(columns, axis=2)

    def values_at(self, point: Floats) -> Floats:
        """Return the figures at a point, shape (m,).

        Raises
        ------
        NumericalError
            If the run fails.
        """
        return self._values(self._entry(point.tolist(), point, follows=False))

    def figures_at(self, points: Floats) -> Floats:
        """Return the figures at some points, shape (number, m); they are those of the report.

        They are computed at once on all cores. Figures of runs that fail are not a number.

        Raises
        ------
        NumericalError
            If fewer than two runs, or fewer than half of them, do not fail.
        """
        rows: list[Floats | None] = []
        failures: list[str] = []
        with closing(self._entries(points)) as entries:
            for point, entry in zip(points, entries, strict=True):
                try:
                    rows.append(self._values(self._noted(point.tolist(), entry)))
                except NumericalError as error:
                    rows.append(None)
                    failures.append(str(error))
                if len(failures) > min(len(points) // 2, len(points) - 2):
                    raise NumericalError(
                        f"{len(failures)} of the first {len(rows)} runs failed, too many to speak "
                        "of a scatter: narrow the distributions or mend the model; the first: "
                        f"{failures[0]}"
                    )
                self.progress("computing samples", len(rows) / len(points))
        missing = np.full(len(self.quantities), np.nan)
        found = [missing if row is None else row for row in rows]
        self.known += found
        self.points += list(points)
        self.failures += failures
        return np.array(found)

    def _entries(self, points: Floats) -> Generator[dict[str, Any]]:
        """Yield what is known of runs at points in order; the first is alone, to be checked."""

        def known(point: Floats) -> dict[str, Any]:
            return self.runs.recall("run", point.tolist(), partial(self._run, point, follows=False))

        yield known(points[0])
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            for begin in range(1, len(points), _AT_ONCE):
                runs = [pool.submit(known, point) for point in points[begin : begin + _AT_ONCE]]
                try:
                    for run in runs:
                        yield run.result()
                finally:
                    for run in runs:
                        run.cancel()

    @staticmethod
    def _values(entry: dict[str, Any]) -> Floats:
        return np.array(entry["values"], dtype=float)

    def _entry(self, key: list[Any], point: Floats, *, follows: bool) -> dict[str, Any]:
        entry = self.runs.recall("run", key, partial(self._run, point, follows=follows))
        return self._noted(key, entry)

    def _noted(self, key: list[Any], entry: dict[str, Any]) -> dict[str, Any]:
        """Count a run and note what it shows.

        Raises
        ------
        NumericalError
            If it failed.
        """
        self.asked_for.add(tuple(key))
        if "failure" in entry:
            raise NumericalError(str(entry["failure"]))
        self.quantities = tuple(Quantity(*item) for item in entry["figures"])
        if entry.get("lost"):
            self.lost[tuple(key)] = entry["lost"]
        return entry

    def _run(self, point: Floats, *, follows: bool) -> dict[str, Any]:
        """Return the figures at a point with their slopes if wanted, or why there are none."""
        changes = dict(zip(self.names, map(float, point), strict=True))
        values = ", ".join(f"{name} = {value:.6g}" for name, value in changes.items())
        try:
            pairs, lost, _ = self.of_scenario.at(
                changes, self.names, follows=follows, progress=self.progress
            )
        except NumericalError as error:
            return {"failure": f"the run with {values} failed: {error}"}
        for slope, item in pairs:
            if follows and slope.trouble:
                return {"failure": f"'{item.name}' has no derivative: {slope.trouble}"}
        check_limits(self.mistakes, self.limits, {item.name: item.unit for _, item in pairs})
        self.mistakes.refuse()  # before anything is kept
        found: dict[str, Any] = {
            "figures": [(q.name, q.unit, q.description) for _, q in pairs],
            "values": [slope.value for slope, _ in pairs],
        }
        found |= {"lost": f"with {values}: {lost}"} if lost else {}
        return found | ({"slopes": [s.slope.tolist() for s, _ in pairs]} if follows else {})

    def _driving_failures(self) -> list[str]:
        """Return a warning of runs that lost their vehicle, the first of which it describes."""
        if not self.lost:
            return []
        first = next(iter(self.lost.values()))
        return [
            f"warning: {len(self.lost)} of {len(self.asked_for)} runs lost the vehicle, and their "
            f"figures count as those of the others do; the first {first}"
        ]

    def _idle(self, method: str, totals: Floats | None, errors: Floats | None) -> list[str]:
        """Return warnings of parameters that bring no part of any figure's variance.

        Derivatives tell it at the means alone, polynomials up to what they miss.
        """
        if totals is None:
            return []
        least, words = _ROUNDING, "changes no figure"
        if method in _AT_MEANS:
            words = f"has no effect at the means of the parameters, to {_AT_MEANS[method]}"
        elif method != "sobol":
            least, words = _NOTHING, f"brings less than {_NOTHING:g} of the variance of any figure"
        most = np.abs(totals) + (0.0 if errors is None or least == _ROUNDING else 2.0 * errors)
        return [
            f"warning: '{name}' {words}"
            for k, name in enumerate(self.names)
            if np.all(most[:, k] < least)
        ]

    def _fitted(self) -> Shares:
        """Return the shares of some first samples that have figures, by polynomials."""
        known = [
            (point, row)
            for point, row in zip(self.points[:_FITTED], self.known[:_FITTED], strict=True)
            if np.isfinite(row).all()
        ]
        points, rows = (np.array(part) for part in zip(*known, strict=True))
        return fit_chaos(self.laws, points, rows).shares()

    def _failed_runs(self, method: str) -> list[str]:
        """Return a warning of samples that have no figures, the first of which it describes."""
        if not self.failures:
            return []
        whose = (
            "mean and deviation are those of the others, shares those of polynomials that go on "
            "over the region of failed runs"
            if method == "polynomial_chaos"
            else "mean, deviation and shares are those of the others"
        )
        return [
            f"warning: {len(self.failures)} of {len(self.known)} runs failed and are left out: "
            f"{whose}, intervals of chances allow for failed runs on either side of a limit; "
            f"the first: {self.failures[0]}"
        ]

    def report(
        self,
        method: str,
        found: Spread,
        *,
        shares: Floats | Shares | None = None,
        totals: Floats | None = None,
        figures: Floats | None = None,
        risks: Sequence[Risk] = (),
    ) -> UncertaintyReport:
        """Return the report; ``figures`` (n_runs, m) are those of its samples."""
        about = self.about
        errors: tuple[Floats | None, Floats | None] = (None, None)
        if isinstance(shares, Shares):
            errors = shares.first_error, shares.total_error
            totals, shares = shares.total, shares.first
        idle = self._idle(method, shares if totals is None else totals, errors[1])
        if shares is None:
            fitted = self._fitted()
            idle = self._idle(method, fitted.total, fitted.total_error)
        return UncertaintyReport(
            self.of_scenario.title,
            method,
            tuple(about[name] for name in self.names),
            self.quantities,
            found,
            shares,
            totals,
            len(self.asked_for),
            list(risks),
            (
                *self.notes,
                *idle,
                *self._driving_failures(),
                *self._failed_runs(method),
            ),
            None if figures is None else np.array(self.points),
            figures,
            *errors,
        )
