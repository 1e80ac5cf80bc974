"""An optimisation study made ready: figures of all scenarios with their gradients at a point."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.objective import Evaluated
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import to_si
from vehicledyn.studies.failed_runs import with_values
from vehicledyn.studies.figures.by_analysis import figures_of
from vehicledyn.studies.figures.run_figures import ScenarioFigures
from vehicledyn.studies.mistakes import silent
from vehicledyn.studies.optimisation.checks import (
    check_limits,
    check_numbers,
    note_mistakes,
    read_bounds,
)
from vehicledyn.studies.optimisation.figures import Figures
from vehicledyn.studies.optimisation.scatter import Scatter, combined
from vehicledyn.studies.optimisation.study import Limit, OptimisationStudy

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class _Part:
    """Figures of a scenario, with what their names begin with in the study."""

    of: ScenarioFigures
    head: str

    @property
    def names(self) -> list[str]:
        """Names of the figures in the study."""
        return [f"{self.head}{name}" for name in self.of.units]

    def at(
        self, changes: Mapping[str, float], variables: Sequence[str], *, follows: bool
    ) -> dict[str, Any]:
        """Return figures and gradients by variables, zero if not wanted, or why there are none."""
        try:
            found, failure, samples = self.of.at(
                changes, variables, follows=follows, progress=silent
            )
        except NumericalError as error:
            failure = str(error)
        if failure:
            return {"failure": f"{self.of.title}: {failure}"}
        pairs = list(zip(self.names, found, strict=True))
        for name, (slope, _) in pairs:
            if slope.trouble and follows:
                return {"failure": f"'{name}' has no derivative: {slope.trouble}"}
        nothing = [0.0] * len(variables)
        return {
            "values": {n: slope.value for n, (slope, _) in pairs},
            "slopes": {n: slope.slope.tolist() if follows else nothing for n, (slope, _) in pairs},
            "units": {n: quantity.unit for n, (_, quantity) in pairs},
            "samples": {f"{self.head}{name}": tuple(item) for name, item in samples.items()},
        }


_ROUNDING = 1e-9
"""Part of a figure, or of what others change of it, that is no effect of a variable."""


class Problem:
    """Figures of a study's scenarios by its variables.

    Parameters
    ----------
    study
        The validated study.
    kept
        Evaluations that are known; further ones are added to it.
    progress
        Called with what is going on.
    choice
        What distinguishes these evaluations from those of other discrete choices.

    Raises
    ------
    InputError
        If a variable, figure, bound or limit means nothing.
    """

    def __init__(
        self, study: OptimisationStudy, kept: Memory, progress: Progress, choice: str = ""
    ) -> None:
        if choice:
            note_mistakes(study, progress)
            study.form.refuse()
        self._study, self._kept = study, kept
        self._mark = [choice] if choice else []
        self._parts = _parts(study, progress)
        self.figures = [name for part in self._parts for name in part.names]
        for part in self._parts:
            check_numbers(study, part.of.parameters, part.of.model)
        study.form.refuse()
        own = self._parts[0].of
        units = {name: quantity.unit for name, (quantity, _) in own.parameters.items()}
        self._scatter = Scatter.of(study.form.mistakes, study.scatter, units, own.model)
        self.variables = tuple(own.parameters[v.name][0] for v in study.variables)
        rows = read_bounds(study, own.parameters)
        self.low, self.high, self.start = np.array([rows[v.name] for v in study.variables]).T
        self.units: dict[str, str] = {}
        self.n_known = kept.n_known

    def evaluate(self, point: Floats) -> Figures:
        """Return all figures and their gradients at a point.

        Raises
        ------
        NumericalError
            If a run fails or a figure has no derivative there.
        """
        return self._figures(point, follows=True)

    def _figures(self, point: Floats, *, follows: bool) -> Figures:
        """Return the figures at a point, with gradients that are zero where none are wanted."""
        kind = [] if follows else ["plain"]
        key = [*self._mark, *kind, *point.tolist()]
        entry = self._kept.recall("run", key, lambda: self._new(point, follows=follows))
        if not self.units:
            self.units |= entry.get("units", {})
            check_limits(self._study, self.units)
            self._study.form.refuse()
        if "failure" in entry:
            where = with_values(self.variables, point)
            raise NumericalError(f"{where}: {entry['failure']}")
        return Figures.of(entry)

    def values(self, point: Floats, further: Sequence[Limit] = ()) -> Evaluated:
        """Return objective and constraints at a point, with further limits behind those given."""
        return self._values(self.evaluate(point), len(point), further)

    def explored(self, point: Floats) -> tuple[float, float] | None:
        """Return objective and violation at a point, without gradients; None without a motion.

        The violation is the largest of a constraint, over its limit.
        """
        try:
            found = self._values(self._figures(point, follows=False), len(point))
        except NumericalError:
            return None
        sizes = [abs(limit) or 1.0 for _, _, limit in self.limits()]
        return found.objective, float(np.max(-found.constraints / np.array(sizes), initial=0.0))

    def _values(self, at: Figures, n: int, further: Sequence[Limit] = ()) -> Evaluated:
        """Return objective and constraints of figures."""
        constraints, rows = [], [np.zeros(n)][:0]
        for name, sign, limit in self.limits(further):
            value, slope = self._worse(at, name, -sign)
            constraints.append(sign * (value - limit))
            rows.append(sign * slope)
        found = [(w, *self._worse(at, name, np.sign(w))) for name, w in self._study.weights.items()]
        objective = float(sum(w * value for w, value, _ in found))
        gradient = sum((w * slope for w, _, slope in found), np.zeros(n))
        missed, missed_slopes = self._missed(at, n)
        if missed is not None and missed_slopes is not None:
            objective = 0.5 * float(missed @ missed)
            gradient = missed_slopes.T @ missed
        bounds = np.array(constraints), np.array(rows).reshape(len(rows), n)
        parts = at.parts(lambda other: self._values(other, n, further))
        return Evaluated(objective, np.asarray(gradient), *bounds, missed, missed_slopes, parts)

    def _worse(self, at: Figures, name: str, side: float) -> tuple[float, Floats]:
        """Return a figure, or its mean moved by deviations to a side, with its gradient."""
        reach = side * self._study.deviations if name in at.deviations else 0.0
        if not reach:
            return at.values[name], at.slopes[name]
        value = at.values[name] + reach * at.deviations[name]
        return value, at.slopes[name] + reach * at.deviation_slopes[name]

    def _missed(self, at: Figures, n: int) -> tuple[Floats | None, Floats | None]:
        """Return by how many sizes figures miss their targets, with gradients; their scatter too.

        The expected square of what a figure misses is that of its mean plus its variance.
        """
        if not self._study.targets:
            return None, None
        values, rows = [], []
        for item in self._study.targets:
            unit = self.units.get(item.figure, "1")
            target, size = to_si(item.value, unit), to_si(item.size, unit)
            values.append((at.values[item.figure] - target) / size)
            rows.append(at.slopes[item.figure] / size)
            if item.figure in at.deviations:
                values.append(at.deviations[item.figure] / size)
                rows.append(at.deviation_slopes[item.figure] / size)
        return np.array(values), np.array(rows).reshape(len(rows), n)

    def limits(self, further: Sequence[Limit] = ()) -> list[tuple[str, float, float]]:
        """Return the figure, sign and value of each limit: sign (figure - value) >= 0."""
        return [
            (limit.figure, sign, to_si(value, self.units.get(limit.figure, "1")))
            for limit in (*self._study.limits, *further)
            for value, sign in ((limit.at_least, 1.0), (limit.at_most, -1.0))
            if value is not None
        ]

    def idle(self) -> list[str]:
        """Return the variables that change no figure at the start."""
        found = self.evaluate(self.start)
        effects = np.abs(list(found.slopes.values())) * (self.high - self.low)
        sizes = np.abs([found.values[name] for name in found.slopes])
        least = _ROUNDING * np.maximum(sizes, effects.max(axis=1))
        idle = np.all(effects <= least[:, None], axis=0)
        return [item.name for k, item in enumerate(self.variables) if idle[k]]

    def unconfirmed(self) -> list[str]:
        """Return warnings of derivatives at the start that differences of runs do not confirm."""
        point = {v.name: float(x) for v, x in zip(self.variables, self.start, strict=True)}
        return [note for part in self._parts for note in part.of.unconfirmed(point)]

    def starts(self, number: int, seed: int) -> list[Floats]:
        """Return points to search from: the one given, and others of a scrambled Sobol sequence."""
        from scipy.stats import qmc

        if number == 1:
            return [self.start]
        sequence = qmc.Sobol(len(self.start), rng=np.random.default_rng(seed))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # numbers that are no power of two serve
            shares = sequence.random(number - 1)
        return [self.start, *(self.low + (self.high - self.low) * shares)]

    def _new(self, point: Floats, *, follows: bool = True) -> dict[str, Any]:
        """Return figures and gradients of all runs, computed at once on several cores."""
        own = dict(zip([item.name for item in self.variables], map(float, point), strict=True))
        nodes = [self._scatter.moved(node, own) for node in self._scatter.nodes]
        wanted_runs = [(part, node) for node in nodes for part in self._parts]
        names = [item.name for item in self.variables]
        if len(wanted_runs) == 1:
            part, node = wanted_runs[0]
            found = [part.at(node, names, follows=follows)]
        else:
            with ThreadPoolExecutor(os.cpu_count()) as pool:
                found = list(
                    pool.map(lambda run: run[0].at(run[1], names, follows=follows), wanted_runs)
                )
        units, samples = dict[str, str](), dict[str, Any]()
        runs: list[tuple[dict[str, float], dict[str, list[float]]]] = [({}, {}) for _ in nodes]
        for place, entry in enumerate(found):
            if "failure" in entry:
                return entry
            values, slopes = runs[place // len(self._parts)]
            values |= entry["values"]
            slopes |= entry["slopes"]
            units |= entry["units"]
            samples |= entry["samples"]
        known = {} if self._scatter.laws else samples
        return combined(self._scatter, runs) | {"units": units, "samples": known}


def _parts(study: OptimisationStudy, progress: Progress) -> list[_Part]:
    """Return the figures of a study, scenario by scenario and analysis by analysis.

    What is wrong with them is noted.
    """
    parts: list[_Part] = []
    mistakes, places = study.form.mistakes, study.places_of_figures()
    for scenario, figures in study.figures_by_scenario().items():
        loaded, head = study.scenarios[scenario], f"{scenario}/" if scenario else ""
        progress(f"preparing {loaded.title}", None)
        with mistakes.at("scenarios", *[scenario] * bool(scenario)):
            own = {name: places[figure] for name, figure in figures.items()}
            parts += [_Part(item, head) for item in figures_of(mistakes, loaded, own, progress)]
    return parts
