"""The record of a measured run: columns of a CSV file as functions of time."""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.column_files import ColumnKind, read_columns
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable

Floats = NDArray[np.float64]

_ANGLES = ("steering_wheel_angle", "road_wheel_angle")
_COLUMNS = {
    "time": ColumnKind("s", required=True),
    "steering_wheel_angle": ColumnKind("rad"),
    "road_wheel_angle": ColumnKind("rad"),
    "speed": ColumnKind("m/s"),
    "brake_torque": ColumnKind("N*m"),
    "yaw_rate": ColumnKind("rad/s"),
    "lateral_acceleration": ColumnKind("m/s^2"),
    "longitudinal_acceleration": ColumnKind("m/s^2"),
    "sideslip_angle": ColumnKind("rad"),
    "roll_angle": ColumnKind("rad"),
}

MOST_SAMPLES = 100_000
_EVEN = 1e-3
"""Part of a step by which steps may differ that count as even; others are cut to one step [1]."""
_ALIKE = 0.9
"""Likeness of names from which a further column is a known one that is written wrong [1]."""


@dataclass(frozen=True)
class RunRecord:
    """Measured curves by name, and the times of the first and last sample [s]."""

    curves: dict[str, tuple[Floats, Floats]]
    first: float
    last: float

    def values(self, name: str, times: Floats) -> Floats:
        """Return a signal at times, linearly between its samples [SI]."""
        return np.interp(times, *self.curves[name])

    def value(self, name: str, time: float) -> float:
        """Return a signal at a time [SI]."""
        return float(np.interp(time, *self.curves[name]))

    def law(self, name: str) -> Callable[[Scalar], Scalar]:
        """Return a signal as a function of time, held outside its samples; zero if there is none.

        Samples at uneven times are joined first, and the lines then cut at the smallest step.
        """
        if name not in self.curves:
            return lambda time: 0.0 * time
        times, values = self.curves[name]
        count = len(times) - 1
        steps = np.diff(times)
        if np.ptp(steps) > _EVEN * steps.min():
            count = int(np.ceil((times[-1] - times[0]) / steps.min()))
        count = min(count, MOST_SAMPLES)
        start, step = float(times[0]), float((times[-1] - times[0]) / count)
        knots = np.interp(start + step * np.arange(count + 1), times, values)
        lines = np.column_stack([knots[:-1], np.diff(knots)])
        curve = CurveTable(name, start, step, lines)
        end = float(times[-1])
        return lambda time: curve.value(ops.minimum(ops.maximum(time, start), end))


def read_record(path: Path, begin: float) -> RunRecord:
    """Return the record of a CSV file, read again when it has changed.

    Parameters
    ----------
    path
        The file, whose head states units, such as ``time [s], steering_wheel_angle [deg]``.
    begin
        Time of the file that becomes zero [s].

    Raises
    ------
    InputError
        If it cannot be read, a column is missing, or times do not grow.
    """
    try:
        facts = path.stat()
    except OSError:
        raise InputError(f"{path}: there is no such file") from None
    return _read(path, begin, facts.st_mtime_ns, facts.st_size)


@lru_cache(maxsize=8)
def _read(path: Path, begin: float, changed: int, size: int) -> RunRecord:
    table = read_columns(path, _COLUMNS, is_open=True)
    _refuse_misspelt(path, table.others, table.places)
    numbers = {name: np.array(values) for name, values in table.numbers.items()}
    time = numbers.pop("time") - begin
    if len(time) < 2:
        raise InputError(f"{path}: {len(time)} sample; a run has two at least")
    if not numbers:
        raise InputError(
            f"{path}: no column but the time is known; give any of {', '.join([*_COLUMNS][1:])}"
        )
    if all(name in numbers for name in _ANGLES):
        raise InputError(f"{path}: {' and '.join(_ANGLES)} both steer; give one of them")
    back = np.flatnonzero(~(np.diff(time) > 0.0))
    if back.size:
        row = int(back[0]) + 1
        raise InputError(
            f"{path}:{table.lines[row]}: the time {time[row] + begin:g} s does not grow; sort the "
            "rows, and give each time once"
        )
    if not time[0] <= 0.0 < time[-1]:
        raise InputError(
            f"{path}: begin: {begin:g} s lies outside of the record, {time[0] + begin:g} s to "
            f"{time[-1] + begin:g} s"
        )
    curves = {}
    for name, values in numbers.items():
        known = np.isfinite(values)
        if known.sum() < 2:
            raise InputError(f"{path}: {name}: fewer than two values")
        curves[name] = (time[known], values[known])
    return RunRecord(curves, float(time[0]), float(time[-1]))


def _refuse_misspelt(path: Path, others: Iterable[str], given: Collection[str]) -> None:
    """Refuse columns that would be passed over for a slip in their names."""
    bare = {_bare(name): name for name in _COLUMNS if name not in given}
    for other in others:
        head = re.split(r"[\[(]", other)[0].strip()
        near = difflib.get_close_matches(_bare(head), bare, n=1, cutoff=_ALIKE)
        if near:
            raise InputError(
                f"{path}: the column '{head}' is not known; did you mean '{bare[near[0]]}'? Give "
                "a further column another name"
            )


def _bare(name: str) -> str:
    """Return the letters and digits of a name."""
    return re.sub(r"[\W_]", "", name).lower()
