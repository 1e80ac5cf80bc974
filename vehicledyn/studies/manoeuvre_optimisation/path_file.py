"""Paths of optimal manoeuvres: straight lines, arcs, files of places, OpenCRG roads, with gates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.column_files import ColumnKind, read_columns
from vehicledyn.base.units import with_unit
from vehicledyn.files.scenario.target import Target
from vehicledyn.studies.study_form import StudyForm

Floats = NDArray[np.float64]

Line = tuple[Floats, Floats, Floats, Floats, Floats]
"""Distance, x, y; length and whether closed; rows of distance and offsets of the corridor."""

_KINDS = ("straight", "arc", "file", "opencrg")
_KEYS = (*_KINDS, "closed", "right", "left", "gates", "place")
_COLUMNS = {
    "x": ColumnKind("m", required=True),
    "y": ColumnKind("m", required=True),
    "right": ColumnKind("m"),
    "left": ColumnKind("m"),
}
_ROWS, _MOST_ROWS = 240, 30_720
"""Rows of the table of a path, and at most: they are doubled until the path is true."""

_TRUE = 1e-5
"""By how much the curve through the rows may miss the path [m]."""

_APART = 1.0
"""Distance of places taken from a long OpenCRG road [m]."""

BEYOND = 0.2
"""Part of an open path that it is continued by at both ends, where a search may look."""

_LONGEST = 1e7
"""Longest path of a study [m]."""

_WIDE = 1e3
"""Sides of a corridor that has none [m]."""


@dataclass(frozen=True)
class PathTable:
    """A path by its distance [m], with x, y and the corridor's offsets to both sides [m].

    ``length`` is that of the path itself, which the table exceeds at both ends; ``place`` names
    the states that follow it, empty for those of the vehicle.
    """

    distance: Floats
    x: Floats
    y: Floats
    right: Floats
    left: Floats
    length: float
    closed: bool
    place: tuple[str, ...]


def read_path(form: StudyForm, given: Any, target: Target) -> PathTable | None:
    """Return the path of a study; problems are noted in the form, and None returned.

    An OpenCRG road lies where the road of the scenario lies, if that is one too.
    """
    if not form.check(("path",), given, _KEYS):
        return None
    found = [kind for kind in _KINDS if kind in given]
    if len(found) != 1:
        form.wrong(("path",), f"expected one of {', '.join(_KINDS)}")
        return None
    kind = found[0]
    place, closed = given.get("place", []), given.get("closed", False)
    wrong = {
        "closed": "" if isinstance(closed, bool) else "expected true or false",
        "place": ""
        if isinstance(place, list) and len(place) in (0, 2)
        else "expected the states x and y that follow the path",
        kind: "expected the name of a file"
        if kind in ("file", "opencrg") and not isinstance(given[kind], str)
        else "",
    }
    for key, words in wrong.items():
        if words:
            form.wrong(("path", key), words)
    if any(wrong.values()):
        return None
    try:
        line = _LINES[kind](form, given[kind], closed, target)
        return _with_corridor(form, given, line, tuple(map(str, place)))
    except InputError as error:
        form.wrong(("path", kind), str(error))
        return None


def _straight(form: StudyForm, given: Any, _: bool, __: Target) -> Line:
    _require(form, "straight", given, ("length",))
    length = with_unit(given.get("length"), "m")
    if not 0.0 < length <= _LONGEST:
        raise InputError(f"the length must be above zero and at most {_LONGEST:g} m")
    s = _distances(length)
    return s, s, np.zeros_like(s), np.array([length, 0.0]), np.zeros((0, 3))


def _arc(form: StudyForm, given: Any, closed: bool, _: Target) -> Line:
    _require(form, "arc", given, ("radius", "angle"))
    radius = with_unit(given.get("radius"), "m")
    angle = 2.0 * np.pi if closed else with_unit(given.get("angle"), "rad")
    if not radius or not angle > 0.0:
        raise InputError("the radius must not be zero and the angle must be above zero")
    length = abs(radius) * angle
    if not 0.0 < length <= _LONGEST:
        raise InputError(f"the arc must not be longer than {_LONGEST:g} m")
    s = _distances(length)
    turned = s / radius
    x, y = radius * np.sin(turned), radius * (1.0 - np.cos(turned))
    return s, x, y, np.array([length, float(closed)]), np.zeros((0, 3))


def _file(form: StudyForm, given: Any, closed: bool, _: Target) -> Line:
    path = form.path.parent / str(given)
    columns = read_columns(path, _COLUMNS)
    x, y = (np.array(columns.numbers[name]) for name in ("x", "y"))
    sides = np.array([columns.numbers.get(n, [np.nan] * len(x)) for n in ("right", "left")])
    return _through(path, x, y, sides, closed)


def _opencrg(form: StudyForm, given: Any, closed: bool, target: Target) -> Line:
    from vehicledyn.road.surfaces.opencrg import OpenCrgRoad

    path = form.path.parent / str(given)
    driven = None if target.choices is None else target.choices.road
    origin = driven.origin if isinstance(driven, OpenCrgRoad) else "reference_line"
    road = OpenCrgRoad.read(path, origin, "linear").road
    length = road.line.stop - road.line.start
    count = int(np.clip(length / _APART + 1, _ROWS, _MOST_ROWS))
    u = np.linspace(road.line.start, road.line.stop, count)
    x, y = road.place(u, np.zeros_like(u))
    sides = np.array([[-road.edges[0]] * count, [road.edges[1]] * count])
    return _through(path, x, y, sides, closed)


_LINES = {"straight": _straight, "arc": _arc, "file": _file, "opencrg": _opencrg}


def _through(path: Path, x: Any, y: Any, sides: Any, closed: bool) -> Line:
    """Return a smooth path through places, resampled by its length."""
    from scipy.interpolate import CubicSpline

    places = np.column_stack([x, y])
    if closed and np.hypot(*(places[0] - places[-1])) > 1e-9:
        places, sides = np.vstack([places, places[:1]]), np.hstack([sides, sides[:, :1]])
    steps = np.hypot(*np.diff(places, axis=0).T)
    if len(places) < 4 or (steps <= 0.0).any():
        raise InputError(f"{path.name}: needs four places or more, none of them twice")
    chord = np.concatenate([[0.0], np.cumsum(steps)])
    if closed:
        places[-1] = places[0]
    curve = CubicSpline(chord, places, bc_type="periodic" if closed else "natural")
    fine = np.linspace(0.0, chord[-1], 40 * len(chord))
    speed = np.hypot(*curve(fine, 1).T)
    along = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(fine))])
    length = float(along[-1])

    def at_distances(s: Floats) -> Floats:
        inside = np.mod(s, length) if closed else np.clip(s, 0.0, length)
        at = np.interp(inside, along, fine)
        beyond = 0.0 if closed else (s - inside)[:, None] * _direction(curve(at, 1))
        return np.asarray(curve(at) + beyond)

    s, xy = _true_rows(at_distances, length)
    rows = np.column_stack([np.interp(chord, fine, along), -sides[0], sides[1]])
    return s, xy[:, 0], xy[:, 1], np.array([length, float(closed)]), rows


def _true_rows(places: Callable[[Floats], Floats], length: float) -> tuple[Floats, Floats]:
    """Return distances [m] with their places (n, 2), so many that a curve through them is true."""
    from scipy.interpolate import CubicSpline

    count = _ROWS
    while True:
        s = _distances(length, count)
        xy = places(s)
        between = 0.5 * (s[1:] + s[:-1])
        between = between[(between > 0.0) & (between < length)]
        missed = np.abs(CubicSpline(s, xy)(between) - places(between)).max()
        if missed <= _TRUE or 2 * count > _MOST_ROWS:
            return s, xy
        count *= 2


def _direction(slopes: Floats) -> Floats:
    return slopes / np.hypot(slopes[:, 0], slopes[:, 1])[:, None]


def _distances(length: float, count: int = _ROWS) -> Floats:
    return np.linspace(-BEYOND * length, (1.0 + BEYOND) * length, count)


def _require(form: StudyForm, kind: str, given: Any, keys: tuple[str, ...]) -> None:
    """Raise InputError where a kind of path is no mapping; unknown keys are noted in the form."""
    if not form.check(("path", kind), given, keys):
        raise InputError(f"expected a mapping with {', '.join(keys)}")


def _with_corridor(
    form: StudyForm, given: dict[str, Any], line: Line, place: tuple[str, ...]
) -> PathTable | None:
    """Return a path with its corridor: of its file, of gates, and not wider than given sides."""
    from scipy.interpolate import PchipInterpolator

    s, x, y, about, own = line
    length, closed = float(about[0]), bool(about[1])
    sides = {"right": _WIDE, "left": _WIDE}
    for key in sides:
        if key in given:
            sides[key] = form.mistakes.number(("path", key), given[key], "m")
    right, left = sides.values()
    rows = np.where(np.isnan(own), np.array([0.0, -right, left]), own)
    if "gates" in given:
        rows = _gates(form, given["gates"], length)
    if not len(rows):
        rows = np.array([[0.0, -right, left], [length, -right, left]])
    rows[:, 1], rows[:, 2] = np.maximum(rows[:, 1], -right), np.minimum(rows[:, 2], left)
    if form.mistakes.problems:
        return None
    if not (rows[:, 1] < rows[:, 2]).all() or not np.isfinite(rows).all():
        form.wrong(("path",), "the corridor has no width: its right side is left of its left one")
        return None
    if len(rows) == 1:
        rows = np.vstack([rows, rows + np.array([[1.0, 0.0, 0.0]])])
    at = np.clip(np.mod(s, length) if closed else s, rows[0, 0], rows[-1, 0])
    sides = PchipInterpolator(rows[:, 0], rows[:, 1:])(at)
    return PathTable(s, x, y, -sides[:, 0], sides[:, 1], length, closed, place)


def _gates(form: StudyForm, given: Any, length: float) -> Floats:
    """Return rows of distance and the offsets between which a motion must pass."""
    rows = []
    for k, item in enumerate(given if isinstance(given, list) else []):
        if not isinstance(item, dict) or set(item) != {"at", "from", "to"}:
            form.wrong(("path", "gates", k), "expected a mapping with at, from, to")
            continue
        place = "path", "gates", k
        row = [form.mistakes.number((*place, key), item[key], "m") for key in ("at", "from", "to")]
        if row[1] >= row[2]:
            form.wrong(place, f"the bounds are crossed, from {row[1]:g} to {row[2]:g} m")
        rows.append(row)
    table = np.array(rows, dtype=float).reshape(-1, 3)
    if not len(table) or (np.diff(table[:, 0]) <= 0.0).any():
        form.wrong(("path", "gates"), "expected gates in the order of their growing 'at'")
        return np.zeros((0, 3))
    return table
