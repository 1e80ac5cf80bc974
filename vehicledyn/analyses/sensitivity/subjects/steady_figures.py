"""Derivatives of steady cornering by parameters of a car: turns, gradients, limits, responses."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.steady_turn import solver_for
from vehicledyn.analyses.handling.tested_car import CONTROL, CarPoint, TestedCar
from vehicledyn.analyses.handling.turn_slopes import TurnSlopes
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.names import START, matching
from vehicledyn.analyses.sensitivity.subjects.cornering_figures import (
    response_figures,
    turn_eigenvalue_figures,
)
from vehicledyn.analyses.sensitivity.subjects.steady_curves import (
    Found,
    circle_figures,
    held_wheel_figures,
)
from vehicledyn.analyses.sensitivity.subjects.steady_names import EIGENVALUES, Asked, parsed
from vehicledyn.analyses.sensitivity.subjects.steady_points import (
    acceleration_limit_figures,
    yaw_moment_figures,
)
from vehicledyn.base.errors import InputError
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.road.manoeuvres.driving_test import DrivingTest

Floats = NDArray[np.float64]

KINDS = (CarPoint,)
"""Results of steps that a memory knows."""

_FIGURES: dict[str, Callable[[TurnSlopes, Asked], Found]] = {
    "constant_speed": circle_figures,
    "constant_radius": circle_figures,
    "constant_steering": held_wheel_figures,
    "response": response_figures,
    "yaw_moments": yaw_moment_figures,
    "acceleration_limits": acceleration_limit_figures,
}


def _found(
    slopes: TurnSlopes, asked: Sequence[Asked], progress: Progress
) -> list[tuple[Quantity, Floats]]:
    """Return what names ask for, in their order; places of one curve are found in one go."""
    figures: dict[int, list[tuple[Quantity, Floats]]] = {}
    curves: dict[object, list[int]] = {}
    for k, item in enumerate(asked):
        is_place = item.values and item.quantity != EIGENVALUES
        curve = item.quantity, item.method, *item.given.items()
        curves.setdefault(curve if is_place else k, []).append(k)
    for numbers in curves.values():
        first = asked[numbers[0]]
        progress(f"differentiating {first.quantity}", None)
        values = tuple(dict.fromkeys(value for k in numbers for value in asked[k].values))
        find = turn_eigenvalue_figures if first.quantity == EIGENVALUES else _FIGURES[first.method]
        found = list(find(slopes, replace(first, values=values)))
        if len(numbers) == 1:
            figures[numbers[0]] = found
        else:
            places = dict(zip(values, found, strict=True))
            figures |= {k: [places[value] for value in asked[k].values] for k in numbers}
    return [figure for k in range(len(asked)) for figure in figures[k]]


def find_steady_sensitivity(
    target: Target, of: Sequence[str], to: Sequence[str], progress: Progress, *, memory: Memory
) -> SensitivityTable:
    """Return derivatives of steady cornering by parameters of a car.

    Parameters
    ----------
    target
        A road vehicle, or a scenario of one.
    of
        Names such as ``steady(steering_angle, constant_radius, 4 m/s^2, radius=60 m)`` and
        ``steady(understeer_gradient, constant_speed, speed=100 km/h)``.
    to
        Patterns of parameters.
    progress
        Called with what is going on.
    memory
        Knows turns, of :data:`KINDS`.

    Raises
    ------
    InputError
        If a name means nothing, or the model is no road vehicle on free wheels.
    NumericalError
        If a turn is not found.
    """
    asked = [parsed(name) for name in dict.fromkeys(of)]
    if any(name.startswith(START) for name in to):
        raise InputError("a steady turn has no start values; name parameters")
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(target, backend="auto", progress=progress, test=test)
    car.memory = memory
    progress("finding straight running", None)
    slopes = TurnSlopes(solver_for(car))
    parameters = [car.equations.parameters[k] for k in slopes.parameters]
    chosen = matching([p.name for p in parameters], to, car.equations.name)
    figures = _found(slopes, asked, progress)
    rows = np.array([row for _, row in figures])
    lost = ~np.isfinite(rows).all(axis=1)
    rows[lost, 1:] = np.nan
    return SensitivityTable(
        target.title,
        car.equations.name,
        tuple(Quantity(p.name, p.unit, p.description) for p in (parameters[k] for k in chosen)),
        np.array([parameters[k].value for k in chosen]),
        tuple(quantity for quantity, _ in figures),
        rows[:, 0],
        rows[:, 1:][:, chosen],
        notes=tuple(
            f"warning: '{quantity.name}' has no derivative: two modes, or smallest loads, are one"
            for (quantity, _), is_lost in zip(figures, lost, strict=True)
            if is_lost
        ),
    )
