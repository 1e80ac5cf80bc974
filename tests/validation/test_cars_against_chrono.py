"""The sedan and the off-road truck against step steers of Chrono::Vehicle.

Parameters and tyre rules are the same. What differs by rule: half shafts and propeller shaft with
gyroscopic moments (Chrono's turn without), a driveline of finite stiffness (Chrono's is rigid and
its differential locked), RK4 in place of HHT, and moments of inertia of the arms in the axes of
the car. Half as much again as the numbers wanted is what the truck's steady yaw rate and the load
of its inner rear wheel reach (1.4 %): the recorded forces leave a yaw moment of some 76 N m over.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from chrono_cars import ROOT, STEP_TIME, recorded, rise_time

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

BEGIN = 2.5


@dataclass(frozen=True)
class Car:
    """A car, its run and how it is steered [m], and the shares that it comes near to."""

    system: str
    run: str
    tyres: str
    speed: float
    steer: float
    gain: float
    last: float
    yaw: float = 1e-2
    load: float = 1e-2


CARS = {
    "sedan": Car(
        "sedan",
        "sedan_pac02_step",
        "passenger_245_40R18_pac2002",
        22.2222,
        -0.05 * math.radians(15.5) * 0.3,
        1e4,
        6.0,
    ),
    "truck": Car(
        "off_road_truck",
        "hmmwv_pac02_step",
        "off_road_37x12R16_pac2002",
        16.6667,
        -0.1 * math.radians(30.0) * 0.129,
        2e4,
        7.5,
        yaw=1.5e-2,
        load=1.5e-2,
    ),
}
SCENARIO = """
title: Step steer
model: {model}
contact: lowest_point
tyres: {{file: {tyres}.tir, convention: chrono_vehicle}}
road: {{kind: flat}}
wheel_spin: free
speed: {speed} m/s
start: static
parameters:
  driveline:
    clutch: {{torque: 5 kN*m, stiffness: 200 kN*m/rad, damping: 100 N*m*s/rad}}
    shaft: {{stiffness: 100 kN*m/rad, damping: 100 N*m*s/rad}}
manoeuvre: {{kind: chrono_step, rack: {steer} m, gain: {gain} N*s/m, begin: {begin} s}}
duration: {last} s
solver: {{kind: rk4, step: 0.5 ms}}
output: {{interval: 10 ms, animation: false}}
"""
WHEELS = {
    "FL": ("front_axle", "left"),
    "FR": ("front_axle", "right"),
    "RL": ("rear_axle", "left"),
    "RR": ("rear_axle", "right"),
}


@pytest.fixture(scope="module", params=CARS)
def runs(request, tmp_path_factory):
    car = CARS[request.param]
    theirs = recorded(car.run)
    path = tmp_path_factory.mktemp(request.param) / "step.yaml"
    model = ROOT / "systems" / f"{car.system}.yaml"
    numbers = {"model": model, "begin": BEGIN, **vars(car)}
    path.write_text(SCENARIO.format(**numbers), encoding="utf-8")
    return car, vd.simulate(path), theirs


def _ours(result, channel, time):
    return float(np.interp(time, result.time, np.asarray(result[channel])))


def _straight(theirs, column):
    """Return the mean before the step: the recorded loads still tremble by some newtons."""
    return float(theirs[column][theirs["t"] <= STEP_TIME].mean())


@pytest.mark.parametrize("wheel", WHEELS)
def test_straight_ahead(runs, wheel):
    _, ours, theirs = runs
    axle, side = WHEELS[wheel]
    load = _ours(ours, f"{axle}.wheel_{side}.tyre.normal_force", BEGIN)
    assert load == pytest.approx(_straight(theirs, f"Fz_{wheel}"), rel=5e-3)
    steer = _ours(ours, f"{axle}.{side}_wheel_angles.steer_angle", BEGIN)
    assert steer == pytest.approx(_straight(theirs, f"steer_{wheel}"), abs=1e-3)
    camber = _ours(ours, f"{axle}.wheel_{side}.tyre.camber", BEGIN)
    assert camber == pytest.approx(_straight(theirs, f"camber_{wheel}"), abs=1e-3)


def _last(car, theirs, column):
    """Return the recorded value as long after the step as the last computed one."""
    return float(np.interp(car.last - BEGIN + STEP_TIME, theirs["t"], theirs[column]))


def test_steady_cornering(runs):
    car, ours, theirs = runs
    yaw_rate = _ours(ours, "chassis.yaw_rate", car.last)
    assert yaw_rate == pytest.approx(_last(car, theirs, "r"), rel=car.yaw)
    roll = _ours(ours, "chassis.roll", car.last)
    assert roll == pytest.approx(_last(car, theirs, "roll"), rel=2e-2)
    for wheel, (axle, side) in WHEELS.items():
        load = _ours(ours, f"{axle}.wheel_{side}.tyre.normal_force", car.last)
        assert load == pytest.approx(_last(car, theirs, f"Fz_{wheel}"), rel=car.load), wheel


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_response_time(runs, share):
    _, ours, theirs = runs
    found = rise_time(ours.time, np.asarray(ours["chassis.yaw_rate"]), share) - BEGIN
    wanted = rise_time(theirs["t"], theirs["r"], share) - STEP_TIME
    assert found == pytest.approx(wanted, abs=10e-3)
