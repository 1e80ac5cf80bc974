"""What every kind of result file gives to a page: facts, key figures, figures, sections."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.results.report.page import Section, TextTable
from vehicledyn.results.report.texts import reading

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Figures = Iterator[tuple[str, "Figure"]]
_SMALLEST, _LARGEST = ".smallest", ".largest"


@dataclass(frozen=True)
class ReportFigure:
    """A number or text that sums the result up, in SI."""

    name: str
    value: Any
    unit: str
    meaning: str

    @property
    def text(self) -> str:
        """The value as a person reads it."""
        return reading(self.value, self.unit)


@dataclass(frozen=True)
class Content:
    """What a page shows of a file.

    ``state`` is empty where the result is complete; ``figures`` draws, ``details`` are the
    sections after the figures; both read the file anew, and only when they are asked for.
    """

    path: Path
    what: str
    title: str
    state: str
    facts: Sequence[tuple[str, str]]
    key_figures: Sequence[ReportFigure]
    figures: Callable[[], Figures]
    details: Callable[[], Sequence[Section]]
    warnings: Callable[[], Sequence[str]] = field(default=tuple)


def key_table(figures: Sequence[ReportFigure]) -> list[TextTable]:
    """Return key figures as a table, none if there are none."""
    rows = list(_rows(figures))
    return [TextTable(("Quantity", "Value"), rows, numbers=(1,))] if rows else []


def _rows(figures: Sequence[ReportFigure]) -> Iterator[tuple[str, str]]:
    """Yield meanings and values; smallest and largest value of one quantity as its range."""
    largest = {f.name: f for f in figures if f.name.endswith(_LARGEST)}
    ranges = {f.name for f in figures if f.name.removesuffix(_SMALLEST) + _LARGEST in largest}
    for figure in figures:
        if figure.name in ranges and figure.name.endswith(_SMALLEST):
            quantity = figure.name.removesuffix(_SMALLEST)
            yield f"Range of {quantity}", f"{figure.text} to {largest[quantity + _LARGEST].text}"
        elif figure.name.removesuffix(_LARGEST) + _SMALLEST not in ranges:
            yield figure.meaning or words(figure.name), figure.text


def words(name: str) -> str:
    """Return a name as words: "wall_seconds" as "Wall seconds"."""
    text = name.replace("_", " ")
    return text[:1].upper() + text[1:]
