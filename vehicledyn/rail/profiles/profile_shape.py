"""From points as they were measured to points in the axes used here, checked.

See :mod:`vehicledyn.rail.profiles.profile` for the axes. What was turned, mirrored or cut off is
said.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from vehicledyn.rail.profiles.profile_mending import mended
from vehicledyn.rail.profiles.profile_names import Kind
from vehicledyn.rail.profiles.profile_order import put_in_order
from vehicledyn.rail.profiles.profile_pieces import Floats
from vehicledyn.rail.profiles.profile_points import RawPoints
from vehicledyn.rail.profiles.profile_reading import ProfileReading

FEWEST, MOST = 10, 20_000
NARROWEST, WIDEST, TALLEST = 0.02, 0.5, 0.3
_FLANGE = 0.01
_SHOULDER = 5e-3
_HEAD = 0.04
_RIM, _RIM_WIDTH = 8e-3, 35e-3
_TREAD, _TREAD_WIDTH, _TREAD_SLOPE = (15e-3, 45e-3), 40e-3, 0.25
_BACK = 4e-3
_SAME = 1e-8
_AT_BACK = 6e-3
"""Distance of the first point from y = 0 up to which y is counted from a flange's back [m]."""

_USUAL = {"wheel": (0.09, 0.2), "rail": (0.05, 0.2)}
_SUFFIXES = {".prw": "wheel", ".whl": "wheel", ".prr": "rail", ".ban": "rail"}
_UNITS = {1.0: "m", 1e-3: "mm", 1e-2: "cm", 1e-6: "µm", 0.0254: "inch"}


@dataclass(frozen=True)
class Measurement:
    """Points of a profile in the axes used here, and what was done with those of the file.

    ``y`` and ``z`` of shape (n,), y increasing; ``outliers`` are the points left out, shape
    (k, 2), ``bridges`` the y of both ends of each bridged gap, shape (m, 2), ``averaged`` those
    of the file that a mean stands for, as noise puts them out of order, shape (j, 2) [m].
    """

    y: Floats
    z: Floats
    outliers: Floats
    bridges: Floats
    averaged: Floats
    notes: list[str]

    def turned(self, *, y: float = 1.0, z: float = 1.0, shift: float = 0.0) -> Measurement:
        """Return it with y and z times 1 or -1 and then y shifted."""
        way = slice(None, None, int(y))
        return replace(
            self,
            y=y * self.y[way] + shift,
            z=z * self.z[way],
            outliers=self.outliers * (y, z) + (shift, 0.0),
            bridges=y * self.bridges + shift,
            averaged=self.averaged * (y, z) + (shift, 0.0),
        )


def in_our_axes(points: RawPoints, kind: Kind, reading: ProfileReading) -> Measurement:
    """Return the points of a profile in the axes used here.

    Raises
    ------
    InputError
        If there are too few points, two are equal, they are unsorted, the profile crosses itself
        or is too small or too large to be one, as with metres for millimetres, columns are
        exchanged, or wheel and rail; if it has defects that are to be refused.
    """
    _check_kind(points, kind)
    y, z = points.unit * np.array(points.first), points.unit * np.array(points.second)
    unit = _UNITS.get(points.unit, f"{points.unit:g} m")
    notes = [*points.notes, f"lengths in {unit}" + ("" if points.stated_unit else ", assumed")]
    _check_points(points, y, z, unit, kind)
    repaired = mended(points, np.column_stack([y, z]), reading.defects)
    (y, z), lines = repaired.points.T, repaired.lines
    if y[-1] < y[0]:
        y, z, lines = y[::-1], z[::-1], lines[::-1]
        notes.append("points run in the direction of falling y")
    order = put_in_order(points, y, z, lines)
    count = len(order.y)
    if count < FEWEST:
        message = f"{count} usable points; give at least {FEWEST}"
        raise points.refused(int(order.lines[0]), 1, message)
    notes += [*order.notes, *repaired.notes]
    mends = (repaired.outliers, repaired.bridges, order.averaged)
    found = Measurement(order.y, order.z, *mends, notes)
    if kind == "rail":
        return _rail_axes(points, found)
    tape_circle = points.tape_circle if reading.tape_circle is None else reading.tape_circle
    return _wheel_axes(points, found, tape_circle)


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
    height = float(np.ptp(z))
    if height > TALLEST:
        message = (
            f"the profile is {1e3 * height:.6g} mm high, read in {unit}; are both columns in it?"
        )
        raise points.refused(points.lines[int(np.argmax(np.abs(z)))], 1, message)
    near = np.hypot(np.diff(y), np.diff(z)) < _SAME
    if near.any():
        k = int(np.argmax(near))
        message = f"this point is the same as that of line {points.lines[k]}; remove one of them"
        raise points.refused(points.lines[k + 1], 1, message)


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


def _wheel_axes(points: RawPoints, found: Measurement, tape_circle: float | None) -> Measurement:
    """Turn a wheel's points so that the flange is at negative y and positive z."""
    y, z = found.y, found.z
    middle = float(np.median(z))
    ends = np.array([z[0], z[-1]]) - middle
    if np.ptp(y) < _USUAL["wheel"][0] and ends.prod() > 0.0 and np.abs(ends).min() > _SHOULDER:
        message = "both sides fall off from the middle, as a rail's do; a wheel's profile is needed"
        raise points.refused(points.lines[0], 1, message)
    tallest = int(np.argmax(np.abs(z - middle)))
    if abs(z[tallest] - middle) < _FLANGE:
        found.notes.append("no flange found: y taken as outwards, z as the increase of the radius")
    else:
        if z[tallest] < middle:
            found = found.turned(z=-1.0)
            found.notes.append("z turned: it pointed away from the rail")
        if y[tallest] > 0.5 * (y[0] + y[-1]):
            found = found.turned(y=-1.0)
            found.notes.append("y turned: the flange was on the positive side")
        found = _from_tape_circle(points, found, tape_circle)
    if not found.y[0] < 0.0 < found.y[-1]:
        message = (
            f"y runs from {1e3 * found.y[0]:g} to {1e3 * found.y[-1]:g} mm; y = 0 must be the tape "
            "circle, inside the profile"
        )
        raise points.refused(points.lines[0], 1, message)
    return found


def _from_tape_circle(
    points: RawPoints, found: Measurement, tape_circle: float | None
) -> Measurement:
    """Count y from the tape circle where the file counts it from the back of the flange."""
    tip = float(found.y[np.argmax(found.z)])
    if tip < 0.0 or abs(found.y[0]) > _AT_BACK:
        return found
    if tape_circle is None:
        message = (
            "y is counted from the back of the flange, and the file does not say where the tape "
            "circle is; say so by tape_circle, such as 70 mm"
        )
        raise points.refused(points.lines[0], 1, message)
    found.notes.append(
        f"y counted from the back of the flange, the tape circle at {1e3 * tape_circle:g} mm"
    )
    return found.turned(shift=-tape_circle)


def _rail_axes(points: RawPoints, found: Measurement) -> Measurement:
    """Turn a rail's points so that the crown is up and at z = 0."""
    y, z = found.y, found.z
    if _has_flange(y, z) or _has_flange(y, -z):
        message = (
            "a narrow rim with a tread beside it, as the flange of a wheel; a rail's profile is "
            "needed"
        )
        raise points.refused(points.lines[0], 1, message)
    if 0.5 * (z[0] + z[-1]) > float(np.median(z)):
        found = found.turned(z=-1.0)
        found.notes.append("z turned: it pointed down")
    if not y[0] < 0.0 < y[-1]:
        message = (
            f"y runs from {1e3 * y[0]:g} to {1e3 * y[-1]:g} mm; y = 0 must be the axis of the "
            "rail, inside the profile"
        )
        raise points.refused(points.lines[0], 1, message)
    top = float(y[np.argmax(found.z)])
    if abs(top) > _HEAD:
        message = (
            f"highest at y = {1e3 * top:.4g} mm, beyond the head of a rail; y = 0 must be the axis "
            "of the rail, or is this a wheel's profile?"
        )
        raise points.refused(points.lines[0], 1, message)
    found.notes.append("y taken as outwards: the gauge side is at negative y")
    return found


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
