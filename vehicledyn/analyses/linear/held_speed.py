"""Straight running at a constant speed: the point to linearise a vehicle about."""

from __future__ import annotations

from vehicledyn.analyses.linear.linear_inputs import THRUST
from vehicledyn.analyses.preparation.prepare import AssembledPoint, Start, reference_point
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.errors import NumericalError

_HELD = 1e-10
"""Acceleration at which the speed counts as held [m/s²]."""

_TRIALS = 12


def held_speed_point(prepared: Prepared, speed: float, start: Start | None) -> AssembledPoint:
    """Return the reference point; what runs along a road keeps its speed by a force on its body.

    Without that force it would slowly fall in speed, and no constant input could have a
    constant answer. The force is found by the secant method.

    Raises
    ------
    NumericalError
        If no force holds the speed.
    """
    point = reference_point(prepared, speed, start)
    if speed <= 0.0 or not prepared.subject.ports.body:
        return point
    thrust, found = 0.0, _acceleration(prepared, point)
    step = -1e3 * found  # a car has about this mass
    for _ in range(_TRIALS):
        if abs(found) <= _HELD:
            return point
        thrust += step
        _push(prepared, thrust)
        point = reference_point(prepared, speed, start)
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


def _acceleration(prepared: Prepared, point: AssembledPoint) -> float:
    """Return the acceleration of the body along x [m/s²]."""
    time, body = prepared.subject.balance_time, prepared.subject.ports.body
    rates = prepared.kernel.rates(time, point.state, point.unknowns)
    return float(rates[prepared.index(f"{body}.x_rate")])
