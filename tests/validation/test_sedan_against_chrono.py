"""The sedan against a step steer of Chrono::Vehicle with the same parameters and tyre rules.

What differs by rule: half shafts with gyroscopic moments (Chrono's turn without), links of
finite stiffness in the driveline (Chrono's are rigid and its differential locked), RK4 in place
of HHT.
"""

import math

import numpy as np
import pytest
from chrono_cars import ROOT, STEP_TIME, recorded, rise_time

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

BEGIN, LAST = 2.5, 6.0
STEER = 0.05 * math.radians(15.5) * 0.3
"""Input times the largest angle of Chrono's pinion times its radius [m]."""
SCENARIO = f"""
title: Step steer of the sedan
model: {ROOT / "systems" / "sedan.yaml"}
contact: lowest_point
tyres: {{file: passenger_245_40R18_pac2002.tir, convention: chrono_vehicle}}
road: {{kind: flat}}
wheel_spin: free
speed: 22.2222 m/s
start: static
parameters:
  driveline:
    clutch: {{torque: 5 kN*m, stiffness: 200 kN*m/rad, damping: 100 N*m*s/rad}}
    shaft: {{stiffness: 100 kN*m/rad, damping: 100 N*m*s/rad}}
manoeuvre: {{kind: chrono_step, rack: {-STEER}, gain: 10000 N*s/m, begin: {BEGIN} s}}
duration: {LAST} s
solver: {{kind: rk4, step: 0.5 ms}}
output: {{interval: 10 ms, animation: false}}
"""
WHEELS = {
    "FL": ("front_axle", "left"),
    "FR": ("front_axle", "right"),
    "RL": ("rear_axle", "left"),
    "RR": ("rear_axle", "right"),
}


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    theirs = recorded("sedan_pac02_step")
    path = tmp_path_factory.mktemp("sedan") / "step.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    return vd.simulate(path), theirs


def _ours(result, channel, time):
    return float(np.interp(time, result.time, np.asarray(result[channel])))


def _straight(theirs, column):
    """Return the mean before the step: the recorded loads still tremble by some newtons."""
    return float(theirs[column][theirs["t"] <= STEP_TIME].mean())


@pytest.mark.parametrize("wheel", WHEELS)
def test_straight_ahead(runs, wheel):
    ours, theirs = runs
    axle, side = WHEELS[wheel]
    load = _ours(ours, f"{axle}.wheel_{side}.tyre.normal_force", BEGIN)
    assert load == pytest.approx(_straight(theirs, f"Fz_{wheel}"), rel=5e-3)
    steer = _ours(ours, f"{axle}.{side}_wheel_angles.steer_angle", BEGIN)
    assert steer == pytest.approx(_straight(theirs, f"steer_{wheel}"), abs=1e-3)
    camber = _ours(ours, f"{axle}.wheel_{side}.tyre.camber", BEGIN)
    assert camber == pytest.approx(_straight(theirs, f"camber_{wheel}"), abs=1e-3)


def test_steady_cornering(runs):
    ours, theirs = runs
    assert _ours(ours, "chassis.yaw_rate", LAST) == pytest.approx(theirs["r"][-1], rel=1e-2)
    assert _ours(ours, "chassis.roll", LAST) == pytest.approx(theirs["roll"][-1], rel=2e-2)
    for wheel, (axle, side) in WHEELS.items():
        load = _ours(ours, f"{axle}.wheel_{side}.tyre.normal_force", LAST)
        assert load == pytest.approx(theirs[f"Fz_{wheel}"][-1], rel=1e-2), wheel


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_response_time(runs, share):
    ours, theirs = runs
    found = rise_time(ours.time, np.asarray(ours["chassis.yaw_rate"]), share) - BEGIN
    wanted = rise_time(theirs["t"], theirs["r"], share) - STEP_TIME
    assert found == pytest.approx(wanted, abs=10e-3)


def test_the_yaw_rate_all_along(runs):
    ours, theirs = runs
    later = theirs["t"] - STEP_TIME + BEGIN
    inside = (later >= BEGIN) & (later <= LAST)
    found = np.interp(later[inside], ours.time, np.asarray(ours["chassis.yaw_rate"]))
    assert np.abs(found - theirs["r"][inside]).max() < 0.015 * theirs["r"].max()
