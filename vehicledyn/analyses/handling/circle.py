"""Steady-state cornering by the three methods of ISO 4138, as curves over lateral acceleration."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.slow_turn import effective_wheelbase
from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint, TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnDemand, TurnOf
from vehicledyn.analyses.handling.turn_paths import followed

Vector = NDArray[np.float64]

STEP = 0.25
"""Distance of points [m/s²]."""

_LINE_POINTS = 41
"""Points of a curve that the line of a gradient fits."""

_SMALLEST_STEP = 0.01
_SLOWEST, _FASTEST = 3.0, 70.0
"""Speeds between which points of a circle are looked for [m/s]."""

_SQUARES, _LEAST_SQUARE = 15.0, 0.5
"""Distance of squared speeds of turns with the wheel held, and the least one [m²/s²]."""

QUANTITIES = {
    "lateral_acceleration": ("m/s^2", "Lateral acceleration: speed times yaw rate"),
    "speed": ("m/s", "Speed"),
    "steering_angle": ("rad", "Steering-wheel angle"),
    "understeer_angle": ("rad", "Front-wheel angle beyond effective wheelbase times curvature"),
    "sideslip_angle": ("rad", "Side-slip angle"),
    "roll_angle": ("rad", "Roll angle"),
    "yaw_rate": ("rad/s", "Yaw rate"),
    "curvature": ("1/m", "Curvature of the path"),
    "drive_torque": ("N*m", "Drive torque that holds the speed"),
    "smallest_wheel_load": ("N", "Smallest wheel load"),
}
"""Quantities of a curve with units and meanings."""


@dataclass(frozen=True)
class SteadyCurve:
    """Steady turns along lateral acceleration.

    ``values`` holds the quantities of :data:`QUANTITIES`, each of shape (n_points,); ``points`` the
    states. ``limit`` is the largest lateral acceleration [m/s²], behind which the curve comes back;
    NaN where it was not followed to it. ``is_lost`` says that it was to be and that no turn was
    found on the way, ``reason`` what else ended the curve, such as full throttle.
    """

    method: str
    values: dict[str, Vector]
    points: list[CarPoint] = field(repr=False)
    limit: float = float("nan")
    is_lost: bool = False
    reason: str = ""

    def gradient(self, name: str, last: float, *, first: float = 0.25) -> float:
        """Return the slope of a quantity over lateral acceleration between two of these [m/s²].

        A line fits the curve at equal distances of lateral acceleration: the methods have their
        points at different places, and the curve bends.
        """
        return line_slope(self.values["lateral_acceleration"], self.values[name], first, last)


def at_speed(speed: float) -> TurnOf:
    """Return the demand of lateral accelerations at a speed [m/s]."""
    return lambda lateral: TurnDemand(speed, "lateral_acceleration", lateral)


def on_circle(radius: float) -> TurnOf:
    """Return the demand of lateral accelerations on a circle to the left [m]."""
    return lambda lateral: TurnDemand(float(np.sqrt(lateral * radius)), "curvature", 1.0 / radius)


def constant_speed(
    solver: SteadyTurn, speed: float, *, last: float = np.inf, first: float = 0.0
) -> SteadyCurve:
    """Return the turns at a speed [m/s] from a lateral acceleration to the limit [m/s²].

    The limit is where the curve of turns comes back, to 0.01 m/s².

    Raises
    ------
    NumericalError
        If the car does not run straight.
    """
    start, turn = solver.straight(speed), at_speed(speed)
    return _followed(solver, "constant speed", turn, start, first=first, last=last)


def constant_radius(solver: SteadyTurn, radius: float, *, last: float = np.inf) -> SteadyCurve:
    """Return the turns on a circle to the left [m], the speed growing from a walk to the limit."""
    first, turn = max(_SLOWEST**2 / radius, 0.1), on_circle(radius)
    start = solver.straight(float(np.sqrt(first * radius)))
    return _followed(solver, "constant radius", turn, start, first=first, last=last)


def constant_steering(
    solver: SteadyTurn, angle: float, *, last: float = np.inf, fastest: float = _FASTEST
) -> SteadyCurve:
    """Return the turns at a steering-wheel angle [rad], the speed growing from a walk.

    Points are at speeds whose squares are equally spaced, as the lateral acceleration then about
    is; the curve ends behind a speed ``fastest`` [m/s], where lateral acceleration exceeds ``last``
    or where no turn is found.
    """

    def turn(square: float) -> TurnDemand:
        return TurnDemand(float(np.sqrt(square)), "steering", angle)

    squares = np.arange(_SLOWEST**2, min(fastest**2 + _SQUARES, _FASTEST**2), _SQUARES)
    found = [solver.find(turn(squares[0]), solver.straight(_SLOWEST))]
    for before, after in pairwise(squares):
        start = float(before), found[-1]
        steps = {"step": _SQUARES, "smallest": _LEAST_SQUARE}
        path = followed(solver, turn, start, after, **steps, unwanted=solver.beyond_grip_or_drive)
        if path.end != "found":
            break
        found.append(path.points[-1])
        if abs(solver.car.outputs(found[-1])["accelerometer.lateral"]) > last:
            break
    return curve_of(solver, "constant steering-wheel angle", found)


def _followed(
    solver: SteadyTurn,
    method: str,
    turn: Callable[[float], TurnDemand],
    start: CarPoint,
    *,
    first: float,
    last: float,
) -> SteadyCurve:
    begin = first, solver.find(turn(first), start)
    steps = {"step": STEP, "smallest": _SMALLEST_STEP}
    path = followed(solver, turn, begin, last, **steps, unwanted=solver.beyond_grip_or_drive)
    curve = curve_of(solver, method, path.points)
    limit = float(curve.values["lateral_acceleration"].max()) if path.is_limit else float("nan")
    return replace(curve, limit=limit, is_lost=path.is_lost, reason=path.reason)


def curve_of(solver: SteadyTurn, method: str, points: list[CarPoint]) -> SteadyCurve:
    """Return steady turns with their quantities."""
    rows = [describe(solver, point) for point in points]
    wheelbase = effective_wheelbase(solver)
    for row in rows:
        front = row["steering_angle"] / solver.car.steering_ratio
        row["understeer_angle"] = front - wheelbase * row["curvature"]
    values = {name: np.array([row[name] for row in rows]) for name in QUANTITIES}
    return SteadyCurve(method, values, points)


def describe(solver: SteadyTurn, point: CarPoint) -> dict[str, float]:
    """Return the quantities of a steady turn but the understeer angle."""
    found = described(solver.car, solver.car.outputs(point))
    return {name: float(value.real) for name, value in found.items()}


def channels_described(car: TestedCar) -> list[str]:
    """Return the channels that the quantities of a steady turn are drawn from."""
    body = (f"body.{name}" for name in ("forward_speed", "lateral_speed", "yaw_rate"))
    loads = (f"{corner.name}.tyre.normal_force" for corner in car.vehicle.corners)
    others = "body.sideslip_angle", f"{car.vehicle.chassis}.roll", "drive.torque"
    return [*body, "steering_angle.angle", *others, *loads]


def described(car: TestedCar, outputs: Mapping[str, complex]) -> dict[str, complex]:
    """Return the quantities of a steady turn but the understeer angle, analytic in its channels."""
    ahead, aside, rate = (
        outputs[f"body.{name}"] for name in ("forward_speed", "lateral_speed", "yaw_rate")
    )
    speed = complex(np.sqrt(ahead * ahead + aside * aside))
    loads = [outputs[f"{corner.name}.tyre.normal_force"] for corner in car.vehicle.corners]
    return {
        "lateral_acceleration": speed * rate,
        "speed": speed,
        "steering_angle": outputs["steering_angle.angle"],
        "sideslip_angle": outputs["body.sideslip_angle"],
        "roll_angle": outputs[f"{car.vehicle.chassis}.roll"],
        "yaw_rate": rate,
        "curvature": rate / speed,
        "drive_torque": outputs["drive.torque"],
        "smallest_wheel_load": min(loads, key=lambda load: load.real),
    }


def line_slope(lateral: Vector, values: Vector, first: float, last: float) -> float:
    """Return the slope of a line that fits a curve between two lateral accelerations [m/s²].

    It is linear in ``values``, one for each of ``lateral``.
    """
    at = _line_places(lateral, first, last)
    return float(np.polyfit(at, np.interp(at, lateral, values), 1)[0])


def line_slope_parts(lateral: Vector, values: Vector, first: float, last: float) -> Vector:
    """Return the derivatives of :func:`line_slope` by lateral accelerations and values, (n, 2).

    Between neighbours the curve is a line of slope s, so one that moves by dx changes what is read
    beside it by -s dx, as if its value fell by s dx.
    """
    at = _line_places(lateral, first, last)
    weights = np.linalg.pinv(np.stack([at, np.ones_like(at)], axis=1))[0]
    shares = np.stack([np.interp(at, lateral, unit) for unit in np.eye(len(lateral))], axis=1)
    behind = np.clip(np.searchsorted(lateral, at), 1, len(lateral) - 1)
    slopes = (values[behind] - values[behind - 1]) / (lateral[behind] - lateral[behind - 1])
    return np.stack([-(weights * slopes) @ shares, weights @ shares], axis=1)


def _line_places(lateral: Vector, first: float, last: float) -> Vector:
    return np.linspace(max(first, lateral[0]), min(last, lateral[-1]), _LINE_POINTS)
