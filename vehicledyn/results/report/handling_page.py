"""The page of handling tests: key figures test by test, beside those of a second car, figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

from vehicledyn.results.hdf5.page_file import check_page, write_page
from vehicledyn.results.plots.handling.test_figures import handling_figures
from vehicledyn.results.report.images import picture
from vehicledyn.results.report.page import Notes, Page, PictureRow, Section, TextTable, render
from vehicledyn.results.report.texts import change, reading
from vehicledyn.results.tables.handling_headings import heading
from vehicledyn.results.tables.handling_table import TRUTH, HandlingTable, KeyFigure

Progress = Callable[[str, float | None], None]


def write_handling_page(target: Path, tables: Sequence[HandlingTable], progress: Progress) -> None:
    """Write the page of one car or two.

    Raises
    ------
    InputError
        If it cannot be written, such as over a file that is no report.
    MissingPartError
        If jinja2 is not installed.
    """
    import matplotlib

    from vehicledyn.results.plots.plot_style import STYLE

    check_page(target, "report")
    pictures = []
    with matplotlib.rc_context(STYLE):
        for name, figure in handling_figures(tables):
            progress(f"drawing {name.replace('_', ' ')}", None)
            pictures.append(picture(figure))
    names = [table.model for table in tables]
    sections = [Section(heading(test), [_table(tables, test)]) for test in _tests(tables)]
    notes = [f"{table.model}: {note}" for table in tables for note in table.notes]
    if notes:
        sections.insert(0, Section("Notes", [Notes(notes, warning=True)]))
    sections.append(Section("Figures", [PictureRow(pictures)]))
    title = f"{tables[0].title}: {' against '.join(names)}"
    write_page(target, render(Page(title, "handling of a road vehicle", sections)))


def _tests(tables: Sequence[HandlingTable]) -> list[str]:
    return list(dict.fromkeys(figure.test for table in tables for figure in table.figures))


def _table(tables: Sequence[HandlingTable], test: str) -> TextTable:
    known = [{f.key: f for f in table.figures if f.test == test} for table in tables]
    rows = []
    for key in dict.fromkeys(key for figures in known for key in figures):
        found = [figures.get(key) for figures in known]
        meaning = next(f.description for f in found if f is not None)
        cells = [_text(figure) for figure in found]
        rows.append((meaning, *cells, *([_change(*found)] if len(found) == 2 else [])))
    head = ["Quantity", *(table.model for table in tables)]
    head += ["Difference"] if len(tables) == 2 else []
    return TextTable(head, rows, numbers=tuple(range(1, len(head))))


def _text(figure: KeyFigure | None) -> str:
    if figure is None or math.isnan(figure.value):
        return "–"
    if figure.unit == TRUTH:
        return reading(bool(figure.value), "")
    return reading(figure.value, figure.unit)


def _change(first: KeyFigure | None, second: KeyFigure | None) -> str:
    if first is None or second is None or first.unit != second.unit:
        return "–"
    if first.unit == TRUTH:
        return "equal" if first.value == second.value else "different"
    return change(first.value, second.value, first.unit)
