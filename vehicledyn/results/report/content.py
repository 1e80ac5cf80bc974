"""What every kind of result file gives to a page: facts, key figures, figures, sections."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError
from vehicledyn.results.report.page import Section, Table
from vehicledyn.results.report.texts import reading

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Figures = Iterator[tuple[str, "Figure"]]
_SMALLEST, _LARGEST = ".smallest", ".largest"
LARGEST_TABLE = 1 << 30
"""Bytes that a file which is read whole may promise."""


@dataclass(frozen=True)
class KeyFigure:
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
    key_figures: Sequence[KeyFigure]
    figures: Callable[[], Figures]
    details: Callable[[], Sequence[Section]]
    warnings: Callable[[], Sequence[str]] = field(default=tuple)


def read_content(path: Path) -> Content:
    """Return what a page shows of a result file of any kind.

    Raises
    ------
    InputError
        If there is no such file, or it is not of this program, damaged, or of a newer version.
    """
    from vehicledyn.results.hdf5.opening import is_open_for_writing
    from vehicledyn.results.plots.linear_results import is_linear
    from vehicledyn.results.store.study_reader import is_study_file

    is_open_for_writing(path)  # says what is not there or not HDF5
    if is_study_file(path):
        from vehicledyn.results.report.study_content import study_content

        return study_content(path)
    if is_linear(path):
        from vehicledyn.results.report.linear_content import linear_content

        _refuse_giants(path)
        return linear_content(path)
    from vehicledyn.results.report.run_content import run_content

    return run_content(path)


def key_table(figures: Sequence[KeyFigure]) -> list[Table]:
    """Return key figures as a table, none if there are none."""
    rows = list(_rows(figures))
    return [Table(("Quantity", "Value"), rows, numbers=(1,))] if rows else []


def _rows(figures: Sequence[KeyFigure]) -> Iterator[tuple[str, str]]:
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


def _refuse_giants(path: Path) -> None:
    import h5py

    from vehicledyn.results.hdf5.damage import reading
    from vehicledyn.results.hdf5.opening import open_file
    from vehicledyn.results.store.decimation import promises_too_much

    sizes = []

    def measure(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset):
            if promises_too_much(item):
                raise InputError(f"{path}: is damaged: {name} is not in the file; compute it again")
            sizes.append(item.size * item.dtype.itemsize)

    with reading(path), open_file(path) as file, reading(path, file):
        file.visititems(measure)
    if sum(sizes) > LARGEST_TABLE:
        raise InputError(f"{path}: holds {sum(sizes):.3g} bytes, too many for a page")
