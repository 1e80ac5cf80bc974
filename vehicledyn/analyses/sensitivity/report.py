"""Derivatives as ranked tables and as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.base.units import shown
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

_ROWS = 15


@dataclass(frozen=True)
class SensitivityReport:
    """The report of a table of derivatives."""

    table: SensitivityTable

    @property
    def messages(self) -> tuple[str, ...]:
        """Remarks and warnings."""
        return self.table.notes

    def as_text(self) -> str:
        """Return for each figure the parameters that change it most, largest first."""
        table = self.table
        lines = [f"{table.title}: derivatives by {len(table.parameters)} parameters"]
        for row, figure in enumerate(table.figures):
            lines += ["", *self._figure(row, figure.name, figure.unit, figure.description)]
        lines += ["", *table.notes] if table.notes else []
        return "\n".join(lines)

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data, in SI; null where no derivative exists."""
        table = self.table
        return {
            "title": table.title,
            "model": table.model,
            "parameters": [
                {"name": p.name, "unit": p.unit, "value": _number(v)}
                for p, v in zip(table.parameters, table.parameter_values, strict=True)
            ],
            "figures": [
                {
                    "name": figure.name,
                    "unit": figure.unit,
                    "value": float(table.values[row]),
                    "slopes": [_number(s) for s in table.slopes[row]],
                    **self._place(row),
                }
                for row, figure in enumerate(table.figures)
            ],
            "notes": list(table.notes),
        }

    def _place(self, row: int) -> dict[str, Any]:
        places = self.table.places
        return {} if places is None else {"parameter_values": [_number(v) for v in places[row]]}

    def _figure(self, row: int, name: str, unit: str, description: str) -> list[str]:
        table = self.table
        head = f"{name} = {shown(float(table.values[row]), unit)} ({description})"
        if np.all(np.isnan(table.slopes[row])):
            return [head, "  no derivative exists here"]
        order = table.ranked(row)
        active = [k for k in order if table.slopes[row][k] != 0.0]
        shown_rows = active[:_ROWS]
        width = max([len(table.parameters[k].name) for k in shown_rows] or [0])
        lines = [head, f"  {'parameter':{width}}  {'value':>14}  {'derivative':>24}  by 1 %"]
        for k in shown_rows:
            parameter, effect = table.parameters[k], table.elasticities[row][k]
            lost = np.isnan(table.slopes[row][k])
            slope = "none" if lost else f"{table.slopes[row][k]:.6g} {table.unit(row, k)}"
            value = shown(float(table.values_at(row)[k]), parameter.unit)
            change = shown(float(effect), unit) if effect and np.isfinite(effect) else "-"
            lines.append(f"  {parameter.name:{width}}  {value:>14}  {slope:>24}  {change}")
        rest, idle = len(active) - len(shown_rows), len(order) - len(active)
        if rest:
            lines.append(f"  and {rest} more with smaller effects")
        if idle:
            lines.append(f"  {idle} parameters have no effect")
        return lines


def _number(value: float) -> float | None:
    """Return a number as plain data, None if there is none."""
    return None if np.isnan(value) else float(value)
