"""Derivatives of mode shapes, scaled so that the largest coordinate stays 1."""

from __future__ import annotations

from fnmatch import fnmatchcase

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.eigenvalues import LinearPoint, is_apart
from vehicledyn.analyse.gradients.linear_system import Following, SystemDerivatives, mode_slope
from vehicledyn.analyses.linear.mode_report import NEAR_ZERO
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.sensitivity.figure_kinds import MODE_SHAPES
from vehicledyn.base.errors import InputError, NumericalError, nearest_name
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.response_table import ratio_unit

_STILL = 1e-9
"""Part of the largest element of a shape up to which coordinates count as still."""


def mode_shapes(
    prepared: Prepared, point: LinearPoint, following: Following, name: str
) -> list[tuple[Quantity, float, NDArray[np.float64]]]:
    """Return the shapes of all modes but the zero ones, fastest growing first, with derivatives.

    The coordinate that moves most keeps 1; real and imaginary parts of the others are figures.

    Parameters
    ----------
    prepared, point, following
        The model, the point to linearise about, and how it moves.
    name
        ``mode_shapes``, or ``mode_shapes.`` and a pattern of states.

    Raises
    ------
    InputError
        If the pattern matches no state.
    NumericalError
        If an eigenvalue is repeated: its shapes turn into each other.
    """
    e = prepared.equations
    names = [item.name for item in e.states]
    pattern = name.removeprefix(MODE_SHAPES).removeprefix(".") or "*"
    kept = [k for k, item in enumerate(names) if fnmatchcase(item, pattern)]
    if not kept:
        guess = nearest_name(pattern, names)
        hint = f"; did you mean '{MODE_SHAPES}.{guess}'?" if guess else ""
        raise InputError(f"'{name}' matches no state of '{e.name}'{hint}", argument="of")
    system = SystemDerivatives(e).at(point, following)
    values, vectors = np.linalg.eig(system.matrix)
    values, vectors = values.astype(complex), vectors.astype(complex)
    modes = [k for k, v in enumerate(values) if v.imag >= 0.0 and abs(v) > NEAR_ZERO]
    found = []
    for number, mode in enumerate(sorted(modes, key=lambda k: -values[k].real), start=1):
        if not is_apart(values, mode):
            raise NumericalError(
                f"the eigenvalue {values[mode]:.6g} 1/s of mode {number} is repeated; its shapes "
                "have no derivatives"
            )
        fixed = _largest(np.abs(vectors[:, mode]), list(e.positions))
        shape = vectors[:, mode] / vectors[fixed, mode]
        slope = mode_slope(system, complex(values[mode]), shape, fixed)
        for k in kept:
            if k == fixed:
                continue
            state = e.states[k]
            text = f"of {state.name} in mode {number}, where {names[fixed]} is 1"
            unit = ratio_unit(state.unit, e.states[fixed].unit)
            parts = [("real", shape[k].real, slope[k].real)]
            if values[mode].imag:
                parts.append(("imaginary", shape[k].imag, slope[k].imag))
            for part, value, by_parameter in parts:
                own = f"mode_{number}.shape.{state.name}.{part}"
                quantity = Quantity(own, unit, f"{part.capitalize()} part {text}")
                found.append((quantity, float(value), by_parameter))
    return found


def _largest(sizes: NDArray[np.float64], coordinates: list[int]) -> int:
    """Return the largest coordinate of a shape; the largest state where no coordinate moves."""
    if not coordinates or np.max(sizes[coordinates]) <= _STILL * np.max(sizes):
        return int(np.argmax(sizes))
    return coordinates[int(np.argmax(sizes[coordinates]))]
