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
    curve_of,
)
from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.turn_equations import TurnDemand
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
    lateral = circle.values["lateral_acceleration"]
    ends = [
        solver.find(
            TurnDemand(float(np.sqrt(at * radius)), "curvature", 1.0 / radius),
            circle.points[int(np.argmin(np.abs(lateral - at)))],
        )
        for at in (first, last)
    ]
    turns = curve_of(solver, circle.method, ends)
    places = list(
        zip(turns.values["lateral_acceleration"], turns.values["understeer_angle"], strict=True)
    )
    found = {"constant_radius": places}
    speeds = [float(np.sqrt(at * radius)) for at in (first, last)]
    angles = turns.values["steering_angle"]
    found["constant_speed"] = [
        place_on(constant_speed(solver, speed, last=at + _BEYOND), "curvature", 1.0 / radius, at)
        for speed, (at, _) in zip(speeds, places, strict=True)
    ]
    found["constant_steering"] = [
        place_on(constant_steering(solver, angle, last=at + _BEYOND), "curvature", 1.0 / radius, at)
        for angle, (at, _) in zip(angles, places, strict=True)
    ]
    return {name: (b[1] - a[1]) / (b[0] - a[0]) for name, (a, b) in found.items()}


def place_on(curve: SteadyCurve, name: str, value: float, near: float) -> tuple[float, float]:
    """Return lateral acceleration and understeer angle where a quantity has a value.

    Parabolas over lateral acceleration through three neighbours give all. Of several places, as
    where a neutral car comes back to a circle, it is the one nearest to a lateral acceleration;
    NaN where the curve does not reach the value.
    """
    lateral, angle = curve.values["lateral_acceleration"], curve.values["understeer_angle"]
    gap, found = curve.values[name] - value, []
    for k in range(len(gap) - 1):
        if len(gap) < _POINTS or gap[k] * gap[k + 1] > 0.0:
            continue
        first = min(k, len(gap) - _POINTS)
        around = slice(first, first + _POINTS)
        base = lateral[k]
        crossing = np.polyfit(lateral[around] - base, gap[around], _POINTS - 1)
        bend = np.polyfit(lateral[around] - base, angle[around], _POINTS - 1)
        ends = sorted((0.0, float(lateral[k + 1] - base)))
        roots = [float(r.real) for r in np.roots(crossing) if abs(r.imag) < _EVEN]
        inside = [r for r in roots if ends[0] - _EVEN <= r <= ends[1] + _EVEN]
        found += [(float(base + r), float(np.polyval(bend, r))) for r in inside]
    return min(found, key=lambda place: abs(place[0] - near), default=(np.nan, np.nan))


def equal_curvature_figures(
    solver: SteadyTurn, circle: SteadyCurve, radius: float, *, first: float, last: float
) -> Iterator[KeyFigure]:
    """Yield the gradients of the three methods on one circle, and how far they are apart.

    Yields nothing where the test at constant radius does not reach both lateral accelerations, and
    no method that does not cross the circle there.
    """
    lateral = circle.values["lateral_acceleration"]
    if not len(lateral) or lateral[0] > first or lateral[-1] < last:
        return
    found = gradients_on_circle(solver, circle, radius, first=first, last=last)
    slopes = np.array([slope for slope in found.values() if np.isfinite(slope)])
    for name, slope in found.items():
        if not np.isfinite(slope):
            continue
        method = name.replace("_", " ")
        words = f"Understeer gradient from {first:g} to {last:g} m/s^2 on {radius:g} m, {method}"
        yield KeyFigure(NAME, name, slope, "rad*s^2/m", words)
    if len(slopes) < len(found):
        return
    apart = float(np.ptp(slopes) / np.abs(slopes).max())
    words = "Difference of the three methods at this curvature (ISO 4138)"
    yield KeyFigure(NAME, "difference", apart, "1", words)


_POINTS = 3
_EVEN = 1e-9
