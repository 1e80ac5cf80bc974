"""Profiles from files: two columns as text or CSV, Simpack .prw/.prr, MiniProf .whl/.ban.

What a file does not state is found from the shape, and said in the notes of the profile: the
flange of a wheel reaches beyond its tread, a rail is highest in its middle. Lengths are
millimetres unless the file says otherwise.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Mark, Problem, refusal
from vehicledyn.base.units import parse_unit

LARGEST_FILE = 20_000_000
MILLIMETRE = 1e-3

_NAMES = "(mm|cm|m|µm|um|in|inch)"
_STATED = re.compile(rf"\bunits?\b\s*[:=]?\s*{_NAMES}\b|[\[(]{_NAMES}[\])]", re.IGNORECASE)
_IN_HEADER = re.compile(rf"(?<![A-Za-z]){_NAMES}(?![A-Za-z])", re.IGNORECASE)
_INCH = 0.0254
_SPLIT = re.compile(r"[,;\s]+")


@dataclass
class RawPoints:
    """Points as a file has them: two coordinates and their line.

    ``unit`` is that of the lengths in metres; ``stated_unit`` is false where none is given.
    """

    file: str
    first: list[float] = field(default_factory=list)
    second: list[float] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    unit: float = MILLIMETRE
    stated_unit: bool = False
    notes: list[str] = field(default_factory=list)

    def add(self, line: int, texts: list[str]) -> None:
        """Add a point; an InputError says which text is no number."""
        if len(texts) < 2:
            raise self.refused(line, 1, "a point needs two numbers, y and z")
        values = [self._number(line, text, k) for k, text in enumerate(texts[:2])]
        self.first.append(values[0])
        self.second.append(values[1])
        self.lines.append(line)

    def refused(self, line: int, column: int, message: str) -> InputError:
        """Return the error that a line of this file is."""
        return refusal([Problem(self.file, Mark(line, column), "", message)], self.file)

    def _number(self, line: int, text: str, place: int) -> float:
        try:
            value = float(text.replace("D", "E").replace("d", "e"))
        except ValueError:
            raise self.refused(line, place + 1, f"'{text}' is not a number") from None
        if not abs(value) < 1e9:
            raise self.refused(line, place + 1, f"'{text}' is no usable length")
        return value


def read_points(path: Path) -> RawPoints:
    """Return the points in a file, its format known by name and content.

    Raises
    ------
    InputError
        If the file cannot be read or has no points; the text names file, line and column.
    """
    lines = _lines(path)
    reader = _reader(path, lines)
    points = reader(str(path), lines)
    if not points.first:
        raise points.refused(max(len(lines), 1), 1, "no points found in this profile")
    return points


def _reader(path: Path, lines: list[str]) -> Callable[[str, list[str]], RawPoints]:
    lower = [line.strip().lower() for line in lines]
    if path.suffix.lower() in (".prw", ".prr") or "point.begin" in lower:
        return _read_simpack
    is_miniprof = path.suffix.lower() in (".whl", ".ban") or any(
        line.startswith(("columndef", "xypoints")) for line in lower
    )
    return _read_miniprof if is_miniprof else _read_columns


def _read_columns(file: str, lines: list[str]) -> RawPoints:
    """Read y and z as the first two numbers of each line; # opens a comment, a header may name."""
    points = RawPoints(file, notes=["two columns, y and z"])
    for number, line in enumerate(lines, 1):
        text, _, comment = line.partition("#")
        if not points.first:
            _take_unit(points, _STATED.search(comment))
        if not text.strip():
            continue
        texts = _SPLIT.split(text.strip().strip(",;"))
        if not points.first and not _is_number(texts[0]):
            _take_unit(points, _IN_HEADER.search(text.replace("_", " ")))
            continue
        points.add(number, texts)
    return points


def _read_simpack(file: str, lines: list[str]) -> RawPoints:
    """Read a Simpack profile; ``units.len.f`` is the user's unit by the metre.

    Points are first shifted, then mirrored, as the file says. Its bounds and own smoothing are
    not applied; a turned profile is refused.
    """
    points = RawPoints(file, notes=["Simpack profile"])
    values: dict[str, str] = {}
    inside = False
    for number, line in enumerate(lines, 1):
        text = line.partition("!")[0].strip()
        lower = text.lower()
        if lower in ("point.begin", "point.end"):
            inside = lower == "point.begin"
        elif inside and text:
            points.add(number, text.split())
        elif "=" in text:
            key, _, value = text.partition("=")
            values[key.strip().lower()] = value.strip().strip("'")
    settings = {key: _setting(points, values, key) for key in _SIMPACK}
    if settings["rotate"]:
        raise points.refused(1, 1, "rotate: a turned profile is not read; turn its points")
    if settings["units.len.f"] <= 0.0:
        raise points.refused(1, 1, "units.len.f: must be above zero")
    points.unit = 1.0 / settings["units.len.f"]
    points.stated_unit = "units.len.f" in values
    for key, numbers in (("y", points.first), ("z", points.second)):
        sign = -1.0 if settings[f"mirror.{key}"] else 1.0
        numbers[:] = [sign * (number + settings[f"shift.{key}"]) for number in numbers]
        if settings[f"mirror.{key}"]:
            points.notes.append(f"{key} mirrored, as the file says")
    return points


_SIMPACK = {
    "units.len.f": 1000.0,
    "rotate": 0.0,
    "shift.y": 0.0,
    "shift.z": 0.0,
    "mirror.y": 0.0,
    "mirror.z": 0.0,
}


def _setting(points: RawPoints, values: dict[str, str], key: str) -> float:
    try:
        return float(values.get(key, _SIMPACK[key]))
    except ValueError:
        raise points.refused(1, 1, f"{key}: '{values[key]}' is not a number") from None


def _read_miniprof(file: str, lines: list[str]) -> RawPoints:
    """Read a MiniProf profile: lines NAME=VALUE, then columns in the order of ``ColumnDef``."""
    points = RawPoints(file, notes=["MiniProf profile"])
    columns = ["x", "y"]
    for number, line in enumerate(lines, 1):
        text = line.strip().strip('"')
        key, equals, value = text.partition("=")
        if equals:
            if key.strip().lower() == "columndef":
                columns = [name.strip().lower() for name in value.split(",")]
            elif key.strip().lower() in ("unit", "units"):
                _take_unit(points, _IN_HEADER.search(value))
            continue
        texts = _SPLIT.split(text)
        if not _is_number(texts[0]):
            continue
        if not {"x", "y"} <= set(columns):
            raise points.refused(number, 1, "ColumnDef: names no columns X and Y")
        if len(texts) < len(columns):
            raise points.refused(number, 1, f"expected {len(columns)} numbers, as ColumnDef says")
        points.add(number, [texts[columns.index("x")], texts[columns.index("y")]])
    return points


def _take_unit(points: RawPoints, match: re.Match[str] | None) -> None:
    if match and not points.stated_unit:
        name = next(group for group in match.groups() if group).lower()
        points.unit = _INCH if name in ("in", "inch") else parse_unit(name).factor
        points.stated_unit = True


def _is_number(text: str) -> bool:
    try:
        float(text.replace("D", "E").replace("d", "e"))
    except ValueError:
        return False
    return True


def _lines(path: Path) -> list[str]:
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise InputError(f"{path}: is larger than {LARGEST_FILE // 10**6} MB: no profile")
        text = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    if b"\0" in text:
        raise InputError(f"{path}: is not a text file; profiles are text")
    return text.decode("utf-8", errors="replace").splitlines()
