"""The values of each key that varies as they are written: lists, ranges, rows and tables."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import open_regular
from vehicledyn.base.problems import Mark, Place, Problem
from vehicledyn.base.units import describe, is_bare, is_pure, missing_unit, parse_unit, to_si
from vehicledyn.files.scenario.sources import Sources
from vehicledyn.studies.sets import CaseList, Grid, Study

MOST_ROWS = 1_000_000
MOST_VALUES = 1_000_000
LARGEST_FILE = 200_000_000
"""Bytes of the largest table that is read."""

_FROM, _TO, _COUNT, _SCALE = "from", "to", "count", "scale"


@dataclass(frozen=True)
class Written:
    """A key, its values in order and where each stands; a range has two values and a count."""

    key: str
    place: Place
    values: Sequence[Any]
    places: Sequence[Place]
    is_range: bool = False
    count: int = 0
    is_log: bool = False
    unit: str = ""
    source: str = ""

    def problem(self, sources: Sources, number: int | None, words: str) -> Problem:
        """Return the problem of a value, or of the whole."""
        if self.source:
            line = 1 if number is None else self.places[number][0]
            return Problem(self.source, Mark(int(line), 1), self.key, words)
        place = self.place if number is None else self.places[number]
        return sources.problem(place, words, at_key=number is None)

    def in_si(self, number: int, unit: str) -> float:
        """Return a value in an SI unit.

        Raises
        ------
        InputError
            If it is no finite quantity in this unit.
        """
        value = self.values[number]
        if not self.unit and is_bare(value) and not is_pure(unit):
            raise InputError(missing_unit(value, unit))
        found = _fast(value, self.unit, unit) if self.source else to_si(value, unit)
        if not math.isfinite(found):
            raise InputError(f"expected a finite number, found {describe(value)}")
        return found


def read_columns(study: Study, path: Path, sources: Sources) -> tuple[list[Written], list[Problem]]:
    """Return the keys of a study that vary, and what is wrong with how they are written."""
    cases = study.cases
    if isinstance(cases, CaseList):
        return _listed(cases, path, sources)
    vary: dict[str, Any] = cases.vary  # type: ignore[attr-defined]
    if not vary:
        whole: Place = ("cases", "vary")
        return [], [sources.problem(whole, "nothing varies; a study needs one key at least")]
    columns, problems = [], []
    for key, given in vary.items():
        place: Place = ("cases", "vary", key)
        try:
            columns.append(_column(key, place, given, counted=isinstance(cases, Grid)))
        except InputError as error:
            problems.append(sources.problem(place, str(error)))
    return columns, problems


def _column(key: str, place: Place, given: Any, *, counted: bool) -> Written:
    if isinstance(given, dict) and {_FROM, _TO} <= set(given):
        return _range(key, place, given, counted=counted)
    if not counted:
        raise InputError(f"expected a range with 'from' and 'to', found {describe(given)}")
    if not isinstance(given, list):
        raise InputError(
            f"expected a list of values, or 'from', 'to' and 'count', found {describe(given)}"
        )
    if not given:
        raise InputError("no values; a study needs at least one case")
    return Written(key, place, given, [(*place, k) for k in range(len(given))])


def _range(key: str, place: Place, given: dict[str, Any], *, counted: bool) -> Written:
    known = {_FROM, _TO, _SCALE, *([_COUNT] if counted else [])}
    extra = sorted(set(given) - known)
    if extra:
        raise InputError(f"unknown key '{extra[0]}'. Known: {', '.join(sorted(known))}")
    scale = given.get(_SCALE, "linear")
    if scale not in ("linear", "log"):
        raise InputError(f"'scale' must be 'linear' or 'log', is {describe(scale)}")
    count = given.get(_COUNT, 0)
    whole = isinstance(count, int) and not isinstance(count, bool)
    if counted and not (whole and 1 <= count <= MOST_VALUES):
        raise InputError(
            f"'count' must be a whole number from 1 to {MOST_VALUES}, "
            f"is {describe(given.get(_COUNT))}"
        )
    ends, places = [given[_FROM], given[_TO]], [(*place, _FROM), (*place, _TO)]
    return Written(key, place, ends, places, is_range=True, count=count, is_log=scale == "log")


def _listed(cases: CaseList, path: Path, sources: Sources) -> tuple[list[Written], list[Problem]]:
    if (cases.rows is None) == (cases.file is None):
        words = "give either 'rows' or 'file'"
        return [], [sources.problem(("cases",), words, at_key=True)]
    if cases.file is not None:
        try:
            return _table(path.parent / cases.file), []
        except InputError as error:
            problems = [_as_problem(line) for line in str(error).splitlines()]
            return [], [p._replace(mark=p.mark) for p in problems]
    rows, place = cases.rows or [], ("cases", "rows")
    if not rows or not rows[0]:
        return [], [sources.problem(place, "no rows; a study needs at least one case")]
    keys, problems = list(rows[0]), []
    for number, row in enumerate(rows):
        if set(row) != set(keys):
            other = ", ".join(sorted(set(row) ^ set(keys)))
            words = f"not the keys of the first row: {other}"
            problems.append(sources.problem((*place, number), words))
    if problems:
        return [], problems
    return [
        Written(
            key,
            (*place, 0, key),
            [row[key] for row in rows],
            [(*place, number, key) for number in range(len(rows))],
        )
        for key in keys
    ], []


def _as_problem(line: str) -> Problem:
    return Problem(line, None, "", "")


def _table(path: Path) -> list[Written]:
    """Return the columns of a CSV file.

    Raises
    ------
    InputError
        One line for each problem, with file and line.
    """
    try:
        with (
            open_regular(path, LARGEST_FILE) as file,
            io.TextIOWrapper(file, encoding="utf-8-sig", newline="") as stream,
        ):
            return _read_table(str(path), stream)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{path}: cannot be read: {reason}") from None


def _read_table(name: str, stream: Any) -> list[Written]:
    lines = ((n, line) for n, line in enumerate(stream, 1) if line.strip() and line[0] != "#")
    head = next(lines, None)
    if head is None:
        raise InputError(f"{name}: the table is empty; its first line names the keys")
    first, titles = head[0], [cell.strip() for cell in next(csv.reader([head[1]]))]
    keys, units = zip(*(_title(f"{name}:{first}:1", title) for title in titles), strict=True)
    if len(set(keys)) < len(keys):
        raise InputError(f"{name}:{first}:1: a key is given twice")
    numbers: list[Place] = []
    table: list[list[Any]] = [[] for _ in keys]
    for number, cells in _rows(lines):
        if len(cells) != len(keys):
            raise InputError(f"{name}:{number}:1: {len(cells)} values for {len(keys)} columns")
        if len(numbers) == MOST_ROWS:
            raise InputError(
                f"{name}:{number}:1: more than {MOST_ROWS} cases; make several studies"
            )
        numbers.append((number,))
        for column, cell in zip(table, cells, strict=True):
            column.append(_cell(cell))
    if not numbers:
        raise InputError(f"{name}:{first}:1: no cases; a line for each follows the keys")
    return [
        Written(key, (), column, numbers, unit=unit, source=name)
        for key, unit, column in zip(keys, units, table, strict=True)
    ]


def _rows(lines: Iterator[tuple[int, str]]) -> Iterator[tuple[int, list[str]]]:
    for number, line in lines:
        yield number, next(csv.reader([line]))


def _title(place: str, title: str) -> tuple[str, str]:
    key, bracket, rest = (text.strip() for text in title.partition("["))
    unit = rest.rstrip("] ") if bracket else ""
    try:
        parse_unit(unit)
    except InputError as error:
        raise InputError(f"{place}: {key}: {error}") from None
    if not key:
        raise InputError(f"{place}: a column has no name")
    return key, unit


def _cell(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text.strip()


def _fast(value: Any, given: str, wanted: str) -> float:
    """Return a number of a table in SI; text cells carry their own unit."""
    if not isinstance(value, float) or not given:
        return to_si(value, wanted)
    unit, target = parse_unit(given), parse_unit(wanted)
    if unit.dimension != target.dimension:
        raise InputError(f"'{given}' is the wrong unit: a quantity in {wanted} is needed here")
    return value * unit.factor / target.factor
