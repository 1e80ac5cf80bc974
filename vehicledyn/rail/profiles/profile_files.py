"""Profiles from files: two columns as text or CSV, Simpack .prw/.prr, MiniProf.

What a file does not state is found from the shape, and said in the notes of the profile: the
flange of a wheel reaches beyond its tread, a rail is highest in its middle. Lengths are
millimetres unless the file says otherwise.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import read_regular
from vehicledyn.rail.profiles.miniprof import is_miniprof, read_miniprof
from vehicledyn.rail.profiles.profile_columns import read_columns
from vehicledyn.rail.profiles.profile_points import RawPoints

LARGEST_FILE = 20_000_000


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
        simpack = "Simpack's stand between point.begin and point.end"
        where = simpack if reader is _read_simpack else "no line begins with a number"
        message = f"no points found in this profile: {where}"
        raise points.refused(max(len(lines), 1), 1, message)
    return points


def _reader(path: Path, lines: list[str]) -> Callable[[str, list[str]], RawPoints]:
    lower = [line.strip().lower() for line in lines]
    if path.suffix.lower() in (".prw", ".prr") or "point.begin" in lower:
        return _read_simpack
    known = path.suffix.lower() in (".whl", ".ban", ".mpt")
    return read_miniprof if known or is_miniprof(lower) else read_columns


def _read_simpack(file: str, lines: list[str]) -> RawPoints:
    """Read a Simpack profile; ``units.len.f`` is the user's unit by the metre.

    Points are first shifted, then cut at the bounds of y, then mirrored, as the file says. Its own
    smoothing is not applied; a turned profile, and points beyond bounds of z, are refused.
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
    points.shift(settings["shift.y"], settings["shift.z"])
    _apply_bounds(points, settings)
    for key, numbers in (("y", points.first), ("z", points.second)):
        if settings[f"mirror.{key}"]:
            numbers[:] = [-number for number in numbers]
            points.notes.append(f"{key} mirrored, as the file says")
    return points


def _apply_bounds(points: RawPoints, settings: dict[str, float]) -> None:
    """Leave out the points beyond the bounds of y; bounds that are not in order mean none."""
    low, high = settings["bound.z.min"], settings["bound.z.max"]
    beyond = [k for k, z in enumerate(points.second) if not low <= z <= high]
    if low < high and beyond:
        message = "bound.z: this point lies beyond; take it out, or the bounds of z"
        raise points.refused(points.lines[beyond[0]], 1, message)
    low, high = settings["bound.y.min"], settings["bound.y.max"]
    kept = [k for k, y in enumerate(points.first) if low <= y <= high]
    if low < high and len(kept) < len(points.first):
        points.notes.append(
            f"{len(points.first) - len(kept)} points beyond the file's bounds of y left out"
        )
        points.keep(kept)


_SIMPACK = {
    "units.len.f": 1000.0,
    "rotate": 0.0,
    "shift.y": 0.0,
    "shift.z": 0.0,
    "mirror.y": 0.0,
    "mirror.z": 0.0,
    "bound.y.min": 1.0,
    "bound.y.max": 0.0,
    "bound.z.min": 1.0,
    "bound.z.max": 0.0,
}


def _setting(points: RawPoints, values: dict[str, str], key: str) -> float:
    try:
        return float(values.get(key, _SIMPACK[key]))
    except ValueError:
        raise points.refused(1, 1, f"{key}: '{values[key]}' is not a number") from None


def _lines(path: Path) -> list[str]:
    return _decoded(path, read_regular(path, LARGEST_FILE)).splitlines()


def _decoded(path: Path, text: bytes) -> str:
    """Return the text of a file in UTF-8, in UTF-16 with its mark, or in that of Windows."""
    if text.startswith((b"\xff\xfe", b"\xfe\xff")):
        return text.decode("utf-16", errors="replace")
    if b"\0" in text:
        raise InputError(f"{path}: is not a text file; profiles are text")
    try:
        return text.decode("utf-8-sig")
    except UnicodeDecodeError:
        return text.decode("cp1252", errors="replace")
