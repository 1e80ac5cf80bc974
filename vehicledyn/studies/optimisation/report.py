"""What an optimisation study came to, for people and programs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vehicledyn.base.units import shown
from vehicledyn.results.tables.optimum_table import OptimumTable
from vehicledyn.studies.failed_runs import known_runs

INFEASIBLE = "no point was found that keeps all constraints"


@dataclass(frozen=True)
class Missed:
    """A constraint that is not kept: the figure, its limit, and by how much it is missed, in SI."""

    figure: str
    unit: str
    is_lower: bool
    limit: float
    amount: float

    def as_text(self) -> str:
        """Return it in words."""
        value = self.limit + (-self.amount if self.is_lower else self.amount)
        words = "at least" if self.is_lower else "at most"
        return (
            f"{self.figure} is {shown(value, self.unit)}, {words} {shown(self.limit, self.unit)} "
            f"is asked for: missed by {shown(self.amount, self.unit)}"
        )


@dataclass(frozen=True)
class OptimumReport:
    """An optimum for people and programs."""

    table: OptimumTable
    limits: list[tuple[str, float, float]]
    multipliers: list[float]
    at_bound: list[int]
    rank: tuple[float, float] = (0.0, 0.0)
    """By which part of its limit a constraint is missed, zero where all are kept; the objective."""
    missed: tuple[Missed, ...] = ()
    n_known: int = 0
    """Runs that were known from before, which the result does not depend on."""
    was_stopped: bool = False
    """Whether a search took all runs that it may, so that there is more to be found."""

    @property
    def messages(self) -> tuple[str, ...]:
        """Remarks."""
        return self.table.notes

    def as_text(self) -> str:
        """Return variables, figures and how stationary the point is."""
        table = self.table
        lines = [f"{table.title}: {INFEASIBLE if self.missed else table.message}"]
        lines += [f"  {item.as_text()}" for item in self.missed]
        end = "" if self.missed else f"; optimality {table.optimality:.2g}"
        lines.append(f"  {table.n_runs} runs with gradients{end}")
        for k, item in enumerate(table.variables):
            bound = "  at its bound" if k in self.at_bound else ""
            start, best = (shown(float(v[k]), item.unit) for v in (table.start, table.best))
            lines.append(f"  {item.name}: {start} -> {best}{bound}")
        for k, item in enumerate(table.figures):
            start, best = (shown(float(v[k]), item.unit) for v in table.figure_values)
            lines.append(f"  {item.name}: {start} -> {best}")
        units = {item.name: item.unit for item in table.figures}
        for (name, sign, value), weight in zip(self.limits, self.multipliers, strict=True):
            if weight and not self.missed:
                words, unit = "at least" if sign > 0.0 else "at most", units.get(name, "1")
                step = f"1 {unit}".removesuffix(" 1")
                lines.append(
                    f"  active: {name} {words} {shown(value, unit)}; relaxing it by {step} gains "
                    f"{weight:.4g}"
                )
        if table.front and table.front_figure is not None:
            lines.append(f"  front: objective, {table.front_figure.name}, optimality, runs")
            lines += [
                f"    {item.objective:.6g}  {shown(item.figure, table.front_figure.unit)}"
                f"  {item.optimality:.1g}  {item.n_runs}"
                + ("" if item.is_kept else "  constraints not kept")
                for item in table.front
            ]
        return "\n".join([*lines, *table.notes, *known_runs(self.n_known)])

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data, in SI."""
        table = self.table
        return {
            "title": table.title,
            "status": table.status,
            "message": table.message,
            "missed": [
                {
                    "figure": item.figure,
                    "at_least" if item.is_lower else "at_most": item.limit,
                    "by": item.amount,
                    "unit": item.unit,
                }
                for item in self.missed
            ],
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
                if weight and not self.missed
            ],
            "front": [
                {
                    "objective": item.objective,
                    "figure": item.figure,
                    "optimality": item.optimality,
                    "kept": item.is_kept,
                    "variables": item.variables.tolist(),
                }
                for item in table.front
            ],
            "notes": list(table.notes),
        }
