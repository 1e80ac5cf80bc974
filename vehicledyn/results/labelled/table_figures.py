"""Key figures of the files of studies: what was found, by names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

from vehicledyn.base.units import digits_of, shown
from vehicledyn.results.store.layout import SummaryEntry
from vehicledyn.results.tables import (
    hunt_table,
    identification_table,
    optimum_table,
    uncertainty_table,
)


def key_figures(path: Path, kind: str) -> Mapping[str, SummaryEntry]:
    """Return the key figures of a file of a format, of most formats none."""
    found = _FIGURES.get(kind)
    return {} if found is None else {entry.name: entry for entry in found(path)}


def _critical_values(path: Path) -> Iterable[SummaryEntry]:
    table = hunt_table.read_hunt(path)
    meanings = hunt_table.FIGURE_MEANINGS
    for name, value in table.figures.items():
        yield SummaryEntry(name, value, table.figure_unit(name), meanings.get(name, name))


def _identified(path: Path) -> Iterable[SummaryEntry]:
    """Yield the parameters, which say their intervals."""
    table = identification_table.read_identification(path)
    for item, value, low, high in zip(
        table.parameters, table.value, table.low, table.high, strict=True
    ):
        digits = digits_of(float(value), float(high - low))
        ends = [shown(float(end), item.unit, digits) for end in (low, high)]
        words = f"{item.description or item.name} (95 %: {ends[0]} to {ends[1]})"
        yield SummaryEntry(item.name, float(value), item.unit, words)


def _spread(path: Path) -> Iterable[SummaryEntry]:
    """Yield the means of figures, which say their deviations."""
    table = uncertainty_table.read_uncertainty(path)
    for item, mean, deviation in zip(table.figures, table.mean, table.deviation, strict=True):
        words = f"Mean of {item.name} (deviation {shown(float(deviation), item.unit)})"
        yield SummaryEntry(item.name, float(mean), item.unit, words)


def _optimal(path: Path) -> Iterable[SummaryEntry]:
    """Yield the variables and figures of the optimum."""
    table = optimum_table.read_optimum(path)
    for items, values in ((table.variables, table.best), (table.figures, table.figure_values[1])):
        for item, value in zip(items, values, strict=True):
            words = f"{item.description or item.name}, at the optimum"
            yield SummaryEntry(item.name, float(value), item.unit, words)


_FIGURES: dict[str, Callable[[Path], Iterable[SummaryEntry]]] = {
    hunt_table.FORMAT: _critical_values,
    identification_table.FORMAT: _identified,
    uncertainty_table.FORMAT: _spread,
    optimum_table.FORMAT: _optimal,
}
