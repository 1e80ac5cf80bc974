"""Prescribed motions of coordinates: laws of time, and tables joined by smooth curves."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.files.limits import read_regular
from vehicledyn.base.numbers.shape_preserving import largest_swing
from vehicledyn.base.units import parse_unit
from vehicledyn.files.expressions.algebra import SYMBOLS
from vehicledyn.files.system.laws import TimeLaw
from vehicledyn.files.system.read import SystemModel
from vehicledyn.multibody.model.system import System
from vehicledyn.results.store.reader import open_result
from vehicledyn.symbolic import ops

Array = NDArray[np.float64]
LARGEST_FILE = 50_000_000
"""Bytes of the largest table that is read."""

DEGREE = 5
"""Of the curves through the points of a table: their fourth derivative is continuous."""
_ROUNDING = 1e-9
_SWING = 0.2
"""Share of the range of the points around by which a smooth curve may leave that of two points."""


class MotionRequest(Protocol):
    """Coordinates and how they move."""

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates."""

    def at(self, times: Array) -> tuple[Array, Array, Array]:
        """Return positions, rates and accelerations, each (n_times, n_coordinates), in SI."""


@dataclass(frozen=True)
class LawMotion:
    """Coordinates that follow laws of time."""

    model: SystemModel
    laws: dict[str, TimeLaw]

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(self.laws)

    def at(self, times: Array) -> tuple[Array, Array, Array]:
        """Return the laws and their exact derivatives."""
        time = ops.symbol("time")
        numbers = self.model.parameters.values

        def value(expression: Any, **names: Any) -> Any:
            return expression.value({**numbers, **names}, SYMBOLS)

        position = ops.column([law.at(time, value) for law in self.laws.values()])
        rate = ops.derivative(position, time, 1.0)
        acceleration = ops.derivative(rate, time, 1.0)
        return _sampled((position, rate, acceleration), time, times)


def _sampled(expressions: Sequence[Any], time: Any, times: Array) -> tuple[Array, Array, Array]:
    functions = [ops.numeric([time], expression) for expression in expressions]
    tables = [f(np.asarray(times, dtype=float)[None, :]).T for f in functions]
    return tables[0], tables[1], tables[2]


@dataclass(frozen=True)
class TableMotion:
    """Coordinates given at some times, joined by the quintic spline through all points.

    ``values`` has the shape (n_points, n_coordinates).
    """

    source: Path
    coordinates: tuple[str, ...]
    times: Array
    values: Array

    def at(self, times: Array) -> tuple[Array, Array, Array]:
        """Return the spline and its derivatives.

        Raises
        ------
        InputError
            If a time lies outside the table.
        """
        first, last = float(self.times[0]), float(self.times[-1])
        slack = _ROUNDING * max(1.0, abs(last))
        if times.min() < first - slack or times.max() > last + slack:
            raise InputError(
                f"{self.source}: the table goes from {first:g} s to {last:g} s, the motion is "
                f"asked for from {times.min():g} s to {times.max():g} s"
            )
        inside = np.clip(times, first, last)
        return tuple(np.asarray(self._spline(inside, nu=nu)) for nu in range(3))  # type: ignore[return-value]

    def check_swing(self) -> None:
        """Refuse points between which the spline swings out, as beside a step in few points.

        Raises
        ------
        InputError
            If it does; with coordinate, times and values.
        """
        for k, name in enumerate(self.coordinates):
            values = self.values[:, k]

            def curve(times: Array, k: int = k) -> Array:
                return np.asarray(self._spline(times)[:, k])

            at, share = largest_swing(self.times, values, curve)
            if share > _SWING:
                begin, end = self.times[at : at + 2]
                reached = curve(np.linspace(begin, end, 101))
                raise InputError(
                    f"{self.source}: {name}: the smooth curve through the points swings out to "
                    f"{reached.min():.4g} and {reached.max():.4g} between {begin:g} s and {end:g} "
                    f"s, where the points are {values[at]:.4g} and {values[at + 1]:.4g}; give "
                    "more points, at even distances, where the motion changes quickly"
                )

    @cached_property
    def _spline(self) -> Any:
        from scipy.interpolate import make_interp_spline

        try:
            return make_interp_spline(self.times, self.values, k=DEGREE)
        except (np.linalg.LinAlgError, ValueError):
            steps = np.diff(self.times)
            raise InputError(
                f"{self.source}: no smooth curve goes through points as uneven as these, "
                f"{steps.min():.3g} to {steps.max():.3g} s apart; give values at even distances"
            ) from None


def read_table(path: Path, system: System, wanted: Sequence[str]) -> TableMotion:
    """Return the motion in a file.

    Parameters
    ----------
    path
        A CSV file with the columns "time" and coordinates, each with its unit in square
        brackets if it is not SI; or a result file.
    system
        The system whose coordinates move.
    wanted
        Coordinates to take from a result file.

    Raises
    ------
    InputError
        If the file cannot be read, or a column, unit or value is wrong; the message names the line.
    """
    if path.suffix.lower() in (".h5", ".hdf5", ".nc"):
        with open_result(path) as result:
            for name in wanted:
                result.require(name)
            columns = [result.channel(name).values for name in wanted]
            return _checked(path, tuple(wanted), result.time, np.column_stack(columns))
    units = {joint.name: joint.unit for joint in system.joints()}
    names, table = _read_csv(path, {"time": "s", **units})
    moved = tuple(name for name in names if name != "time")
    values = table[:, [names.index(name) for name in moved]]
    return _checked(path, moved, table[:, names.index("time")], values)


def _checked(path: Path, names: tuple[str, ...], times: Array, values: Array) -> TableMotion:
    if len(times) <= DEGREE:
        raise InputError(f"{path}: {len(times)} rows; a smooth curve needs {DEGREE + 1} at least")
    if not (np.isfinite(values).all() and np.isfinite(times).all()):
        raise InputError(f"{path}: a value is no finite number")
    if not np.all(np.diff(times) > 0.0):
        row = int(np.flatnonzero(np.diff(times) <= 0.0)[0]) + 1
        raise InputError(f"{path}: the times do not grow at {times[row]:g} s")
    motion = TableMotion(path, names, times, values)
    motion.check_swing()
    return motion


def _read_csv(path: Path, units: dict[str, str]) -> tuple[list[str], Array]:
    """Return names and SI values of a table; every column must be known."""
    try:
        text = read_regular(path, LARGEST_FILE).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: cannot be read: {error}") from None
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), 1)
        if line.strip() and not line.startswith("#")
    ]
    rows = list(csv.reader(line for _, line in lines))
    if not rows:
        raise InputError(f"{path}: the table is empty")
    heads = [_head(f"{path}:{lines[0][0]}", cell, units) for cell in rows[0]]
    names = [name for name, _ in heads]
    if "time" not in names or len(set(names)) < len(names) or len(names) < 2:
        raise InputError(
            f"{path}:{lines[0][0]}: the columns are {', '.join(names)}; one 'time' and each "
            "coordinate once are needed"
        )
    table = [
        _numbers(f"{path}:{number}", row, heads)
        for (number, _), row in zip(lines[1:], rows[1:], strict=True)
    ]
    return names, np.array(table, dtype=float).reshape(len(table), len(names))


def _head(place: str, cell: str, units: dict[str, str]) -> tuple[str, float]:
    """Return the name of a column and the factor to SI."""
    name, bracket, rest = (part.strip() for part in cell.partition("["))
    if name not in units:
        raise InputError(f"{place}: {unknown_name('coordinate', name, units)}")
    if not bracket:
        return name, 1.0
    try:
        given, wanted = parse_unit(rest.rstrip("] ")), parse_unit(units[name])
    except InputError as error:
        raise InputError(f"{place}: {name}: {error}") from None
    if given.dimension != wanted.dimension:
        raise InputError(f"{place}: {name}: the unit must be one of {units[name]}")
    return name, given.factor / wanted.factor


def _numbers(place: str, row: list[str], heads: list[tuple[str, float]]) -> list[float]:
    if len(row) != len(heads):
        raise InputError(f"{place}: {len(row)} values for {len(heads)} columns")
    found = []
    for cell, (name, factor) in zip(row, heads, strict=True):
        try:
            found.append(float(cell) * factor)
        except ValueError:
            raise InputError(f"{place}: {name}: '{cell.strip()}' is no number") from None
    return found
