"""Room for the iteration matrices of a run in compiled code, and their pattern there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.integrate.newmark.matrix_pattern import MatrixPattern, Triangle
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.newmark.newmark_code import RunRecord

_LISTS = ("starts", "rows", "places", "levers", "colour_starts", "colour_columns", "order")


def matrix_storage(
    pattern: MatrixPattern, room: Callable[[int], Vector], lanes: int = 1
) -> dict[str, NDArray[Any]]:
    """Return arrays for Jacobians, one matrix and factors, by their names in the record.

    ``room`` makes zeros, numbers in lanes where there are several.
    """
    n = len(pattern.order)
    return {
        "jacobian": np.zeros((lanes, len(pattern.rows))),
        "dense": np.zeros((n, n)),
        "base": np.zeros(n),
        "from_rows": np.zeros(n, dtype=np.intc),
        "lower": room(len(pattern.below.rows)),
        "upper": room(len(pattern.above.rows)),
        "inverse": room(n),
    }


def enter_pattern(record: RunRecord, pattern: MatrixPattern) -> None:
    """Give the record a pattern, whose arrays must outlive it."""
    own = record.pattern
    for name in _LISTS:
        setattr(own, name, getattr(pattern, name).ctypes.data)
    for side in ("below", "above"):
        for field in fields(Triangle):
            array = getattr(getattr(pattern, side), field.name)
            setattr(getattr(own, side), field.name, array.ctypes.data)
    own.n_colours, own.n_entries = len(pattern.colour_starts) - 1, len(pattern.rows)
