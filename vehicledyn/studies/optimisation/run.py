"""Run an optimisation study."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.global_search import explore
from vehicledyn.analyse.objective import Evaluated
from vehicledyn.analyse.optimise import Optimum, optimise
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.target_digest import digests_to_keep
from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.optimum_table import KEPT, FrontPoint, OptimumTable
from vehicledyn.studies.failed_runs import failure_notes
from vehicledyn.studies.optimisation.problem import Problem
from vehicledyn.studies.optimisation.report import INFEASIBLE, Missed, OptimumReport
from vehicledyn.studies.optimisation.study import Limit, OptimisationStudy

Floats = NDArray[np.float64]

_STATIONARY = 1e-2
"""Part of the scaled gradient that may be left at an optimum, as at a corner of a figure."""


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
    asked = study.form.identity("most_runs")
    runs = kept.memory("optimise", asked, digests, asked_again=True)
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
        objective = report.rank[1]
        count = f"{report.table.n_runs} runs; {report.table.message}"
        notes.append(f"{name}: objective {objective:.6g} in {count}")
    notes.append(f"best choice: {choice}")
    n_runs = sum(report.table.n_runs for _, report in found)
    table = replace(best.table, n_runs=n_runs, notes=(*notes, *best.table.notes))
    return replace(best, table=table, was_stopped=any(report.was_stopped for _, report in found))


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
    front, others = _front(study, problem, found, progress)
    notes += others
    last = problem.evaluate(found.variables)
    notes += [
        f"deviation of {name}: {shown(first.deviations[name], problem.units[name])} -> "
        f"{shown(value, problem.units[name])}"
        for name, value in last.deviations.items()
    ]
    table = _table(study, problem, found, (first.values, last.values), last.slopes)
    table = replace(table, front=front, notes=(*notes, *table.notes))
    table = replace(table, limits=tuple(_limit_words(problem, found)))
    missed = () if found.is_feasible else _missed(problem, found)
    if missed:
        words = "; ".join(item.as_text() for item in missed)
        table = replace(table, status="infeasible", message=f"{INFEASIBLE} ({words})")
        table = replace(table, notes=(*table.notes, _advice(study, problem, found)))
    elif found.was_stopped:
        more = f"allow it more runs (most_runs) and go on with {argument('resume')}"
        note = f"the search is not at its end: {more}, or start where it is"
        table = replace(table, status="stopped", notes=(*table.notes, note))
    rank = _rank(problem, found)
    multipliers = found.multipliers.tolist()
    return OptimumReport(
        table,
        limits,
        multipliers,
        found.at_bound,
        rank,
        missed,
        n_known=problem.n_known,
        was_stopped=found.was_stopped,
    )


def _missed(problem: Problem, found: Optimum) -> tuple[Missed, ...]:
    """Return the constraints that an optimum does not keep, those kept to rounding aside."""
    return tuple(
        Missed(name, problem.units.get(name, "1"), sign > 0.0, limit, -float(value))
        for (name, sign, limit), value in zip(
            problem.limits(), found.values.constraints, strict=True
        )
        if value < -KEPT * (abs(limit) or 1.0)
    )


def _limit_words(problem: Problem, found: Optimum) -> Iterator[str]:
    """Yield words on each constraint: whether it is active, kept or missed."""
    for (name, sign, limit), value, weight in zip(
        problem.limits(), found.values.constraints, found.multipliers, strict=True
    ):
        unit, words = problem.units.get(name, "1"), "at least" if sign > 0.0 else "at most"
        if value < -KEPT * (abs(limit) or 1.0):
            described = f"missed by {shown(-float(value), unit)}"
        elif weight and found.is_feasible:
            step = f"1 {unit}".removesuffix(" 1")
            described = f"active; relaxing it by {step} gains {weight:.4g} of the objective"
        else:
            described = f"kept with {shown(float(value), unit)} to spare"
        yield f"{name} {words} {shown(limit, unit)}: {described}"


def _rank(problem: Problem, found: Optimum) -> tuple[float, float]:
    """Return what makes one optimum better than another: constraints first, then the objective."""
    sizes = np.array([abs(limit) or 1.0 for _, _, limit in problem.limits()])
    missed = float(np.max(-found.values.constraints / sizes, initial=0.0))
    return 0.0 if found.is_feasible else missed, found.values.objective


def _advice(study: OptimisationStudy, problem: Problem, found: Optimum) -> str:
    """Return what to do where no point keeps all constraints."""
    steps = []
    if found.was_stopped:
        steps.append(
            f"allow more than {study.most_runs} runs (most_runs) and go on with "
            f"{argument('resume')}"
        )
    steps.append("loosen what is missed, by that much or more")
    if found.at_bound:
        names = [f"'{problem.variables[k].name}'" for k in found.at_bound]
        steps.append(f"widen the bounds of {', '.join(names)}")
    if study.starts == 1:
        steps.append("search from several points (starts: 8) in case others keep them")
    return f"the values are those that miss least; {', or '.join(steps)}"


def _search(
    study: OptimisationStudy,
    problem: Problem,
    start: Floats,
    progress: Progress,
    further: Sequence[Limit] = (),
    *,
    least_size: float = 0.0,
) -> Optimum:
    """Return the optimum that a search from a start comes to."""
    count = itertools.count(1)

    def evaluate(point: Floats) -> Evaluated:
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
        least_size=least_size,
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
            words = item.message if item.is_feasible else INFEASIBLE
            notes.append(f"start {number}: objective {end}; {words}")
    optima = [item for item in found if isinstance(item, Optimum)]
    best = min(optima, key=lambda item: _rank(problem, item))
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
) -> tuple[tuple[FrontPoint, ...], list[str]]:
    """Return the best objective for each limit of the second figure, each from the last one.

    The objective keeps its size: at the optimum that the first one begins at it may be near zero.
    With warnings of what is no compromise.
    """
    if study.front is None:
        return (), []
    rows, notes, start = [], [], best.variables
    for value in study.front.values:
        limit = study.front.limit(value)
        found = _search(study, problem, start, progress, (limit,), least_size=best.size)
        notes += [
            f"warning: the compromise with {study.front.figure} {value}: {words}"
            for words in _doubts(found)
        ]
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
    return tuple(rows), notes


def _doubts(found: Optimum) -> list[str]:
    """Return why a point may be no optimum."""
    if not found.is_feasible:
        return ["no point was found that keeps it and all constraints"]
    words = convergence_notes(found, was_stopped=False)
    return [item.removeprefix("warning: ") for item in words]


def _table(
    study: OptimisationStudy,
    problem: Problem,
    found: Optimum,
    values: tuple[dict[str, float], dict[str, float]],
    slopes: dict[str, Any],
) -> OptimumTable:
    names = problem.figures
    notes = failure_notes(found.failures)
    notes += convergence_notes(found, was_stopped=found.was_stopped)
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


def convergence_notes(found: Optimum, *, was_stopped: bool) -> list[str]:
    """Return a warning where a search that was not stopped ended at no stationary point."""
    if not found.is_feasible or was_stopped:
        return []
    if found.message != "converged":
        return [f"warning: the search has not converged: {found.message}"]
    if found.optimality <= _STATIONARY:
        return []
    return [
        f"warning: no step is better, but {found.optimality:.0%} of the gradient is left: a figure "
        "has a corner or jumps there, or its gradient is not that of the motion; see the "
        "convergence, and seek with 'explore' or other 'starts'"
    ]


def _about(problem: Problem, name: str) -> Quantity:
    return Quantity(name, problem.units.get(name, "1"), "Figure of a run")
