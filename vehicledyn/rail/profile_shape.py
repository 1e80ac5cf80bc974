"""From points as they were measured to points in the axes used here, checked.

See :mod:`vehicledyn.rail.profile` for the axes. What was turned, mirrored or cut off is said.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.rail.profile_names import Kind
from vehicledyn.rail.profile_pieces import Floats
from vehicledyn.rail.profile_points import RawPoints

FEWEST, MOST = 10, 20_000
NARROWEST, WIDEST = 0.02, 0.5
_FLANGE = 0.01
_SHOULDER = 5e-3
_HEAD = 0.04
_RIM, _RIM_WIDTH = 8e-3, 35e-3
_TREAD, _TREAD_WIDTH, _TREAD_SLOPE = (15e-3, 45e-3), 40e-3, 0.25
_BACK = 4e-3
_SAME = 1e-8
_SWAPPED = 2  # segments apart: two points in the wrong order, no loop
_USUAL = {"wheel": (0.09, 0.2), "rail": (0.05, 0.2)}
_SUFFIXES = {".prw": "wheel", ".whl": "wheel", ".prr": "rail", ".ban": "rail"}
_UNITS = {1.0: "m", 1e-3: "mm", 1e-2: "cm", 1e-6: "µm", 0.0254: "inch"}


def in_our_axes(points: RawPoints, kind: Kind) -> tuple[Floats, Floats, list[str]]:
    """Return y and z of a profile, y increasing or folded at the ends only, and notes [m].

    Raises
    ------
    InputError
        If there are too few points, two are equal, they are unsorted, the profile crosses itself
        or is too small or too large to be one, as with metres for millimetres, columns are
        exchanged, or wheel and rail.
    """
    _check_kind(points, kind)
    y, z = points.unit * np.array(points.first), points.unit * np.array(points.second)
    unit = _UNITS.get(points.unit, f"{points.unit:g} m")
    notes = [*points.notes, f"lengths in {unit}" + ("" if points.stated_unit else ", assumed")]
    _check_points(points, y, z, unit, kind)
    lines = np.array(points.lines)
    if y[-1] < y[0]:
        y, z, lines = y[::-1], z[::-1], lines[::-1]
        notes.append("points run in the direction of falling y")
    _check_order(points, y, z, lines)
    y, z, cut = _visible(y, z)
    if cut:
        notes.append(f"{cut} points cut off at the ends, where the profile folds back")
    if len(y) < FEWEST:
        raise points.refused(int(lines[0]), 1, f"{len(y)} usable points; give at least {FEWEST}")
    y, z, said = (_wheel_axes if kind == "wheel" else _rail_axes)(points, y, z)
    return y, z, [*notes, *said]


def _check_kind(points: RawPoints, kind: Kind) -> None:
    """Refuse a file whose ending says that it holds the other of wheel and rail."""
    ending = Path(points.file).suffix.lower()
    if _SUFFIXES.get(ending, kind) != kind:
        message = (
            f"{ending} is a profile of a {_SUFFIXES[ending]}, here a {kind}'s is needed; are wheel "
            "and rail exchanged?"
        )
        raise points.refused(points.lines[0], 1, message)


def _check_points(points: RawPoints, y: Floats, z: Floats, unit: str, kind: Kind) -> None:
    if len(y) < FEWEST:
        message = f"{len(y)} points are too few for a profile; give at least {FEWEST}"
        raise points.refused(points.lines[-1], 1, message)
    if len(y) > MOST:
        message = f"{len(y)} points are too many for a profile; give at most {MOST}"
        raise points.refused(points.lines[MOST], 1, message)
    _check_columns(points, y, z)
    width = float(np.ptp(y))
    if not NARROWEST <= width <= WIDEST:
        low, high = _USUAL[kind]
        guesses = [
            name
            for factor, name in _UNITS.items()
            if factor != points.unit and low <= width / points.unit * factor <= high
        ]
        hint = "; ".join(
            f"are the lengths in {guess}? Then say so: '# unit: {guess}'" for guess in guesses
        )
        hint = f"; {hint}" if hint else ""
        message = f"the profile is {1e3 * width:.6g} mm wide, read in {unit}{hint}"
        raise points.refused(points.lines[0], 1, message)
    near = np.hypot(np.diff(y), np.diff(z)) < _SAME
    if near.any():
        k = int(np.argmax(near))
        message = f"this point is the same as that of line {points.lines[k]}; remove one of them"
        raise points.refused(points.lines[k + 1], 1, message)


def _check_order(points: RawPoints, y: Floats, z: Floats, lines: NDArray[np.int_]) -> None:
    """Refuse a profile that crosses itself, or turns back elsewhere than at its ends."""
    crossing = _first_crossing(y, z)
    if crossing is not None and crossing[1] - crossing[0] > _SWAPPED:
        message = (
            f"the profile crosses itself: a loop with the part at line {lines[crossing[0]]}; "
            "remove it, or sort the points"
        )
        raise points.refused(int(lines[crossing[1]]), 1, message)
    first, last = _ends(y)
    back = np.flatnonzero(np.diff(y[first : last + 1]) <= 0.0)
    if first > last or len(back):
        k = first + int(back[0]) + 1 if len(back) else first
        message = (
            f"unsorted: y goes back from {y[k - 1] / points.unit:g} to {y[k] / points.unit:g}; "
            "give the points in their order along the profile"
        )
        raise points.refused(int(lines[k]), 1, message)


def _check_columns(points: RawPoints, y: Floats, z: Floats) -> None:
    """Refuse points of which only the second column is in order: y is, z rises and falls."""
    if not _in_order(y) and _in_order(z):
        message = (
            "only the second column goes one way, as y does; are the columns exchanged? "
            "y comes first, then z"
        )
        raise points.refused(points.lines[0], 1, message)


def _in_order(values: Floats) -> bool:
    steps = np.diff(values)
    return bool((steps > 0.0).all() or (steps < 0.0).all())


def _first_crossing(y: Floats, z: Floats) -> tuple[int, int] | None:
    """Return two segments, not neighbours, that cross, or None."""
    begin, end = np.column_stack([y[:-1], z[:-1]]), np.column_stack([y[1:], z[1:]])
    low, high = np.minimum(begin[:, 0], end[:, 0]), np.maximum(begin[:, 0], end[:, 0])
    for k in range(len(begin) - 2):
        later = np.flatnonzero((low[k + 2 :] <= high[k]) & (high[k + 2 :] >= low[k])) + k + 2
        for other in later:
            if _cross(begin[k], end[k], begin[other], end[other]):
                return k, int(other)
    return None


def _cross(a: Floats, b: Floats, c: Floats, d: Floats) -> bool:
    def side(p: Floats, q: Floats, r: Floats) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    return side(a, b, c) * side(a, b, d) <= 0.0 and side(c, d, a) * side(c, d, b) <= 0.0


def _ends(y: Floats) -> tuple[int, int]:
    """Return where y is smallest and largest, next to the rest of the profile if upright there."""
    return len(y) - 1 - int(np.argmin(y[::-1])), int(np.argmax(y))


def _visible(y: Floats, z: Floats) -> tuple[Floats, Floats, int]:
    """Return the points between smallest and largest y, and how many were cut off."""
    first, last = _ends(y)
    kept = slice(first, last + 1)
    return y[kept], z[kept], len(y) - (last + 1 - first)


def _wheel_axes(points: RawPoints, y: Floats, z: Floats) -> tuple[Floats, Floats, list[str]]:
    """Turn a wheel's points so that the flange is at negative y and positive z."""
    notes = []
    middle = float(np.median(z))
    ends = np.array([z[0], z[-1]]) - middle
    if np.ptp(y) < _USUAL["wheel"][0] and ends.prod() > 0.0 and np.abs(ends).min() > _SHOULDER:
        message = "both sides fall off from the middle, as a rail's do; a wheel's profile is needed"
        raise points.refused(points.lines[0], 1, message)
    tallest = int(np.argmax(np.abs(z - middle)))
    if abs(z[tallest] - middle) < _FLANGE:
        notes.append("no flange found: y taken as outwards, z as the increase of the radius")
    else:
        if z[tallest] < middle:
            z = -z
            notes.append("z turned: it pointed away from the rail")
        if y[tallest] > 0.5 * (y[0] + y[-1]):
            y, z = -y[::-1], z[::-1]
            notes.append("y turned: the flange was on the positive side")
    if not y[0] < 0.0 < y[-1]:
        message = (
            f"y runs from {1e3 * y[0]:g} to {1e3 * y[-1]:g} mm; y = 0 must be the tape circle, "
            "inside the profile"
        )
        raise points.refused(points.lines[0], 1, message)
    return y, z, notes


def _rail_axes(points: RawPoints, y: Floats, z: Floats) -> tuple[Floats, Floats, list[str]]:
    """Turn a rail's points so that the crown is up and at z = 0."""
    notes = []
    if _has_flange(y, z) or _has_flange(y, -z):
        message = (
            "a narrow rim with a tread beside it, as the flange of a wheel; a rail's profile is "
            "needed"
        )
        raise points.refused(points.lines[0], 1, message)
    if 0.5 * (z[0] + z[-1]) > float(np.median(z)):
        z = -z
        notes.append("z turned: it pointed down")
    if not y[0] < 0.0 < y[-1]:
        message = (
            f"y runs from {1e3 * y[0]:g} to {1e3 * y[-1]:g} mm; y = 0 must be the axis of the "
            "rail, inside the profile"
        )
        raise points.refused(points.lines[0], 1, message)
    top = float(y[np.argmax(z)])
    if abs(top) > _HEAD:
        message = (
            f"highest at y = {1e3 * top:.4g} mm, beyond the head of a rail; y = 0 must be the axis "
            "of the rail, or is this a wheel's profile?"
        )
        raise points.refused(points.lines[0], 1, message)
    notes.append("y taken as outwards: the gauge side is at negative y")
    return y, z, notes


def _has_flange(y: Floats, z: Floats) -> bool:
    """Return whether the highest part is a flange: a narrow rim, a long tread below, a back.

    The head of a rail is twice as wide so near its top; its sides, turned up, have no back.
    """
    tip = int(np.argmax(z))
    below = z[tip] - z
    rim = np.flatnonzero(below > _RIM)
    begin, end = y[rim[rim < tip]], y[rim[rim > tip]]
    if not (begin.size and end.size and min(below[0], below[-1]) > _BACK):
        return False
    steps, middle = np.diff(y), 0.5 * (below[1:] + below[:-1])
    flat = np.abs(np.diff(z)) < _TREAD_SLOPE * steps
    tread = flat & (middle > _TREAD[0]) & (middle < _TREAD[1])
    return bool(end[0] - begin[-1] < _RIM_WIDTH and steps[tread].sum() > _TREAD_WIDTH)
