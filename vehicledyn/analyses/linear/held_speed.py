"""Straight running at a constant speed: the point to linearise a vehicle about."""

from __future__ import annotations

from vehicledyn.analyses.linear.linear_inputs import THRUST
from vehicledyn.analyses.preparation.prepare import Point, Start, reference_point
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.preparation.road_runnable import RoadSubject
from vehicledyn.base.errors import NumericalError

_HELD = 1e-10
"""Acceleration at which the speed counts as held [m/s²]."""

_TRIALS = 12


def held_speed_point(prepared: Prepared, speed: float, start: Start | None) -> Point:
    """Return the reference point; a vehicle at a speed keeps it by a force along its chassis.

    Without that force it would slowly fall in speed, and no constant input could have a
    constant answer. The force is found by the secant method.

    Raises
    ------
    NumericalError
        If no force holds the speed.
    """
    if not isinstance(prepared.subject, RoadSubject):
        return reference_point(prepared, speed, start, is_system=True)
    point = reference_point(prepared, speed, start, is_system=False)
    if speed <= 0.0:
        return point
    thrust, found = 0.0, _acceleration(prepared, point)
    step = -1e3 * found  # a car has about this mass
    for _ in range(_TRIALS):
        if abs(found) <= _HELD:
            return point
        thrust += step
        _push(prepared, thrust)
        point = reference_point(prepared, speed, start, is_system=False)
        before, found = found, _acceleration(prepared, point)
        if found == before:
            break
        step *= -found / (found - before)
    if abs(found) <= _HELD:
        return point
    raise NumericalError(f"no force along the chassis holds the speed of {speed:g} m/s")


def _push(prepared: Prepared, thrust: float) -> None:
    values = prepared.kernel.parameters
    values[[p.name for p in prepared.equations.parameters].index(THRUST)] = thrust
    prepared.kernel.set_parameters(values)


def _acceleration(prepared: Prepared, point: Point) -> float:
    """Return the acceleration of the chassis along x [m/s²]."""
    time, chassis = prepared.subject.balance_time, prepared.vehicle.chassis
    rates = prepared.kernel.rates(time, point.state, point.unknowns)
    return float(rates[prepared.index(f"{chassis}.x_rate")])
