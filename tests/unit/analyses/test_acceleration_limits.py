"""The g-g and the yaw-moment diagram: what ends them where cars are driven hard."""

import functools

import numpy as np
import pytest

from vehicledyn.analyses.handling.acceleration_limits import (
    FRONT_GRIP,
    LARGEST_FORCE,
    acceleration_limits,
    turns_to_limits,
)
from vehicledyn.analyses.handling.steady_turn import (
    FULL_THROTTLE,
    POWER_SLIDE,
    WHEEL_SPIN,
    solver_for,
)
from vehicledyn.analyses.handling.tested_car import CONTROL, TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.analyses.handling.turn_limit import limit_value
from vehicledyn.analyses.handling.turn_paths import followed
from vehicledyn.analyses.handling.yaw_moment import yaw_moments
from vehicledyn.interface.targets import read_target
from vehicledyn.road.manoeuvres.driving_test import DrivingTest

pytestmark = pytest.mark.long


SPEED = 100.0 / 3.6


@functools.cache
def solver_of(model):
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(read_target(model), backend="auto", progress=lambda *_: None, test=test)
    return solver_for(car)


def limits_of(model):
    return acceleration_limits(solver_of(model), SPEED)


def test_power_slides_are_left_out():
    """Rear-wheel drive and an open differential: the inner wheel spins, opposite lock holds."""
    found = limits_of("sedan")
    assert not found.lost
    driven = found.longitudinal >= 0.0
    assert (np.diff(found.lateral[driven]) < 0.0).all()
    slides = [end == POWER_SLIDE for end in found.ends]
    assert found.longitudinal[slides] == pytest.approx([6.0, 7.0])
    spins = [end == WHEEL_SPIN for end in found.ends]
    assert found.longitudinal[spins][:-1] == pytest.approx(np.arange(2.0, 6.0))
    assert found.lateral[[0, -1]] == pytest.approx(0.0)


@pytest.mark.parametrize("along", [0.0, -7.0])
def test_limits_are_those_of_the_curve_whatever_the_steps(along):
    """They were known to a step, 0.03 m/s^2; at -7 the inner rear wheel is locked."""
    solver = solver_of("small_car")
    start, values = (0.0, solver.straight(SPEED)), []
    if along:
        path = turns_to_limits(solver, SPEED, -1.0)[0][-along]
        start = path.values[0], path.points[0]

    def turn(across):
        return TurnDemand(SPEED, "lateral_acceleration", across, along)

    for smallest in (0.03, 0.2):
        path = followed(solver, turn, start, np.inf, step=0.5, smallest=smallest)
        values.append(limit_value(solver, turn, path, smallest=smallest))
        assert path.values[-1] < values[-1] < path.values[-1] + 2.0 * smallest
    assert values[0] == pytest.approx(values[1], abs=1e-9)


def test_a_locked_inner_wheel_ends_no_diagram():
    """The inner rear wheel locks first; the car turns on with it locked, on three wheels."""
    found = limits_of("jeep")
    assert not found.lost
    braked = found.longitudinal <= -2.0
    assert (np.diff(found.lateral[braked]) > 0.5).all()  # at -5 m/s^2 it was 2.76, at -4 6.05
    at = dict(zip(found.longitudinal, zip(found.ends, found.locked, strict=True), strict=True))
    assert at[-4.0] == (FRONT_GRIP, ("front_left", "rear_left"))
    assert at[3.0] == (LARGEST_FORCE, ())
    words = " ".join(found.notes())
    assert "(front_left): at 0, 1, 2, 3, 4, 5, 6 m/s^2" in words
    assert "(front_left, rear_left): at -7, -6, -5, -4 m/s^2" in words


def test_a_spinning_wheel_ends_the_diagram():
    """Behind it turns were found at 13,000 rad/s of a front wheel, 6.7 m/s^2 at 4 along."""
    found = limits_of("front_wheel_drive_car")
    driven = found.longitudinal >= 0.0
    assert (np.diff(found.lateral[driven]) < 0.0).all()
    assert found.ends[-3:-1] == (WHEEL_SPIN, WHEEL_SPIN)
    # A car that brakes first locks its inner rear wheel and reaches 6.25 m/s^2 only.
    later = dict(
        zip(found.longitudinal, zip(found.lateral, found.locked, strict=True), strict=True)
    )[-5.0]
    assert later == (pytest.approx(7.62, abs=0.05), ())


def test_a_motor_ends_the_diagram_at_full_throttle():
    found = limits_of("electric_car")
    assert not found.lost
    assert found.ends[-1] == FULL_THROTTLE
    assert found.longitudinal[-1] == pytest.approx(3.43, abs=0.05)
    # Its discs stick: the inner rear wheel locks, where the diagram ended at 2.23 and 5.38.
    rows = zip(found.longitudinal, zip(found.lateral, found.locked, strict=True), strict=True)
    at, rear = dict(rows), "car.rear_axle.wheel_left"
    assert at[-3.0] == (pytest.approx(6.44, abs=0.05), (rear,))
    assert at[-6.0] == (pytest.approx(4.98, abs=0.05), ("car.front_axle.wheel_left", rear))


def test_the_yaw_moment_diagram_is_found_as_far_as_the_drive_holds_the_speed():
    """Of 81 points of the jeep 30 were missing; at 6.3 deg its lightest wheel is about to spin."""
    solver, angle = solver_of("jeep"), 0.0141
    sideslip = np.radians([-8.0, -4.0, 0.0, 4.0, 8.0])
    steering = np.array([-angle, 0.0, angle])
    found = yaw_moments(solver, SPEED, sideslip=sideslip, steering=steering)
    assert (found.reasons[[0, -1]] == LARGEST_FORCE).all()
    assert (found.reasons[1:4] == "").all()
    assert np.isnan(found.lateral_acceleration[[0, -1]]).all()
    lateral = found.lateral_acceleration[1:4]
    assert lateral == pytest.approx(-lateral[::-1, ::-1], abs=0.12)  # the load lies aside
    assert found.notes() == [
        "6 of 15 points have no balance, from 8 deg of side-slip on: the speed is not held, one "
        "wheel reaches its largest force along and then locks or spins"
    ]
