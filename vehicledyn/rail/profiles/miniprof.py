"""MiniProf profiles as its programs write them: .whl and .ban, the older layout, and .mpt.

Lines NAME=VALUE, many of them empty, come before an empty line and the points; a line that opens
with a quotation mark is a comment. ``ColumnDef`` names the columns, often more than there are;
X and Y are needed. ``WheelDiameterTaperline`` is the distance of the tape circle from the back of
the flange, where X is zero on wheels; ``XYPoints`` counts the points. The older layout opens with
#MINIWHEELPROF or the like and names no columns. A .mpt file holds sections of points in the order
of the profile. Commas mark decimals where Windows writes them so, and a head that stands still
repeats its point.

References
----------
Greenwood Engineering (2008), MiniProf for Windows, Technical Reference; the reader of CONTACT
(Vollebregt, Vtech CMCC), matlab/read_miniprof.m, for the three layouts.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from vehicledyn.rail.profiles.profile_columns import IN_HEADER, cells_of
from vehicledyn.rail.profiles.profile_points import (
    FURTHEST_TAPE_CIRCLE,
    MILLIMETRE,
    NEAREST_TAPE_CIRCLE,
    RawPoints,
    number_of,
    take_unit,
)

_SPLIT = re.compile(r"[,;\s]+")
_LENGTH = re.compile(r"([+-]?[\d.]*(?:,\d+)?(?:[eE][+-]?\d+)?)\s*(mm)?")
_COLUMNS = re.compile(r"[,;\s]+")
_SECTION = re.compile(r"\[\s*(\w+)\s*\]")
_NEEDED = {"x", "y"}
_TAPE = "wheeldiametertaperline"
_COUNT = "xypoints"


def is_miniprof(lines: Sequence[str]) -> bool:
    """Return whether lines in lower case are those of a MiniProf file, whatever its name."""
    named = any(line.startswith(("columndef", "xypoints", "[fileinfo]")) for line in lines)
    return named or _is_old(lines)


def _is_old(lines: Sequence[str]) -> bool:
    """Return whether a file has the older layout, whose header is text."""
    return any(line.lower().startswith("#mini") and "prof" in line.lower() for line in lines[:3])


def read_miniprof(file: str, lines: Sequence[str]) -> RawPoints:
    """Return the points of a MiniProf file; ``XOffset`` and ``YOffset`` are added.

    Raises
    ------
    InputError
        If a line of points has too few numbers, or a number of the header is none.
    """
    points = RawPoints(file, notes=["MiniProf profile"])
    header, rows = _Header(points), _Rows(points)
    inside, sections = not _is_old(lines), 0
    for number, line in enumerate(lines, 1):
        text = line.partition('"')[0].strip()
        section = _SECTION.fullmatch(text)
        if section:
            inside = section[1].lower().endswith("points")
            sections += inside
        elif "=" in text:
            header.take(number, text)
        elif not line.strip():
            inside = inside or not sections
        elif inside and text:
            rows.take(number, text, header.columns)
    rows.add()
    header.apply(len(rows.rows))
    if sections > 1:
        points.notes.append(f"{sections} sections of points joined in their order")
    return points


class _Rows:
    """The lines of points, with the columns that are named where they stand."""

    def __init__(self, points: RawPoints) -> None:
        self.points = points
        self.rows: list[tuple[int, str]] = []
        self.columns: list[Sequence[str]] = []

    def take(self, number: int, text: str, columns: Sequence[str]) -> None:
        """Take a line if it begins with a number."""
        if number_of(_SPLIT.split(text)[0]) is not None:
            self.rows.append((number, text))
            self.columns.append(columns)

    def add(self) -> None:
        """Add X and Y of all lines, but those that repeat the point before."""
        named = len(self.columns[0]) if self.columns else 0
        cells = cells_of(self.points, self.rows, named)
        repeated, before = 0, [""]
        for (number, _), texts, columns in zip(self.rows, cells, self.columns, strict=True):
            chosen = self._chosen(number, texts, columns)
            repeated += chosen == before
            if chosen != before:
                self.points.add(number, chosen)
            before = chosen
        if repeated:
            self.points.notes.append(f"{repeated} points left out that repeat the one before")

    def _chosen(self, number: int, texts: Sequence[str], columns: Sequence[str]) -> list[str]:
        if not set(columns) >= _NEEDED:
            raise self.points.refused(number, 1, "ColumnDef: names no columns X and Y")
        place = [columns.index("x"), columns.index("y")]
        if len(texts) <= max(place):
            message = f"{len(texts)} numbers, Y is number {max(place) + 1} of {','.join(columns)}"
            raise self.points.refused(number, 1, message)
        return [texts[k] for k in place]


class _Header:
    """What the lines NAME=VALUE say of the points."""

    def __init__(self, points: RawPoints) -> None:
        self.points = points
        self.columns = ["x", "y"]
        self.lengths: dict[str, tuple[int, str]] = {}
        self.count = 0

    def take(self, line: int, text: str) -> None:
        """Take one line; empty values say nothing."""
        key, _, value = text.partition("=")
        key, value = key.strip().lower(), value.strip()
        if not value:
            return
        if key == "columndef":
            self.columns = [name.lower() for name in _COLUMNS.split(value) if name]
        elif key in ("unit", "units"):
            take_unit(self.points, IN_HEADER.search(value))
        elif key in ("xoffset", "yoffset", _TAPE):
            self.lengths[key] = line, value
        elif key == _COUNT and value.isdecimal():
            self.count += int(value)

    def apply(self, count: int) -> None:
        """Add the offsets, note where the tape circle is and whether points are missing."""
        offsets = [self._metres(key) / self.points.unit for key in ("xoffset", "yoffset")]
        if any(offsets):
            self.points.shift(*offsets)
            self.points.notes.append("XOffset and YOffset of the file added")
        if count < self.count:
            self.points.notes.append(
                f"cut off? the file holds {count} of the {self.count} points that XYPoints counts"
            )
        distance = self._metres(_TAPE)
        if distance and not NEAREST_TAPE_CIRCLE < distance < FURTHEST_TAPE_CIRCLE:
            line, value = self.lengths[_TAPE]
            limits = f"{1e3 * NEAREST_TAPE_CIRCLE:g} and {1e3 * FURTHEST_TAPE_CIRCLE:g} mm"
            message = (
                f"{_TAPE}: '{value}' is no distance of a tape circle from the back of the flange; "
                f"give one between {limits}, or leave it empty"
            )
            raise self.points.refused(line, 1, message)
        self.points.tape_circle = distance or None

    def _metres(self, key: str) -> float:
        """Return a length of the header, in the unit of the points if it names none; or zero."""
        line, value = self.lengths.get(key, (0, "0"))
        length = _LENGTH.fullmatch(value)
        number = number_of(length[1].replace(",", ".")) if length else None
        if length is None or number is None:
            raise self.points.refused(line, 1, f"{key}: '{value}' is not a number")
        return number * (MILLIMETRE if length[2] else self.points.unit)
