"""Physical plausibility of the bodies at given parameter values."""

from __future__ import annotations

import math

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.recursion.inertia import matrix_of
from vehicledyn.symbolic import ops

_ROUNDING = 1e-9


def check_bodies(system: System) -> None:
    """Raise InputError, all faults at once, for masses and inertias no body can have.

    A mass must be positive; the principal moments of inertia must not be negative and none
    larger than the sum of the other two (triangle inequality), unless these are zero: a body
    that only turns about one axis is often given that one moment, or said to be apparent: those
    identified on a machine hold motors and gears. A body with
    ``spins_about`` must be one of revolution about that axis.
    """
    symbols = ops.column([entry.symbol for entry in system.table.entries])
    values = [entry.value for entry in system.table.entries]
    problems: list[str] = []
    for body in system.bodies:
        if body.mass is None:
            continue
        matrix = matrix_of(body.inertia)
        column = ops.column([body.mass, *body.com, *(matrix[k] for k in range(9))])
        numbers = ops.numeric([symbols], column)(values)[:, 0]
        faults = [
            *_faults(numbers, body.apparent_inertia),
            *_spin_faults(numbers, body.spins_about),
        ]
        problems.extend(f"body '{body.name}': {text}" for text in faults)
    if problems:
        listed = "\n".join(f"  - {problem}" for problem in problems)
        raise InputError(f"system '{system.name}' has {len(problems)} problem(s):\n{listed}")


def _faults(numbers: np.ndarray, is_apparent: bool) -> list[str]:
    mass, matrix = float(numbers[0]), numbers[4:].reshape(3, 3)
    faults = []
    if not (math.isfinite(mass) and mass > 0.0):
        faults.append(f"its mass is {mass:g} kg; it must be positive")
    if not np.isfinite(matrix).all():
        return [*faults, "its inertia is not a number"]
    if not np.isfinite(numbers[1:4]).all():
        faults.append("its centre of mass is not a number")
    least, middle, largest = np.linalg.eigvalsh(matrix)
    if least < -_ROUNDING * abs(largest):
        faults.append(f"its smallest moment of inertia is {least:g} kg m²; none may be negative")
    elif is_apparent or middle <= _ROUNDING * largest:
        return faults
    elif largest > (least + middle) * (1.0 + _ROUNDING):
        faults.append(
            f"its principal moments of inertia {least:g}, {middle:g}, {largest:g} kg m² break "
            "the triangle inequality: the largest exceeds the sum of the other two; where they "
            "were identified or hold motors and gears, say so with apparent_inertia"
        )
    return faults


def _spin_faults(numbers: np.ndarray, axis: int | None) -> list[str]:
    """Return what keeps a body from being one of revolution about an axis."""
    if axis is None or not np.isfinite(numbers).all():
        return []
    com, matrix = numbers[1:4], numbers[4:].reshape(3, 3)
    along = axis - 1
    across = [k for k in range(3) if k != along]
    plane = matrix[np.ix_(across, across)]
    even = np.allclose(plane, plane[0, 0] * np.eye(2), rtol=_ROUNDING, atol=0.0)
    faults = []
    if np.any(com[across] != 0.0):
        faults.append(f"its centre of mass is not on axis {axis}, which it spins about")
    if not even or np.any(matrix[along, across] != 0.0):
        faults.append(f"its inertia is not that of a body of revolution about axis {axis}")
    return faults
