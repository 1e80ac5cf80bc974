"""Reports of handling analyses: key figures as text and plain data, one car or two."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from vehicledyn.base.units import shown
from vehicledyn.results.tables.handling_headings import heading
from vehicledyn.results.tables.handling_table import TRUTH, HandlingTable, KeyFigure


@dataclass(frozen=True)
class HandlingReport:
    """Key figures of a car, beside those of a second one if there is one."""

    table: HandlingTable
    other: HandlingTable | None = None
    messages: list[str] = field(default_factory=list)

    def as_text(self) -> str:
        """Return the key figures test by test, in columns."""
        tables = [self.table] + ([self.other] if self.other is not None else [])
        lines = [f"{self.table.title}: {' against '.join(table.model for table in tables)}"]
        known = [{f.key: f for f in table.figures} for table in tables]
        tests = dict.fromkeys(f.test for table in tables for f in table.figures)
        keys = list(dict.fromkeys(key for figures in known for key in figures))
        for test in tests:
            lines += ["", heading(test)]
            for key in keys:
                figure = next(figures[key] for figures in known if key in figures)
                if figure.test == test:
                    values = "".join(f"{text_of(figures.get(key)):>18}" for figures in known)
                    lines.append(f"  {values}  {figure.description}")
        notes = [f"{table.model}: {note}" for table in tables for note in table.notes]
        return "\n".join([*lines, *([""] if notes else []), *notes])

    def as_dict(self) -> dict[str, Any]:
        """Return the key figures as plain data in SI."""
        return {
            "title": self.table.title,
            "cars": [
                {
                    "model": table.model,
                    "figures": {f.key: _plain(f) for f in table.figures},
                    "notes": list(table.notes),
                }
                for table in (self.table, self.other)
                if table is not None
            ],
        }


def text_of(figure: KeyFigure | None) -> str:
    """Return a figure as a person reads it."""
    if figure is None or math.isnan(figure.value):
        return "-"
    if figure.unit == TRUTH:
        return "yes" if figure.value else "no"
    return shown(figure.value, figure.unit)


def _plain(figure: KeyFigure) -> Any:
    if figure.unit == TRUTH:
        return bool(figure.value)
    return {"value": figure.value, "unit": figure.unit, "description": figure.description}
