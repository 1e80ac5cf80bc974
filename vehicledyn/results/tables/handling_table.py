"""Handling of a car as a result file: curves by sheet, and key figures."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.results.store.consistency import Sizes
from vehicledyn.results.store.linear_file import (
    Quantity,
    new_file,
    old_file,
    read_texts,
    write_axis,
    write_numbers,
    write_texts,
)
from vehicledyn.results.tables.columns import Column
from vehicledyn.results.tables.key_figures import read_key_figures, write_key_figures

FORMAT = "vehicledyn-handling"

TRUTH = ""
"""Unit of a figure that is 1 for yes and 0 for no."""


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
            scale = write_axis(file, axis, np.arange(count, dtype=float), words)
            for name, column in columns.items():
                words = (column.unit, column.description)
                write_numbers(file, f"{sheet}.{name}", column.values, (scale,), words)
        write_key_figures(
            file, ((Quantity(f.key, f.unit, f.description), f.value) for f in table.figures)
        )
        write_texts(file, "notes", table.notes)


def read_handling(path: Path) -> HandlingTable:
    """Read a table from a file.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged or of another format.
    """
    sheets: dict[str, Sheet] = {}
    sizes = Sizes()
    with old_file(path, FORMAT) as file:
        for place in file:
            sheet, _, name = place.partition(".")
            if not name or name == "point":
                continue
            unit, meaning = (str(file[place].attrs[key]) for key in ("units", "long_name"))
            values = sizes.read(file, place, f"points of {sheet}", infinite=True)
            sheets.setdefault(sheet, {})[name] = Column(unit, meaning, values)
        figures = [_figure(quantity, value) for quantity, value in read_key_figures(file)]
        title, model = str(file.attrs["title"]), str(file.attrs["model"])
        return HandlingTable(title, model, sheets, figures, tuple(read_texts(file, "notes")))


def _figure(quantity: Quantity, value: float) -> KeyFigure:
    test, _, name = quantity.name.partition(".")
    return KeyFigure(test, name, value, quantity.unit, quantity.description)
