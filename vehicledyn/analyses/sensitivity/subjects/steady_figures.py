"""Derivatives of steady cornering: steering, side slip, roll and gradients by parameters of a car.

A line that fits a curve between two lateral accelerations is linear in its points, and these are
turns of lateral accelerations that are given: its slope moves as the same line through their
derivatives.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.circle import (
    QUANTITIES,
    STEP,
    SteadyCurve,
    at_speed,
    constant_radius,
    constant_speed,
    line_slope,
    on_circle,
)
from vehicledyn.analyses.handling.steady import (
    GRADIENT_FROM,
    GRADIENT_UP_TO,
    GRADIENTS,
    SteadyRequest,
)
from vehicledyn.analyses.handling.steady_turn import SteadyTurn, solver_for
from vehicledyn.analyses.handling.tested_car import CONTROL, CarPoint, TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnOf
from vehicledyn.analyses.handling.turn_limit import limit_turn
from vehicledyn.analyses.handling.turn_slopes import TurnSlopes
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.called import called_parts
from vehicledyn.analyses.sensitivity.names import START, matching
from vehicledyn.base.errors import InputError, NumericalError, unknown_name
from vehicledyn.base.ranges import read_range
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown, to_si
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.road.manoeuvres.driving_test import DrivingTest

Floats = NDArray[np.float64]

KINDS = (CarPoint,)
"""Results of steps that a memory knows."""

_FORM = "steady(QUANTITY, constant_speed|constant_radius, 1 m/s^2:4 m/s^2:3)"
_LIMIT = "limit"
_LINES = {name: (quantity, words) for quantity, name, words in GRADIENTS}


@dataclass(frozen=True)
class _Method:
    """A test: its setting, the turns of lateral accelerations, and the curve of them."""

    setting: str
    unit: str
    usual: float
    turns: Callable[[float], TurnOf]
    curve: Callable[..., SteadyCurve]


_METHODS = {
    "constant_speed": _Method("speed", "m/s", SteadyRequest.speed, at_speed, constant_speed),
    "constant_radius": _Method("radius", "m", SteadyRequest.radius, on_circle, constant_radius),
}


@dataclass(frozen=True)
class _Asked:
    """What a name asks for: lateral accelerations of a quantity, none for a gradient [m/s²]."""

    quantity: str
    method: str
    given: float
    values: tuple[float, ...]


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
    asked = [_parsed(name) for name in dict.fromkeys(of)]
    if any(name.startswith(START) for name in to):
        raise InputError("a steady turn has no start values; name parameters")
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(target, backend="auto", progress=progress, test=test)
    car.memory = memory
    progress("finding straight running", None)
    solver = solver_for(car)
    slopes = TurnSlopes(solver)
    parameters = [car.equations.parameters[k] for k in slopes.parameters]
    chosen = matching([p.name for p in parameters], to, car.equations.name)
    figures: list[tuple[Quantity, Floats]] = []
    for item in asked:
        progress(f"differentiating {item.quantity}", None)
        find = _values if item.values else _limit if item.quantity == _LIMIT else _gradient
        figures += list(find(slopes, item))
    rows = np.array([row for _, row in figures])
    return SensitivityTable(
        target.title,
        car.equations.name,
        tuple(Quantity(p.name, p.unit, p.description) for p in (parameters[k] for k in chosen)),
        np.array([parameters[k].value for k in chosen]),
        tuple(quantity for quantity, _ in figures),
        rows[:, 0],
        rows[:, 1:][:, chosen],
    )


def _curve(solver: SteadyTurn, asked: _Asked, last: float) -> SteadyCurve:
    """Return the curve of a test up to a lateral acceleration [m/s²].

    Raises
    ------
    NumericalError
        If it ends before.
    """
    curve = _METHODS[asked.method].curve(solver, asked.given, last=last)
    lateral = curve.values["lateral_acceleration"]
    if not len(lateral) or lateral[-1] < last - 1e-6:
        reached = lateral[-1] if len(lateral) else 0.0
        why = f" ({curve.reason})" if curve.reason else ""
        raise NumericalError(
            f"{curve.method}: the turns end at {reached:.4g} m/s^2{why}, before {last:g} m/s^2"
        )
    return curve


def _where(asked: _Asked) -> str:
    method = _METHODS[asked.method]
    return f"{asked.method.replace('_', ' ')} of {shown(asked.given, method.unit)}"


def _values(slopes: TurnSlopes, asked: _Asked) -> Iterator[tuple[Quantity, Floats]]:
    """Yield a quantity at its lateral accelerations, with derivatives."""
    turns = _METHODS[asked.method].turns(asked.given)
    curve = _curve(slopes.solver, asked, max(asked.values))
    lateral = curve.values["lateral_acceleration"]
    unit, words = QUANTITIES[asked.quantity]
    for value in asked.values:
        near = curve.points[int(np.argmin(np.abs(lateral - value)))]
        turn = turns(value)
        point = slopes.solver.find(turn, near)
        name = f"{asked.quantity} at {shown(value, 'm/s^2')}, {_where(asked)}"
        yield Quantity(name, unit, words), slopes.quantity(asked.quantity, turn, point)


def _gradient(slopes: TurnSlopes, asked: _Asked) -> Iterator[tuple[Quantity, Floats]]:
    """Yield the slope of the line that fits a curve, with derivatives."""
    quantity, words = _LINES[asked.quantity]
    turns = _METHODS[asked.method].turns(asked.given)
    curve = _curve(slopes.solver, asked, GRADIENT_UP_TO + 2.0 * STEP)
    lateral, ends = curve.values["lateral_acceleration"], (GRADIENT_FROM, GRADIENT_UP_TO)
    if lateral[0] > GRADIENT_FROM:
        raise NumericalError(
            f"{curve.method}: the turns begin at {lateral[0]:.4g} m/s^2, above "
            f"{GRADIENT_FROM:g} m/s^2 from where gradients are taken"
        )
    found = np.zeros(1 + len(slopes.parameters))
    for k, unit in enumerate(np.eye(len(lateral))):
        weight = line_slope(lateral, unit, *ends)
        if weight:
            turn = turns(float(lateral[k]))
            found += weight * slopes.quantity(quantity, turn, curve.points[k])
    text = f"{words}, from {GRADIENT_FROM:g} to {GRADIENT_UP_TO:g} m/s^2"
    yield Quantity(f"{asked.quantity}, {_where(asked)}", "rad*s^2/m", text), found


def _limit(slopes: TurnSlopes, asked: _Asked) -> Iterator[tuple[Quantity, Floats]]:
    """Yield the largest lateral acceleration of a steady turn, with derivatives."""
    method = _METHODS[asked.method]
    curve = method.curve(slopes.solver, asked.given)
    if not np.isfinite(curve.limit):
        why = curve.reason or "no turn was found on the way"
        raise NumericalError(
            f"{curve.method}: the turns end before the curve comes back ({why}), so that the end "
            "has no derivative"
        )
    turns, lateral = method.turns(asked.given), curve.values["lateral_acceleration"]
    known = [(float(lateral[k]), curve.points[k]) for k in (-2, -1)]
    found = slopes.limit(turns, limit_turn(slopes.solver, turns, *known))
    words = "Largest lateral acceleration of a steady turn"
    yield Quantity(f"limit, {_where(asked)}", "m/s^2", words), found


def _parsed(name: str) -> _Asked:
    """Return what a name asks for.

    Raises
    ------
    InputError
        If a part is missing or means nothing.
    """
    settings = [method.setting for method in _METHODS.values()]
    parts, options = called_parts(name, _FORM, (2, 3), settings)
    quantity, method = parts[:2]
    of_curves = (*_LINES, _LIMIT)
    if quantity not in (*QUANTITIES, *of_curves):
        known = [*QUANTITIES, *of_curves]
        raise InputError(f"'{name}': {unknown_name('quantity', quantity, known)}")
    if method not in _METHODS:
        raise InputError(f"'{name}': {unknown_name('method', method, _METHODS)}")
    if (quantity in of_curves) == (len(parts) > 2):
        what = (
            "is of the whole curve: give no values"
            if quantity in of_curves
            else "needs lateral accelerations, such as 4 m/s^2"
        )
        raise InputError(f"'{name}': {quantity} {what}")
    own = _METHODS[method]
    wrong = [key for key in options if key != own.setting]
    if wrong:
        raise InputError(f"'{name}': {unknown_name('setting', wrong[0], [own.setting])}")
    try:
        given = float(to_si(options.get(own.setting, own.usual), own.unit))
        values = read_range(parts[2]).values("m/s^2") if len(parts) > 2 else ()
    except InputError as error:
        raise InputError(f"'{name}': {error}") from None
    if not given > 0.0 or min(values, default=1.0) <= 0.0:
        raise InputError(f"'{name}': {own.setting} and lateral accelerations must be above zero")
    return _Asked(quantity, method, given, values)
