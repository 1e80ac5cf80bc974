"""Handling of a car as a result file: curves by sheet, and key figures."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.results.store.linear_file import (
    Quantity,
    new_file,
    write_numbers,
    write_quantities,
    write_texts,
)

FORMAT = "vehicledyn-handling"

TRUTH = ""
"""Unit of a figure that is 1 for yes and 0 for no."""


@dataclass(frozen=True)
class Column:
    """Unit, meaning and values of a curve, shape (n_points,)."""

    unit: str
    description: str
    values: Any


Sheet = dict[str, Column]


@dataclass(frozen=True)
class KeyFigure:
    """A number that a test reports: in which test, value in SI, unit and meaning."""

    test: str
    name: str
    value: float
    unit: str
    description: str

    @property
    def key(self) -> str:
        """Name within the whole report."""
        return f"{self.test}.{self.name}"


@dataclass(frozen=True)
class HandlingTable:
    """Sheets of curves by name, each of columns of equal length, key figures, and notes."""

    title: str
    model: str
    sheets: dict[str, Sheet]
    figures: list[KeyFigure]
    notes: tuple[str, ...] = ()
    attributes: dict[str, Any] = field(default_factory=dict)

    def figure(self, key: str) -> float:
        """Return a key figure by its name within the report; NaN if there is none."""
        found = [figure.value for figure in self.figures if figure.key == key]
        return found[0] if found else float("nan")


def write_handling(path: Path, table: HandlingTable) -> None:
    """Write a table to a file.

    Raises
    ------
    InputError
        If it cannot be written.
    """
    head = {"title": table.title, "model": table.model, **table.attributes}
    with new_file(path, FORMAT, head) as file:
        for sheet, columns in table.sheets.items():
            count = len(next(iter(columns.values())).values)
            axis = f"{sheet}.point"
            words = ("1", f"Points of {sheet.replace('_', ' ')}")
            write_numbers(file, axis, np.arange(count), (), words)
            scale = file[axis]
            scale.make_scale(axis)
            for name, column in columns.items():
                told = (column.unit, column.description)
                write_numbers(file, f"{sheet}.{name}", column.values, (scale,), told)
        names = tuple(Quantity(f.key, f.unit, f.description) for f in table.figures)
        scale = write_quantities(file, "figure", names)
        values = np.array([figure.value for figure in table.figures])
        write_numbers(file, "figure_value", values, (scale,), ("", "Value of the key figure"))
        write_texts(file, "notes", table.notes)
