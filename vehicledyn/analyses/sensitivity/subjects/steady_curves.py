"""Derivatives along curves of steady turns: quantities, gradients and limits.

A line that fits a curve between two lateral accelerations is linear in its values: its slope moves
as the same line through their derivatives, and where points move along by what the curve climbs.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.circle import (
    QUANTITIES,
    STEP,
    SteadyCurve,
    at_speed,
    constant_radius,
    constant_speed,
    constant_steering,
    line_slope_parts,
    on_circle,
)
from vehicledyn.analyses.handling.steady import GRADIENT_FROM, GRADIENT_UP_TO
from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.turn_equations import TurnDemand, TurnOf
from vehicledyn.analyses.handling.turn_limit import limit_turn
from vehicledyn.analyses.handling.turn_slopes import TURNED, TurnSlopes
from vehicledyn.analyses.sensitivity.subjects.steady_names import LIMIT, LINES, Asked
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.units import shown
from vehicledyn.results.store.linear_file import Quantity

Floats = NDArray[np.float64]
Found: TypeAlias = Iterator[tuple[Quantity, Floats]]
"""Figures, each with its value and then its derivatives by the car's parameters."""

_TRACED: dict[str, tuple[str, Callable[[float], TurnOf], Callable[..., SteadyCurve]]] = {
    "constant_speed": ("speed", at_speed, constant_speed),
    "constant_radius": ("radius", on_circle, constant_radius),
}
"""Curves along a given lateral acceleration: setting, demands, turns."""

_ENDS = GRADIENT_FROM, GRADIENT_UP_TO
_BEYOND = GRADIENT_UP_TO + 2.0 * STEP


def circle_figures(slopes: TurnSlopes, asked: Asked) -> Found:
    """Yield what is asked of turns at constant speed or radius.

    Raises
    ------
    NumericalError
        If a turn is not found.
    """
    setting, turns_of, _ = _TRACED[asked.method]
    turns = turns_of(asked.of(setting))
    if asked.quantity == LIMIT:
        return _limit(slopes, asked, turns)
    if not asked.values:
        curve = traced(slopes.solver, asked, _BEYOND)
        demands = [turns(float(at)) for at in curve.values["lateral_acceleration"]]
        return _gradient(slopes, asked, curve, demands)
    return _values(slopes, asked, turns)


def traced(solver: SteadyTurn, asked: Asked, last: float) -> SteadyCurve:
    """Return the curve of a test up to a lateral acceleration [m/s²].

    Raises
    ------
    NumericalError
        If it ends before.
    """
    setting, _, curve_of = _TRACED[asked.method]
    curve = curve_of(solver, asked.of(setting), last=last)
    lateral = curve.values["lateral_acceleration"]
    reached = lateral[-1] if len(lateral) else 0.0
    if reached < last - 1e-6:
        raise NumericalError(_ended(curve, reached, last, "m/s^2"))
    return curve


def _ended(curve: SteadyCurve, reached: float, last: float, unit: str) -> str:
    why = f" ({curve.reason})" if curve.reason else ""
    return f"{curve.method}: the turns end at {reached:.4g} {unit}{why}, before {last:g} {unit}"


def _values(slopes: TurnSlopes, asked: Asked, turns: TurnOf) -> Found:
    """Yield a quantity at its lateral accelerations, with derivatives."""
    curve = traced(slopes.solver, asked, max(asked.values))
    lateral = curve.values["lateral_acceleration"]
    for value in asked.values:
        near = curve.points[int(np.argmin(np.abs(lateral - value)))]
        turn = turns(value)
        point = slopes.solver.find(turn, near)
        quantity = Quantity(asked.at(value), *QUANTITIES[asked.quantity])
        yield quantity, slopes.quantity(asked.quantity, turn, point)


def _gradient(
    slopes: TurnSlopes,
    asked: Asked,
    curve: SteadyCurve,
    turns: list[TurnDemand],
    moving: Floats | None = None,
) -> Found:
    """Yield the slope of the line that fits a curve, with derivatives.

    ``moving`` is how the value that is demanded of its turns follows the car's parameters.
    """
    quantity, words = LINES[asked.quantity]
    lateral, values = (curve.values[name] for name in ("lateral_acceleration", quantity))
    if lateral[0] > GRADIENT_FROM or lateral[-1] < GRADIENT_UP_TO:
        raise NumericalError(
            f"{curve.method}: the turns are from {lateral[0]:.4g} to {lateral[-1]:.4g} m/s^2, and "
            f"gradients are taken from {GRADIENT_FROM:g} to {GRADIENT_UP_TO:g} m/s^2"
        )
    found = np.zeros(1 + len(slopes.parameters))
    place = TURNED.index("lateral_acceleration")
    for k, (aside, up) in enumerate(line_slope_parts(lateral, values, *_ENDS)):
        if up or aside:
            at = slopes.at(turns[k], curve.points[k], asked=moving)
            found += up * slopes.named(quantity, at)
            found[1:] += aside * at[1:, place]
    text = f"{words}, from {GRADIENT_FROM:g} to {GRADIENT_UP_TO:g} m/s^2"
    yield Quantity(f"{asked.quantity}, {asked.where}", "rad*s^2/m", text), found


def _limit(slopes: TurnSlopes, asked: Asked, turns: TurnOf) -> Found:
    """Yield the largest lateral acceleration of a steady turn, with derivatives."""
    setting, _, curve_of = _TRACED[asked.method]
    curve = curve_of(slopes.solver, asked.of(setting))
    if not np.isfinite(curve.limit):
        why = curve.reason or "no turn was found on the way"
        raise NumericalError(
            f"{curve.method}: the turns end before the curve comes back ({why}), so that the end "
            "has no derivative"
        )
    lateral = curve.values["lateral_acceleration"]
    known = [(float(lateral[k]), curve.points[k]) for k in (-2, -1)]
    found = slopes.limit(turns, limit_turn(slopes.solver, turns, *known))
    words = "Largest lateral acceleration of a steady turn"
    yield Quantity(f"limit, {asked.where}", "m/s^2", words), found


def held_wheel_figures(slopes: TurnSlopes, asked: Asked) -> Found:
    """Yield what is asked of turns with the steering wheel held.

    Without an angle it is the one of 4 m/s² at constant speed, which follows the parameters.

    Raises
    ------
    NumericalError
        If a turn is not found.
    """
    solver, given = slopes.solver, asked.given["steering"]
    angle = _angle(slopes, asked.of("speed")) if given is None else None
    value = float(given or 0.0) if angle is None else float(angle[0])
    moving = None if angle is None else angle[1:]
    if not asked.values:
        curve = constant_steering(solver, value, last=_BEYOND)
        turns = [TurnDemand(float(v), "steering", value) for v in curve.values["speed"]]
        yield from _gradient(slopes, asked, curve, turns, moving)
        return
    curve = constant_steering(solver, value, fastest=max(asked.values))
    speeds = curve.values["speed"]
    for speed in asked.values:
        if speed > speeds[-1]:
            raise NumericalError(_ended(curve, speeds[-1], speed, "m/s"))
        near = curve.points[int(np.argmin(np.abs(speeds - speed)))]
        turn = TurnDemand(speed, "steering", value)
        numbers = slopes.quantity(asked.quantity, turn, solver.find(turn, near), asked=moving)
        name = f"{asked.quantity} at {shown(speed, 'm/s')}, {asked.where}"
        yield Quantity(name, *QUANTITIES[asked.quantity]), numbers


def _angle(slopes: TurnSlopes, speed: float) -> Floats:
    """Return the steering-wheel angle of 4 m/s² at a speed, as ``steady`` reads it [rad]."""
    curve = constant_speed(slopes.solver, speed, last=_BEYOND)
    lateral, turns = curve.values["lateral_acceleration"], at_speed(speed)
    found = np.zeros(1 + len(slopes.parameters))
    for k, unit in enumerate(np.eye(len(lateral))):
        share = float(np.interp(GRADIENT_UP_TO, lateral, unit))
        if share:
            turn = turns(float(lateral[k]))
            found += share * slopes.quantity("steering_angle", turn, curve.points[k])
    return found
