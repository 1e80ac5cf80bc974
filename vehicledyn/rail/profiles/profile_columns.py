"""Two columns of numbers as people and programs of several languages write them.

A comma may part columns or mark decimals. It marks decimals where semicolons, tabs or blanks part
the columns and no number has a point; it parts columns where it is alone between two numbers. What
can be read in both ways is refused.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from vehicledyn.rail.profiles.profile_points import RawPoints, take_unit

_NAMES = "(mm|cm|m|µm|μm|um|in|inch)"
_STATED = re.compile(rf"\bunits?\b\s*[:=]?\s*{_NAMES}\b|[\[(]{_NAMES}[\])]", re.IGNORECASE)
IN_HEADER = re.compile(rf"(?<![A-Za-z]){_NAMES}(?![A-Za-z])", re.IGNORECASE)
_NAMED = re.compile(r'[\s"]*([xyz])(?![A-Za-z])', re.IGNORECASE)
_COMMENT = re.compile(r"[#%!]")
_PARTED = re.compile(r"[;\s]+")
_NUMERIC = re.compile(r"[+-]?[.,]?\d")
_DECIMAL = re.compile(r"[+-]?(\d+|\d*,\d+)([eEdD][+-]?\d+)?")
_WAYS = "part the columns with ';' or a tab, or write decimals with points"


def read_columns(file: str, lines: Sequence[str]) -> RawPoints:
    """Return y and z, the first two numbers of each line or those that a header names so.

    # opens a comment.

    Raises
    ------
    InputError
        If a line is no point, or commas can be read as decimal marks and as separators.
    """
    points = RawPoints(file, notes=["two columns, y and z"])
    rows: list[tuple[int, str]] = []
    names: list[str] = []
    for number, line in enumerate(lines, 1):
        text, *comment = _COMMENT.split(line, maxsplit=1)
        if not rows:
            take_unit(points, _STATED.search("".join(comment)))
        text = text.strip("; \t")
        body = text.strip("[]{}(); \t")
        if not body:
            continue
        if not rows and not _NUMERIC.match(body):
            take_unit(points, IN_HEADER.search(text.replace("_", " ")))
            names = re.split(r"[,;\t]", text)
            continue
        rows.append((number, body))
    first, second = _places(names)
    if (first, second) != (0, 1):
        points.notes[0] = f"y and z are columns {first + 1} and {second + 1}, by the header"
    for (number, _), cells in zip(rows, cells_of(points, rows, len(names)), strict=True):
        points.add(number, [cells[k] for k in (first, second) if k < len(cells)])
    return points


def _places(names: Sequence[str]) -> tuple[int, int]:
    """Return which columns y and z are by their names: y and z, x and z, or x and y."""
    found = [match[1].lower() if (match := _NAMED.match(name)) else "" for name in names]
    for pair in (("y", "z"), ("x", "z"), ("x", "y")):
        if all(found.count(name) == 1 for name in pair):
            return found.index(pair[0]), found.index(pair[1])
    return 0, 1


def cells_of(points: RawPoints, rows: Sequence[tuple[int, str]], named: int) -> list[list[str]]:
    """Return the cells of rows, each a line's number and text, with points as decimal marks.

    ``named`` is how many columns the header names.

    Raises
    ------
    InputError
        If commas can be read as decimal marks and as separators.
    """
    parted = [_PARTED.split(text) for _, text in rows]
    inner = [[cell.strip(",") for cell in row] for row in parted]
    commas = [any("," in cell for cell in row) for row in inner]
    if not any(commas):
        return [[cell for cell in row if cell] for row in inner]
    alone = all(len([cell for cell in row if cell]) == 1 for row in inner)
    if alone or _only_parts(inner):
        return _parted_by_commas(points, rows, alone=alone, named=named)
    first = commas.index(True)
    number, text = rows[first]
    if any("." in cell for row in inner for cell in row):
        message = f"'{text}': commas and points both mark decimals in this file; {_WAYS}"
        raise points.refused(number, 1, message)
    for (number, text), row in zip(rows, parted, strict=True):
        wrong = [cell for cell in row if "," in cell and not _DECIMAL.fullmatch(cell)]
        if len(row) < 2 or wrong:
            raise points.refused(number, 1, _ambiguous(text))
    points.notes.append("commas mark decimals")
    return [[cell.replace(",", ".") for cell in row] for row in parted]


def _only_parts(inner: Sequence[Sequence[str]]) -> bool:
    """Return whether every comma lies between numbers of which two have a point of their own."""
    joined = [cell for row in inner for cell in row if "," in cell]
    return all(sum("." in part for part in cell.split(",")) > 1 for cell in joined)


def _parted_by_commas(
    points: RawPoints, rows: Sequence[tuple[int, str]], *, alone: bool, named: int
) -> list[list[str]]:
    cells = [[cell for cell in re.split(r"[,;\s]+", text) if cell] for _, text in rows]
    whole = not any("." in cell for row in cells for cell in row)
    if alone and whole:  # 1,5,2,25: four whole numbers, or two with decimals
        for (number, text), row in zip(rows, cells, strict=True):
            if len(row) > 2 and len(row) != named:
                raise points.refused(number, 1, _ambiguous(text))
    return cells


def _ambiguous(text: str) -> str:
    return f"'{text}': commas may part columns or mark decimals here; {_WAYS}"
