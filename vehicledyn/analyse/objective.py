"""What an optimiser sees of a run: objective, constraints and the figures they are made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class FigureCurve:
    """Samples (s,) that a figure is drawn from, with their gradients (s, n).

    ``draw`` returns the figure and its gradient (n,) for any such samples and gradients.
    """

    values: Floats
    slopes: Floats
    draw: Callable[[Floats, Floats], tuple[float, Floats]]


@dataclass(frozen=True)
class FigureValue:
    """A figure with its gradient (n,), and the curve that it is drawn from, if there is one.

    ``bend`` is an estimate of its second derivatives, shape (n, n).
    """

    value: float
    slope: Floats
    bend: Floats | None = None
    curve: FigureCurve | None = None


@dataclass(frozen=True)
class Evaluated:
    """An objective, its gradient (n,), constraints c >= 0 (m,) and their gradients (m, n).

    ``residuals`` (r,) and ``residual_slopes`` (r, n) are those whose squares, halved, add up to the
    objective, none where it is no such sum. ``parts`` are what it is all made of, if anything.
    """

    objective: float
    gradient: Floats
    constraints: Floats
    jacobian: Floats
    residuals: Floats | None = None
    residual_slopes: Floats | None = None
    parts: ObjectiveParts | None = None


Composition: TypeAlias = Callable[[Mapping[str, FigureValue]], Evaluated]
"""Makes objective and constraints of figures, of which only values and gradients are read."""


@dataclass(frozen=True)
class ObjectiveParts:
    """Figures by name, and how objective and constraints are made of any values of them.

    Gradients are by whatever variables those of the figures are by.
    """

    figures: Mapping[str, FigureValue]
    compose: Composition


def parts_of(values: Evaluated) -> ObjectiveParts:
    """Return the figures of an evaluation: its own, else its objective and constraints."""
    if values.parts is not None:
        return values.parts
    objective = FigureValue(values.objective, values.gradient)
    if values.residuals is not None and values.residual_slopes is not None:
        curve = FigureCurve(values.residuals, values.residual_slopes, _half_squares)
        bend = values.residual_slopes.T @ values.residual_slopes
        objective = FigureValue(values.objective, values.gradient, bend, curve)
    found = {"objective": objective}
    rows = zip(values.constraints, values.jacobian, strict=True)
    found |= {f"constraint {k}": FigureValue(float(c), row) for k, (c, row) in enumerate(rows)}
    return ObjectiveParts(found, _as_they_are)


def _half_squares(values: Floats, slopes: Floats) -> tuple[float, Floats]:
    return 0.5 * float(values @ values), slopes.T @ values


def _as_they_are(figures: Mapping[str, FigureValue]) -> Evaluated:
    objective, *constraints = figures.values()
    rows = np.array([item.slope for item in constraints]).reshape(-1, len(objective.slope))
    values = np.array([item.value for item in constraints])
    return Evaluated(objective.value, objective.slope, values, rows)
