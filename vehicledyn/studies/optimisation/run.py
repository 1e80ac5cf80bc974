"""Run an optimisation study, and report what it came to."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.analyse.optimise import Optimum, optimise
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.units import shown
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.optimum_table import OptimumTable
from vehicledyn.studies.kept_runs import KeptRuns
from vehicledyn.studies.optimisation.file import OptimisationStudy
from vehicledyn.studies.optimisation.problem import Problem


@dataclass(frozen=True)
class OptimumReport:
    """An optimum for people and programs."""

    table: OptimumTable
    limits: list[tuple[str, float, float]]
    multipliers: list[float]
    at_bound: list[int]

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
            "notes": list(table.notes),
        }


def run_optimisation(
    study: OptimisationStudy, *, kept: Path | None, resume: bool, progress: Progress
) -> OptimumReport:
    """Return the optimum of a study.

    Parameters
    ----------
    study
        The validated study.
    kept
        File for the evaluations, so that a stopped search can be gone on with; None for none.
    resume
        Whether to use the evaluations that are there already.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If the study means nothing, or the evaluations are those of another one.
    NumericalError
        If the start has no motion or no derivatives.
    """
    configurations = [loaded.text + repr(loaded.overrides) for loaded in study.scenarios.values()]
    runs = KeptRuns(kept, [study.text, *configurations], resume=resume)
    problem = Problem(study, runs, progress)
    first, _ = problem.evaluate(problem.start)
    limits = problem.limits()
    count = 0

    def evaluate(point: Any) -> Any:
        nonlocal count
        count += 1
        found = problem.values(point)
        progress(f"run {count}: objective {found.objective:.8g}", None)
        return found

    found = optimise(
        evaluate,
        start=problem.start,
        bounds=(problem.low, problem.high),
        tolerance=study.tolerance,
        most_runs=study.most_runs,
    )
    figures, slopes = problem.evaluate(found.variables)
    table = _table(study, problem, found, (first, figures), slopes)
    return OptimumReport(table, limits, found.multipliers.tolist(), found.at_bound)


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
        tuple(Quantity(name, problem.units.get(name, "1"), "Figure of a run") for name in names),
        np.array([[part[name] for name in names] for part in values]),
        np.array([slopes[name] for name in names]),
        np.array(points),
        np.array(objective),
        np.array(violation),
        found.optimality,
        found.n_runs,
        tuple(notes),
    )
