"""The sedan's brakes and controllers in the standards' manoeuvres, each with and without."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

MODEL = Path(__file__).parents[2] / "systems" / "controlled_sedan.yaml"
HEAD = """
title: Controlled sedan
model: {model}
road: {{kind: flat, patches: [{{kind: rectangle, friction: {right}, left: 0 m}}]}}
wheel_spin: free
speed: {speed} km/h
start: static
parameters: {{brakes: {{anti_lock: {{active: {anti_lock}}}, yaw_control: {{active: {yaw}}}}}}}
duration: {duration} s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 10 ms, animation: false}}
"""
BRAKING = "manoeuvre: {kind: straight_braking, torque: 8 kN*m}\n"
DWELL = "manoeuvre: {kind: sine_with_dwell, amplitude: -20 mm, begin: 0.3 s}\n"


@pytest.fixture(scope="module")
def drive(tmp_path_factory):
    """Return a function that drives and returns summary and result."""
    folder = tmp_path_factory.mktemp("controlled")

    def run(manoeuvre, *, anti_lock, yaw, speed=100, duration=4.0, right=1.0):
        path = folder / "run.yaml"
        numbers = {"anti_lock": int(anti_lock), "yaw": int(yaw), "speed": speed}
        head = HEAD.format(model=MODEL, right=right, duration=duration, **numbers)
        path.write_text(head + manoeuvre, encoding="utf-8")
        result = vd.simulate(path)
        return {name: entry.value for name, entry in result.summary.items()}, result

    return run


def _speeds(result):
    return np.asarray(result["car.chassis.x_rate"])


def _front(result):
    return np.asarray(result["car.front_axle.left_wheel.spin_rate"])


def test_anti_lock_keeps_the_wheels_turning(drive):
    """A wheel counts as locked below a tenth of rolling, while the car is faster than 3 m/s."""
    shares = []
    for anti_lock in (False, True):
        summary, result = drive(BRAKING, anti_lock=anti_lock, yaw=False)
        fast = (_speeds(result) > 3.0) & (result.time > 1.0)
        slip = 1.0 - 0.344 * _front(result)[fast] / _speeds(result)[fast]
        shares.append(float(np.mean(slip > 0.9)))
        speed, way = summary["initial_speed"], summary["stopping_distance"]
        assert 9.0 < speed**2 / (2.0 * way) < 1.1 * 9.81
    assert shares[0] > 0.9
    assert shares[1] == 0.0


def test_sine_with_dwell_passes_with_yaw_control_alone(drive):
    """FMVSS 126, S5.2: 35 % after 1 s, 20 % after 1.75 s, 1.83 m after 1.07 s."""
    numbers = {"anti_lock": True, "speed": 80, "duration": 4.3}
    without, _ = drive(DWELL, yaw=False, **numbers)
    assert without["first_yaw_rate_ratio"] > 0.35
    assert without["second_yaw_rate_ratio"] > 0.20
    with_control, _ = drive(DWELL, yaw=True, **numbers)
    assert with_control["first_yaw_rate_ratio"] <= 0.35
    assert with_control["second_yaw_rate_ratio"] <= 0.20
    assert with_control["lateral_displacement"] >= 1.83


def test_braking_on_split_friction_turns_the_car_without_yaw_control(drive):
    turned = []
    for yaw in (False, True):
        summary, _ = drive(BRAKING, anti_lock=True, yaw=yaw, duration=4.0, right=0.3)
        turned.append(abs(summary["heading_change"]))
    assert turned[0] > np.pi
    assert turned[1] < np.radians(45.0)
