"""Steady running of cars with engines, gearboxes and pedals: nothing changes, in the right gear."""

import numpy as np
import pytest

from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.tested_car import CONTROL, TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.base.errors import NumericalError
from vehicledyn.interface.targets import read_target
from vehicledyn.road.manoeuvres.driving_test import DrivingTest

pytestmark = pytest.mark.long

SPEED = 20.0
RATIOS = [1 / 0.265, 1 / 0.489, 1 / 0.784, 1 / 1.063, 1 / 1.276, 1 / 1.499]
STEADY = 1e-6


def solver_of(model):
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(read_target(model), backend="interpreted", progress=lambda *_: None, test=test)
    return SteadyTurn(car)


@pytest.fixture(scope="module")
def automatic() -> SteadyTurn:
    return solver_of("automatic_sedan")


def value(solver, point, name):
    return point.state[solver.car.state(name)]


def greatest_rate(solver, point):
    """Return the largest rate of all states but the angles of what turns and the way."""
    car, e = solver.car, solver.car.equations
    car.kernel.set_parameters(point.parameters)
    rates = car.rates(point.state, point.unknowns)[0]
    chassis = car.vehicle.chassis
    going = {*solver.states.turning, *(f"{chassis}.{k}" for k in ("x", "y", "yaw"))}
    going |= {f"{chassis}.{k}_rate" for k in ("x", "y")}
    return max(abs(r) for s, r in zip(e.states, rates, strict=True) if s.name not in going)


@pytest.mark.parametrize("model", ["all_wheel_drive_sedan", "electric_car"])
def test_a_driven_car_runs_straight_and_turns(model):
    """Every rate vanishes, also that of the accelerator, which the search does not balance."""
    solver = solver_of(model)
    point = solver.straight(SPEED)
    turn = solver.find(TurnDemand(SPEED, "lateral_acceleration", 3.0), point)
    assert turn.state[solver.states.motion[2]] * SPEED == pytest.approx(3.0, rel=1e-3)
    for found in (point, turn):
        assert greatest_rate(solver, found) < STEADY
        assert 0.0 < found.state[solver.states.pedal] < 1.0


def test_the_gearbox_is_in_the_gear_of_the_speed(automatic):
    """The highest gear below whose threshold, with its accelerator, the engine turns."""
    point = automatic.straight(SPEED)
    numbers = dict(
        zip((p.name for p in automatic.car.equations.parameters), point.parameters, strict=True)
    )
    pressed = value(automatic, point, "gearbox.accelerator.value")
    shafts = ("left", "right")
    shaft = np.mean(
        [value(automatic, point, f"car.driveline.{s}_shaft.angle_rate") for s in shafts]
    )
    propeller = numbers["car.driveline.ratio"] * shaft
    limit = numbers["gearbox.shift.up"] + pressed * numbers["gearbox.shift.up_later"]
    by_hand = next(k for k, ratio in enumerate(RATIOS, start=1) if ratio * propeller < limit)
    assert by_hand > 1
    assert value(automatic, point, "gearbox.gear.value") == by_hand
    assert value(automatic, point, "gearbox.shifting.value") == 0.0
    assert greatest_rate(automatic, point) < STEADY


def test_a_steady_turn_with_a_gearbox_holds_all_rates(automatic):
    point = automatic.find(
        TurnDemand(SPEED, "lateral_acceleration", 3.0), automatic.straight(SPEED)
    )
    assert point.state[automatic.states.motion[2]] * SPEED == pytest.approx(3.0, rel=1e-3)
    assert greatest_rate(automatic, point) < STEADY


def test_more_than_full_throttle_is_refused(automatic):
    straight = automatic.straight(SPEED)
    with pytest.raises(NumericalError, match="full throttle"):
        automatic.find(TurnDemand(SPEED, "steering", 0.0, 4.0), straight)
