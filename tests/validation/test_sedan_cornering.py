"""The sedan's steady cornering and steering response against hand calculation and each other."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from vehicledyn.analyses.handling.circle import constant_radius, constant_speed, constant_steering
from vehicledyn.analyses.handling.cornering_modes import CorneringModes
from vehicledyn.analyses.handling.steady_turn import SteadyTurn, solver_for
from vehicledyn.analyses.handling.test_run import drive
from vehicledyn.analyses.handling.tested_car import CONTROL, TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.interface.targets import read_target
from vehicledyn.road.manoeuvres import frequency_test
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.kinds.pulse_steer import PulseSteer
from vehicledyn.road.manoeuvres.kinds.swept_sine import SweptSine
from vehicledyn.road.standards.frequency_response import transient_response

pytestmark = [pytest.mark.long, pytest.mark.validation]

SPEED = 80.0 / 3.6
GRAVITY = 9.81
WHEELBASE = 2.776
FREQUENCIES = np.array(frequency_test.FREQUENCIES)
LOAD, FRONT, REAR = 4000.0, 60e3, 70e3
LINEAR = f"""\
title: The sedan on linear tyres, on longer springs that set its wheels parallel
model: sedan
parameters:
  driveline: {{clutch: {{torque: 0 N*m}}}}
  front_axle: {{spring: {{free_length: 526.3 mm}}}}
  rear_axle: {{spring: {{free_length: 525.7 mm}}}}
tyres:
  front: {{kind: linear, nominal_load: {LOAD} N, longitudinal_stiffness: 60 kN,
    cornering_stiffness: {FRONT} N/rad, friction: 1}}
  rear: {{kind: linear, nominal_load: {LOAD} N, longitudinal_stiffness: 60 kN,
    cornering_stiffness: {REAR} N/rad, friction: 1}}
wheel_spin: free
road: {{kind: flat}}
speed: {SPEED} m/s
duration: 1 s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 10 ms}}
manoeuvre: {{kind: straight}}
"""


def solver_of(target):
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(read_target(target), backend="auto", progress=lambda *_: None, test=test)
    return solver_for(car)


@pytest.fixture(scope="module")
def sedan() -> SteadyTurn:
    return solver_of("sedan")


@pytest.fixture(scope="module")
def linear_sedan(tmp_path_factory) -> SteadyTurn:
    path = tmp_path_factory.mktemp("linear") / "linear.yaml"
    path.write_text(LINEAR)
    return solver_of(path)


def heading(outputs: dict[str, float], name: str, side: float) -> float:
    """Return the heading of a wheel on the ground [rad] by its angles in the leaning chassis."""
    toe, camber = (outputs[f"{name}_wheel_angles.{n}"] for n in ("toe_angle", "camber"))
    axis = np.array([side * np.sin(toe), np.cos(toe), -side * np.sin(camber)])
    pitch, roll = outputs["chassis.pitch"], outputs["chassis.roll"]
    turned = Rotation.from_euler("YX", [pitch, roll]).apply(axis)
    return float(np.arctan2(-turned[0], turned[1]))


def axle(outputs: dict[str, float], name: str) -> float:
    """Return the steer angle of an axle to the left, the mean of its wheels by load [rad]."""
    loads = [outputs[f"{name}.wheel_{side}.tyre.normal_force"] for side in ("left", "right")]
    steer = [
        heading(outputs, f"{name}.{side}", sign) for side, sign in (("left", 1), ("right", -1))
    ]
    return float(np.dot(loads, steer) / sum(loads))


def understeer_by_hand(outputs: dict[str, float], lateral: float) -> float:
    """Return K of the single-track model by the cornering compliances of both axles [rad s²/m].

    An axle of load W carries (W/g) a_y = (C/F_0) Σ F_z (δ_i - β), as stiffness is proportional to
    load; its steer δ is that of the loaded wheels, with toe and roll steer, and the velocities of
    the axles differ by β_f - β_r = L κ. Wheels that pull against each other by toe would also turn
    the car, which this leaves out. Bundorf, Leffert (1976), SAE paper 760713.
    """
    front, rear = axle(outputs, "front_axle"), axle(outputs, "rear_axle")
    compliance = LOAD / GRAVITY * (1.0 / FRONT - 1.0 / REAR)
    nominal = outputs["steering_angle.angle"] * 8e-3 * 7.353
    return compliance + (nominal - front + rear) / lateral


def test_the_sedan_is_the_single_track_model_of_its_cornering_stiffness(linear_sedan):
    """Understeer gradient at 0.1 m/s² and yaw-rate gain of the linearised car."""
    straight = linear_sedan.straight(SPEED)
    at_rest = linear_sedan.car.outputs(straight)
    for name in ("front_axle", "rear_axle"):
        assert abs(at_rest[f"{name}.left_wheel_angles.toe_angle"]) < 3e-4
    turn = linear_sedan.find(TurnDemand(SPEED, "lateral_acceleration", 0.1), straight)
    outputs = linear_sedan.car.outputs(turn)
    by_hand = understeer_by_hand(outputs, 0.1)
    assert outputs["steering_angle.understeer_angle"] / 0.1 == pytest.approx(by_hand, rel=0.01)
    linear = CorneringModes(linear_sedan).about(straight, held_speed=True)
    gain = linear.response("body.yaw_rate", np.array([1e-3]))[0].real
    ratio = linear_sedan.car.steering_ratio
    expected = SPEED / (WHEELBASE + by_hand * SPEED**2) / ratio
    assert gain == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("torque", [100.0, 0.0])
def test_the_three_methods_of_the_circle_agree_on_the_gradient(sedan, torque):
    """With friction in its differential the car is another one below breakaway, at 1.2 m/s²."""
    parameters = sedan.car.standing.parameters
    parameters[sedan.car.place("driveline.clutch.torque")] = torque
    curves = [
        constant_speed(sedan, SPEED, last=4.0),
        constant_radius(sedan, 100.0, last=4.0),
        constant_steering(sedan, 0.47, last=4.0),
    ]
    found = [curve.gradient("understeer_angle", 4.0, first=2.0) for curve in curves]
    assert max(found) / min(found) < 1.02


def test_swept_sine_pulse_and_linear_response_agree(sedan):
    straight = sedan.straight(SPEED)
    linear = CorneringModes(sedan).about(straight, held_speed=True)
    exact = linear.response("body.yaw_rate", FREQUENCIES)
    control = sedan.car.control
    tests = (
        (SweptSine(speed_control=control, amplitude=0.03, sweep_time=20.0), 24.0),
        (PulseSteer(speed_control=control, amplitude=0.06), 5.0),
    )
    found = []
    for test, duration in tests:
        signals = drive(sedan.car, test, straight, duration).signals
        rate = signals.yaw_rate - signals.yaw_rate[0]
        found.append(
            transient_response(signals.time, signals.steering, rate, frequencies=FREQUENCIES)
        )
    assert FREQUENCIES[0] <= 0.2
    assert FREQUENCIES[-1] >= 2.0
    for response in found:
        assert np.abs(response.response / exact - 1.0).max() < 0.03
    assert np.abs(found[0].response / found[1].response - 1.0).max() < 0.03
