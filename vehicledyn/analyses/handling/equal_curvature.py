"""The three methods of ISO 4138 at one curvature: what their turns on one circle have in common.

The gradient of a car falls with curvature, and a single test at constant speed or with the wheel
held changes its curvature on the way. So both are read where they turn on the circle of the test
at constant radius: each in two tests that cross the circle at 2 and at 4 m/s².
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vehicledyn.analyses.handling.circle import (
    SteadyCurve,
    constant_speed,
    constant_steering,
)
from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.results.tables.handling_table import KeyFigure

_BEYOND = 0.5
"""How far a test goes on behind the circle [m/s²]."""

NAME = "equal_curvature"


def gradients_on_circle(
    solver: SteadyTurn, circle: SteadyCurve, radius: float, *, first: float, last: float
) -> dict[str, float]:
    """Return the understeer gradient of each method between two lateral accelerations [rad s²/m].

    Parameters
    ----------
    solver
        Finds the turns.
    circle
        The test at constant radius, which reaches ``last``.
    radius
        Its radius [m].
    first, last
        Lateral accelerations of both turns [m/s²].
    """
    ends = (first, last)
    lateral = circle.values["lateral_acceleration"]
    angles = [float(np.interp(at, lateral, circle.values["steering_angle"])) for at in ends]
    speeds = [float(np.sqrt(at * radius)) for at in ends]
    found = {"constant_radius": [_on_curve(circle, "lateral_acceleration", at) for at in ends]}
    found["constant_speed"] = [
        _on_curve(constant_speed(solver, speed, last=at + _BEYOND), "curvature", 1.0 / radius)
        for speed, at in zip(speeds, ends, strict=True)
    ]
    found["constant_steering"] = [
        _on_curve(constant_steering(solver, angle, last=at + _BEYOND), "curvature", 1.0 / radius)
        for angle, at in zip(angles, ends, strict=True)
    ]
    return {name: (b[1] - a[1]) / (b[0] - a[0]) for name, (a, b) in found.items()}


def equal_curvature_figures(
    solver: SteadyTurn, circle: SteadyCurve, radius: float, *, first: float, last: float
) -> Iterator[KeyFigure]:
    """Yield the gradients of the three methods on one circle, and how far they are apart.

    Yields nothing where the test at constant radius does not reach both lateral accelerations.
    """
    lateral = circle.values["lateral_acceleration"]
    if not len(lateral) or lateral[0] > first or lateral[-1] < last:
        return
    found = gradients_on_circle(solver, circle, radius, first=first, last=last)
    for name, slope in found.items():
        method = name.replace("_", " ")
        words = f"Understeer gradient from {first:g} to {last:g} m/s^2 on {radius:g} m, {method}"
        yield KeyFigure(NAME, name, slope, "rad*s^2/m", words)
    slopes = np.array(list(found.values()))
    apart = float(np.ptp(slopes) / np.abs(slopes).max())
    words = "Difference of the three methods at this curvature (ISO 4138)"
    yield KeyFigure(NAME, "difference", apart, "1", words)


def _on_curve(curve: SteadyCurve, name: str, value: float) -> tuple[float, float]:
    """Return lateral acceleration and understeer angle where a quantity has a value.

    A parabola through the three nearest turns gives both; NaN where the curve does not reach it.
    """
    along = curve.values[name]
    if len(along) < _POINTS or not along.min() <= value <= along.max():
        return float("nan"), float("nan")
    near = np.argsort(np.abs(along - value))[:_POINTS]
    lateral, angle = (
        float(np.polyfit(along[near] - value, curve.values[of][near], _POINTS - 1)[-1])
        for of in ("lateral_acceleration", "understeer_angle")
    )
    return lateral, angle


_POINTS = 3
