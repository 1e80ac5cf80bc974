"""When functions of time in a system, such as forces, may jump: where their conditions change."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import Field, fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.periodic.nonsmooth_points import deciders
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic import ops

Vector = NDArray[np.float64]

_LOOKS, _MOST = 4096, 1000
"""Intervals in which conditions are looked at, and jumps that are found at most."""
_HALVINGS = 60


def time_jumps(system: System, begin: float, end: float) -> list[float]:
    """Return when within a run [s] conditions of functions of time alone change, ascending."""
    time = ops.symbol("time")
    conditions = [
        item for _, law in _laws(system) for item in deciders(ops.column(_components(law(time))))
    ]
    if not conditions or not end > begin:
        return []
    entries = system.table.entries
    values = np.array([entry.value for entry in entries])
    symbols = ops.column([entry.symbol for entry in entries])
    evaluate = ops.numeric([time, symbols], ops.column(conditions))

    def sides(times: Vector) -> Vector:
        return np.asarray(evaluate(times[None, :], values) > 0.0)

    times = np.linspace(begin, end, _LOOKS + 1)
    seen = sides(times)
    row, column = np.nonzero(seen[:, 1:] != seen[:, :-1])
    row, column = row[:_MOST], column[:_MOST]
    low, high = times[column], times[column + 1]
    for _ in range(_HALVINGS if len(row) else 0):
        middle = 0.5 * (low + high)
        is_before = sides(middle)[row, np.arange(len(row))] == seen[row, column]
        low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
    return sorted(set(map(float, low)))


def laws_over_time(system: System) -> tuple[list[str], Callable[[float], Vector]]:
    """Return the parts that declare functions of time and these, name by name, all components."""
    time = ops.symbol("time")
    found = [(name, item) for name, law in _laws(system) for item in _components(law(time))]
    entries = system.table.entries
    values = np.array([entry.value for entry in entries])
    symbols = ops.column([entry.symbol for entry in entries])
    evaluate = ops.numeric([time, symbols], ops.column([item for _, item in found]))
    return [name for name, _ in found], lambda t: evaluate(t, values)[:, 0]


def _laws(system: System) -> Iterator[tuple[str, Any]]:
    """Yield the functions of time that parts declare, with the name of the part."""
    for part in system.parts:
        declared: tuple[Field[Any], ...] = fields(part) if is_dataclass(part) else ()
        for known in declared:
            if known.metadata.get("variables") == "time":
                law = getattr(part, known.name)
                if callable(law):
                    yield part.name, law


def _components(found: Any) -> list[Any]:
    return list(found) if isinstance(found, tuple | list) else [found]
