"""Run an optimisation study, and report what it came to."""

from __future__ import annotations

import itertools
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.global_search import explore
from vehicledyn.analyse.optimise import Optimum, Values, optimise
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.target_digest import digests_to_keep
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.optimum_table import FrontPoint, OptimumTable
from vehicledyn.studies.optimisation.file import Limit, OptimisationStudy
from vehicledyn.studies.optimisation.problem import Problem

Floats = NDArray[np.float64]

_KEPT = 1e-5
"""Scaled violation up to which constraints are kept."""


@dataclass(frozen=True)
class OptimumReport:
    """An optimum for people and programs."""

    table: OptimumTable
    limits: list[tuple[str, float, float]]
    multipliers: list[float]
    at_bound: list[int]
    rank: tuple[bool, float] = (False, 0.0)
    """Whether a constraint is not kept, and the objective."""

    @property
    def messages(self) -> tuple[str, ...]:
        """Remarks."""
        return self.table.notes

    def as_text(self) -> str:
        """Return variables, figures and how stationary the point is."""
        table = self.table
        lines = [f"{table.title}: {table.message}"]
        lines.append(f"  {table.n_runs} runs with gradients; optimality {table.optimality:.2g}")
        for k, item in enumerate(table.variables):
            bound = "  at its bound" if k in self.at_bound else ""
            start, best = (shown(float(v[k]), item.unit) for v in (table.start, table.best))
            lines.append(f"  {item.name}: {start} -> {best}{bound}")
        for k, item in enumerate(table.figures):
            start, best = (shown(float(v[k]), item.unit) for v in table.figure_values)
            lines.append(f"  {item.name}: {start} -> {best}")
        for (name, sign, value), weight in zip(self.limits, self.multipliers, strict=True):
            if weight:
                words = "at least" if sign > 0.0 else "at most"
                lines.append(
                    f"  active: {name} {words} {value:g}; relaxing it by 1 gains {weight:.4g}"
                )
        if table.front and table.front_figure is not None:
            lines.append(f"  front: objective, {table.front_figure.name}, optimality, runs")
            lines += [
                f"    {item.objective:.6g}  {shown(item.figure, table.front_figure.unit)}"
                f"  {item.optimality:.1g}  {item.n_runs}"
                + ("" if item.violation <= _KEPT else "  constraints not kept")
                for item in table.front
            ]
        return "\n".join([*lines, *table.notes])

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data, in SI."""
        table = self.table
        return {
            "title": table.title,
            "message": table.message,
            "runs": table.n_runs,
            "optimality": table.optimality,
            "variables": {
                item.name: {"start": float(table.start[k]), "best": float(table.best[k])}
                for k, item in enumerate(table.variables)
            },
            "set": {
                f"parameters.{item.name}": f"{float(table.best[k])!r} {item.unit}".removesuffix(
                    " 1"
                )
                for k, item in enumerate(table.variables)
            },
            "figures": {
                item.name: {"start": float(first), "best": float(last)}
                for item, first, last in zip(table.figures, *table.figure_values, strict=True)
            },
            "active": [
                name
                for (name, _, _), weight in zip(self.limits, self.multipliers, strict=True)
                if weight
            ],
            "front": [
                {
                    "objective": item.objective,
                    "figure": item.figure,
                    "optimality": item.optimality,
                    "kept": item.violation <= _KEPT,
                    "variables": item.variables.tolist(),
                }
                for item in table.front
            ],
            "notes": list(table.notes),
        }


def run_optimisation(
    study: OptimisationStudy, *, kept: KeptWork, progress: Progress
) -> OptimumReport:
    """Return the optimum of a study.

    Parameters
    ----------
    study
        The validated study.
    kept
        What is kept while it is searched for.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If the study means nothing, or the evaluations are those of another one.
    NumericalError
        If the start has no motion or no derivatives.
    """
    variants = study.choices or (("", study.scenarios),)
    loaded = [scenario for _, group in variants for scenario in group.values()]
    digests = digests_to_keep(kept, loaded)
    runs = kept.memory("optimise", study.text, digests, asked_again=True)
    found: list[tuple[str, OptimumReport]] = []
    notes = []
    for choice, scenarios in variants:
        if choice:
            progress(f"choosing {choice}", None)
        try:
            own = replace(study, scenarios=scenarios)
            found.append((choice, _optimum(own, runs, progress, choice)))
        except NumericalError as error:
            if not choice:
                raise
            notes.append(f"{choice}: no motion: {error}")
    if not found:
        raise NumericalError(f"no choice has a motion: {'; '.join(notes)}")
    choice, best = min(found, key=lambda item: item[1].rank)
    if not choice:
        return best
    for name, report in found:
        objective, kept_all = report.rank[1], "" if not report.rank[0] else "; constraints not kept"
        count = f"{report.table.n_runs} runs; {report.table.message}{kept_all}"
        notes.append(f"{name}: objective {objective:.6g} in {count}")
    notes.append(f"best choice: {choice}")
    n_runs = sum(report.table.n_runs for _, report in found)
    table = replace(best.table, n_runs=n_runs, notes=(*notes, *best.table.notes))
    return replace(best, table=table)


def _optimum(
    study: OptimisationStudy, runs: Memory, progress: Progress, choice: str
) -> OptimumReport:
    """Return the optimum for the scenarios of a study, one of several choices or the only one."""
    problem = Problem(study, runs, progress, choice)
    first = problem.evaluate(problem.start)
    limits = problem.limits()
    notes = [f"warning: '{name}' changes no figure at the start" for name in problem.idle()]
    notes += problem.unconfirmed()
    found, others = _search_all(study, problem, progress)
    notes += others
    front = _front(study, problem, found, progress)
    last = problem.evaluate(found.variables)
    notes += [
        f"deviation of {name}: {shown(first.deviations[name], problem.units[name])} -> "
        f"{shown(value, problem.units[name])}"
        for name, value in last.deviations.items()
    ]
    table = _table(study, problem, found, (first.values, last.values), last.slopes)
    table = replace(table, front=front, notes=(*notes, *table.notes))
    rank = (found.violation > _KEPT, found.values.objective)
    return OptimumReport(table, limits, found.multipliers.tolist(), found.at_bound, rank)


def _search(
    study: OptimisationStudy,
    problem: Problem,
    start: Floats,
    progress: Progress,
    further: Sequence[Limit] = (),
) -> Optimum:
    """Return the optimum that a search from a start comes to."""
    count = itertools.count(1)

    def evaluate(point: Floats) -> Values:
        found = problem.values(point, further)
        progress(f"run {next(count)}: objective {found.objective:.8g}", None)
        return found

    return optimise(
        evaluate,
        start=start,
        bounds=(problem.low, problem.high),
        tolerance=study.tolerance,
        most_runs=study.most_runs,
        method=study.optimiser,
    )


def _search_all(
    study: OptimisationStudy, problem: Problem, progress: Progress
) -> tuple[Optimum, list[str]]:
    """Return the best of the optima from all starts, found at once on several cores, and notes."""

    def search(start: Floats) -> Optimum | str:
        try:
            return _search(study, problem, start, progress)
        except NumericalError as error:
            return str(error)

    starts = problem.starts(study.starts, study.seed)
    notes = []
    if study.explore:
        begin, note = _explored(study, problem, progress)
        starts, notes = [begin, *starts[1:]], [note]
    if len(starts) == 1:
        return _search(study, problem, starts[0], progress), notes
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(search, starts))
    for number, item in enumerate(found, 1):
        if isinstance(item, str):
            notes.append(f"start {number}: no motion: {item}")
        else:
            end = f"{item.values.objective:.6g} in {item.n_runs} runs"
            notes.append(f"start {number}: objective {end}; {item.message}")
    optima = [item for item in found if isinstance(item, Optimum)]
    best = min(optima, key=lambda item: (item.violation > _KEPT, item.values.objective))
    n_runs = sum(item.n_runs for item in optima)
    history = [row for item in optima for row in item.history]
    return replace(best, n_runs=n_runs, history=history), notes


def _explored(study: OptimisationStudy, problem: Problem, progress: Progress) -> tuple[Floats, str]:
    """Return the better one of the given start and what a search of the whole box found."""
    first = problem.values(problem.start)
    size = (
        max(
            abs(first.objective),
            float(np.max(np.abs(first.gradient * (problem.high - problem.low)))),
        )
        or 1.0
    )
    count = itertools.count(1)

    def evaluate(point: Floats) -> tuple[float, float] | None:
        progress(f"exploring, run {next(count)}", None)
        return problem.explored(point)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = explore(
            evaluate,
            (problem.low, problem.high),
            n_runs=study.explore,
            seed=study.seed,
            size=size,
            mapped=pool.map,
        )
    best = problem.explored(found)
    words = "no motion" if best is None else f"objective {best[0]:.6g}"
    note = f"explored the bounds in {next(count) - 1} runs without gradients: {words}"
    own = problem.explored(problem.start)
    if best is None or (own is not None and (own[1] > 0.0, own[0]) < (best[1] > 0.0, best[0])):
        return problem.start, f"{note}; the start is better"
    return found, note


def _front(
    study: OptimisationStudy, problem: Problem, best: Optimum, progress: Progress
) -> tuple[FrontPoint, ...]:
    """Return the best objective for each limit of the second figure, each from the last one."""
    if study.front is None:
        return ()
    rows, start = [], best.variables
    for value in study.front.values:
        found = _search(study, problem, start, progress, (study.front.limit(value),))
        figures = problem.evaluate(found.variables).values
        start = found.variables
        rows.append(
            FrontPoint(
                found.variables,
                found.values.objective,
                figures[study.front.figure],
                found.optimality,
                found.violation,
                found.n_runs,
            )
        )
    return tuple(rows)


def _table(
    study: OptimisationStudy,
    problem: Problem,
    found: Optimum,
    values: tuple[dict[str, float], dict[str, float]],
    slopes: dict[str, Any],
) -> OptimumTable:
    names = problem.figures
    notes = [f"a run failed: {reason}" for reason in found.failures]
    if problem.n_known:
        notes.append(f"{problem.n_known} runs were known from before")
    points, objective, violation = zip(*found.history, strict=True)
    return OptimumTable(
        study.title,
        found.message,
        problem.variables,
        problem.low,
        problem.high,
        problem.start,
        found.variables,
        tuple(_about(problem, name) for name in names),
        np.array([[part[name] for name in names] for part in values]),
        np.array([slopes[name] for name in names]),
        np.array(points),
        np.array(objective),
        np.array(violation),
        found.optimality,
        found.n_runs,
        tuple(notes),
        front_figure=None if study.front is None else _about(problem, study.front.figure),
    )


def _about(problem: Problem, name: str) -> Quantity:
    return Quantity(name, problem.units.get(name, "1"), "Figure of a run")
