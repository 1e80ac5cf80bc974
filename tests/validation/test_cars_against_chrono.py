"""The sedan and the off-road truck against step steers of Chrono::Vehicle.

Parameters and tyre rules are the same. What differs by rule: the driveline is of finite stiffness
and its shafts have gyroscopic moments (Chrono's is rigid, and its differential locked), RK4 in
place of HHT, moments of inertia of the arms in the axes of the car, and Chrono's contact frames,
of which two axes have the length cos γ, so that it applies a load of F_z less 2 F_z (1 - cos γ)/(1
+ cos ψ) to a wheel that heads for ψ: some 0.1 % of the truck's loads. Its idler arm turns the
truck's chassis from outside, by 44 N m about z in the turn; without that torque the truck's yaw
rate is 1.3 % and the load of its inner rear wheel 1.1 % beside, and it runs straight when not
steered, as Chrono's does not.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from chrono_cars import IDLER_TORQUE, ROOT, STEP_TIME, idler_torque, recorded, rise_time

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

BEGIN = 2.5


@dataclass(frozen=True)
class Car:
    """A car, its run and how it is steered [m]; whether its idler arm turns it."""

    system: str
    run: str
    tyres: str
    speed: float
    steer: float
    gain: float
    last: float
    idler: bool = False


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
        idler=True,
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
manoeuvre:
  kind: chrono_step
  rack: {steer} m
  gain: {gain} N*s/m
  begin: {begin} s
  idler: {idler}
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
    if car.idler:
        model = _with_rods_measured(model, path.with_name("truck.yaml"))
    numbers = {"model": model, "begin": BEGIN, **vars(car)}
    path.write_text(SCENARIO.format(**numbers), encoding="utf-8")
    return car, vd.simulate(path), theirs


def _with_rods_measured(model, path):
    """Return a copy of the truck that shows the forces of the track rods on the steering link."""
    text = model.read_text(encoding="utf-8").replace("file: ", f"file: {model.parent}/")
    rods = (
        f"  {side}_rod: {{kind: constraint_force, constraint: front_axle.{side}_track_rod, "
        "body: front_axle.rack, axes: body}\n"
        for side in ("left", "right")
    )
    path.write_text(f"{text}sensors:\n{''.join(rods)}", encoding="utf-8")
    return path


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
    assert yaw_rate == pytest.approx(_last(car, theirs, "r"), rel=1e-2)
    roll = _ours(ours, "chassis.roll", car.last)
    assert roll == pytest.approx(_last(car, theirs, "roll"), rel=2e-2)
    for wheel, (axle, side) in WHEELS.items():
        load = _ours(ours, f"{axle}.wheel_{side}.tyre.normal_force", car.last)
        assert load == pytest.approx(_last(car, theirs, f"Fz_{wheel}"), rel=1e-2), wheel


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_response_time(runs, share):
    _, ours, theirs = runs
    found = rise_time(ours.time, np.asarray(ours["chassis.yaw_rate"]), share) - BEGIN
    wanted = rise_time(theirs["t"], theirs["r"], share) - STEP_TIME
    assert found == pytest.approx(wanted, abs=10e-3)


def test_the_torque_of_the_idler_arm_is_that_of_its_joint(runs):
    """The torques that the truck is given follow from the forces that it then finds."""
    car, ours, _ = runs
    if not car.idler:
        pytest.skip("a rack has no idler arm")
    before = BEGIN - 0.1  # at BEGIN itself the arm is already accelerated
    for time, name in ((before, "straight"), (car.last, "turned")):
        found = idler_torque(lambda channel, time=time: _ours(ours, channel, time))
        assert found == pytest.approx(IDLER_TORQUE[name], abs=0.2)
    yaw_rate = _ours(ours, "chassis.yaw_rate", BEGIN)
    assert yaw_rate == pytest.approx(_straight(runs[2], "r"), rel=2e-2)
