"""Tables of named columns with units, as CSV: read at once, every problem reported with its line.

The first line that is no comment names the columns, each with its unit in brackets, such as
``s [m], cant [mm], kind``. A # opens a comment. Columns are parted by commas, semicolons or tabs;
quotation marks around a cell are left out.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.files.limits import read_regular
from vehicledyn.base.problems import START, Mark, Problem, refusal
from vehicledyn.base.units import parse_unit

LARGEST_FILE = 50_000_000
_HEAD = re.compile(r"([A-Za-z_]\w*(?:\.\w+)*)\s*(?:[\[(]([^\])]*)[\])])?")
_MOST_TOLD = 20
_NO_NUMBER = ("nan", "+nan", "-nan")


@dataclass(frozen=True)
class ColumnKind:
    """What a column holds: the unit of its numbers in SI, or texts where that is None.

    ``may_be_nan`` says that cells with ``nan`` are as good as empty ones, as measuring programs
    write gaps; ``is_raw`` that numbers are wanted as they are written, whatever their unit.
    """

    unit: str | None
    required: bool = False
    may_be_nan: bool = False
    is_raw: bool = False


@dataclass
class Columns:
    """Columns of a file by name: numbers in SI and texts, line by line.

    An empty cell is None in ``texts`` and not a number in ``numbers``. ``lines`` are the numbers
    of the lines in the file, and ``places`` those of the columns in it, both from one; ``others``
    are heads of columns that are passed over.
    """

    file: str
    lines: list[int] = field(default_factory=list)
    places: dict[str, int] = field(default_factory=dict)
    numbers: dict[str, list[float]] = field(default_factory=dict)
    texts: dict[str, list[str | None]] = field(default_factory=dict)
    starts: list[list[int]] = field(default_factory=list)
    others: list[str] = field(default_factory=list)

    def problem(self, row: int, name: str, words: str) -> Problem:
        """Return the problem that the value of a row and column is."""
        place, starts = self.places.get(name, 1), self.starts[row]
        column = starts[min(place, len(starts)) - 1]
        return Problem(self.file, Mark(self.lines[row], column), name, words)


def read_columns(path: Path, known: Mapping[str, ColumnKind], *, is_open: bool = False) -> Columns:
    """Return the columns of a file.

    Parameters
    ----------
    path
        The file, UTF-8 text.
    known
        Columns that it may have.
    is_open
        Whether it may have others too, which are passed over.

    Raises
    ------
    InputError
        If it cannot be read, has no columns or lines, or a value is none; one line for each
        problem with file, line and column.
    """
    lines = _lines(path)
    columns, separator, begin = _head(str(path), lines, known, is_open=is_open)
    problems: list[Problem] = []
    heads = _heads(lines[begin - 1], separator)
    factors = {
        name: 1.0 if known[name].is_raw else _factor(unit)
        for name, unit in heads
        if name in columns.places
    }
    for number in range(begin, len(lines)):
        text = lines[number].partition("#")[0]
        if not text.strip(" \t,;"):
            continue
        problems += _taken(columns, number + 1, _cells(text, separator), known, factors)
        if len(problems) >= _MOST_TOLD:
            break
    if not columns.lines and not problems:
        mark = Mark(len(lines), 1)
        problems.append(Problem(str(path), mark, "", "the table has no lines below its head"))
    if problems:
        raise refusal(problems, str(path))
    return columns


def stated_units(path: Path) -> dict[str, str | None]:
    """Return the units that the head of a file states, by column; None where it states none.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    texts = (line.partition("#")[0] for line in _lines(path))
    head = next((text for text in texts if text.strip()), "")
    separator = next((s for s in ";\t," if s in head), ",")
    return dict(_heads(head, separator))


def _taken(
    columns: Columns,
    line: int,
    cells: list[tuple[int, str]],
    known: Mapping[str, ColumnKind],
    factors: Mapping[str, float],
) -> list[Problem]:
    """Enter the cells of a line and return what is wrong with them."""
    problems = []
    columns.lines.append(line)
    columns.starts.append([start for start, _ in cells] or [1])
    row = len(columns.lines) - 1
    width = len(columns.places) + len(columns.others)
    if len(cells) > width:
        words = f"{len(cells)} values, but the head names {width} columns"
        problems.append(Problem(columns.file, Mark(line, cells[-1][0]), "", words))
    for name, place in columns.places.items():
        text = cells[place - 1][1] if place <= len(cells) else ""
        if known[name].unit is None:
            columns.texts[name].append(text or None)
            continue
        if known[name].may_be_nan and text.lower() in _NO_NUMBER:
            text = ""
        value = _number(text)
        if value is None:
            problems.append(columns.problem(row, name, f"'{text}' is no number"))
        elif not text and known[name].required:
            problems.append(columns.problem(row, name, "the value is missing"))
        columns.numbers[name].append(math.nan if value is None else value * factors[name])
    return problems


def _number(text: str) -> float | None:
    if not text:
        return math.nan
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _head(
    file: str, lines: list[str], known: Mapping[str, ColumnKind], *, is_open: bool
) -> tuple[Columns, str, int]:
    """Return empty columns, what parts them, and the number of the line that names them."""
    begin = next((k for k, line in enumerate(lines) if line.partition("#")[0].strip()), None)
    if begin is None:
        raise refusal([Problem(file, START, "", "the file is empty")], file)
    text = lines[begin].partition("#")[0]
    separator = next((s for s in ";\t," if s in text), ",")
    columns, problems = Columns(file), []
    for place, (start, cell) in enumerate(_cells(text, separator), 1):
        mark = Mark(begin + 1, start)
        name, unit = _name_and_unit(cell) or (cell, None)
        if is_open and name not in known:
            columns.others.append(name)
            continue
        wrong = _wrong_head(name, unit, known)
        if name in columns.places:
            wrong = f"the column '{name}' is there twice"
        if wrong:
            problems.append(Problem(file, mark, name, wrong))
        else:
            columns.places[name] = place
            target: dict[str, list[float]] | dict[str, list[str | None]]
            target = columns.texts if known[name].unit is None else columns.numbers
            target[name] = []
    missing = [n for n, c in known.items() if c.required and n not in columns.places]
    problems += [
        Problem(file, Mark(begin + 1, 1), n, f"the column is missing; name it {_example(n, known)}")
        for n in missing
        if not any(p.field == n for p in problems)
    ]
    if problems:
        raise refusal(problems, file)
    return columns, separator, begin + 1


def _wrong_head(name: str, unit: str | None, known: Mapping[str, ColumnKind]) -> str:
    if name not in known:
        return unknown_name("column", name, known)
    wanted = known[name].unit
    if wanted is None or known[name].is_raw:
        return "" if unit is None or known[name].is_raw else "this column has no unit"
    if unit is None:
        return f"say the unit of the column, such as {_example(name, known)}"
    try:
        given = parse_unit(unit)
    except InputError as error:
        return str(error)
    if given.dimension != parse_unit(wanted).dimension:
        return f"the unit '{unit}' does not measure a quantity in {wanted}"
    return ""


def _example(name: str, known: Mapping[str, ColumnKind]) -> str:
    unit = known[name].unit
    return f"'{name}'" if unit is None else f"'{name} [{unit}]'"


def _heads(line: str, separator: str) -> Iterable[tuple[str, str | None]]:
    for _, cell in _cells(line.partition("#")[0], separator):
        found = _name_and_unit(cell)
        if found:
            yield found


def _name_and_unit(cell: str) -> tuple[str, str | None] | None:
    """Return what a cell of the head names, None if it is no name."""
    match = _HEAD.fullmatch(cell.strip())
    if match is None:
        return None
    return match[1], None if match[2] is None else match[2].strip()


def _factor(unit: str | None) -> float:
    return 1.0 if unit is None else parse_unit(unit).factor


def _cells(text: str, separator: str) -> list[tuple[int, str]]:
    """Return the column where each cell's text begins, from one, and the text."""
    found, start = [], 0
    for piece in text.rstrip().split(separator):
        found.append((start + 1 + len(piece) - len(piece.lstrip()), _unquoted(piece.strip())))
        start += len(piece) + 1
    return found


def _unquoted(cell: str) -> str:
    """Return a cell without the quotation marks that some programs put around each."""
    is_quoted = len(cell) > 1 and cell[0] == cell[-1] == '"'
    return cell[1:-1].strip() if is_quoted else cell


def _lines(path: Path) -> list[str]:
    content = read_regular(path, LARGEST_FILE)
    if b"\0" in content:
        raise InputError(f"{path}: is not a text file; tables are text")
    return content.decode("utf-8-sig", errors="replace").splitlines()
