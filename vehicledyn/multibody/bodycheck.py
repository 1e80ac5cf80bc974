"""Physical plausibility of the bodies at given parameter values."""

from __future__ import annotations

import math

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.inertia import matrix_of
from vehicledyn.multibody.system import System
from vehicledyn.symbolic import ops

_ROUNDING = 1e-9


def check_bodies(system: System) -> None:
    """Raise InputError, all faults at once, for masses and inertias no body can have.

    A mass must be positive; the principal moments of inertia must be positive and none larger
    than the sum of the other two (triangle inequality).
    """
    symbols = ops.column([entry.symbol for entry in system.table.entries])
    values = [entry.value for entry in system.table.entries]
    problems: list[str] = []
    for body in system.bodies:
        if body.mass is None:
            continue
        numbers = ops.numeric([symbols], ops.column([body.mass, *_flat(matrix_of(body.inertia))]))(
            values
        )[:, 0]
        problems.extend(f"body '{body.name}': {text}" for text in _faults(numbers))
    if problems:
        listed = "\n".join(f"  - {problem}" for problem in problems)
        raise InputError(f"system '{system.name}' has {len(problems)} problem(s):\n{listed}")


def _flat(matrix: object) -> list[object]:
    return [matrix[i, j] for i in range(3) for j in range(3)]  # type: ignore[index]


def _faults(numbers: np.ndarray) -> list[str]:
    mass, matrix = float(numbers[0]), numbers[1:].reshape(3, 3)
    faults = []
    if not (math.isfinite(mass) and mass > 0.0):
        faults.append(f"its mass is {mass:g} kg; it must be positive")
    if not np.isfinite(matrix).all():
        return [*faults, "its inertia is not a number"]
    least, middle, largest = np.linalg.eigvalsh(matrix)
    if least < -_ROUNDING * max(largest, 1.0):
        faults.append(f"its smallest moment of inertia is {least:g} kg m²; none may be negative")
    elif largest > (least + middle) * (1.0 + _ROUNDING):
        faults.append(
            f"its principal moments of inertia {least:g}, {middle:g}, {largest:g} kg m² break "
            "the triangle inequality: the largest exceeds the sum of the other two"
        )
    return faults
