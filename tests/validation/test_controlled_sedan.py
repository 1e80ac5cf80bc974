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
parameters: {{brakes: {{anti_lock: {{active: 1}}, yaw_control: {{active: 0}}}}}}
duration: {duration} s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 10 ms, animation: false}}
"""
BRAKING = "manoeuvre: {kind: straight_braking, torque: 8 kN*m}\n"
DWELL = "manoeuvre: {kind: sine_with_dwell, amplitude: -37.7 mm, begin: 0.3 s}\n"
"""By 270 degrees of the steering wheel, the largest amplitude that FMVSS 126 asks for (S7.9)."""


ANTI_LOCK, YAW_CONTROL = (
    f"parameters.brakes.{name}.active" for name in ("anti_lock", "yaw_control")
)
SPEED, FRONT = "car.chassis.x_rate", "car.front_axle.left_wheel.spin_rate"


@pytest.fixture
def drive(tmp_path):
    """Return a function that drives without and with a controller and returns both results."""

    def run(manoeuvre, controller, *, speed=100, duration=4.0, right=1.0):
        path = tmp_path / "run.yaml"
        head = HEAD.format(model=MODEL, right=right, duration=duration, speed=speed)
        path.write_text(head + manoeuvre, encoding="utf-8")
        return vd.sweep(
            path, vary={controller: [0, 1]}, channels=[SPEED, FRONT], workers=1, lanes=1
        )

    return run


def test_anti_lock_keeps_the_wheels_turning(drive):
    """A wheel counts as locked below a tenth of rolling, while the car is faster than 3 m/s."""
    result = drive(BRAKING, ANTI_LOCK)
    shares = []
    for case in range(2):
        forward, turning = (result[name].values[case] for name in (SPEED, FRONT))
        fast = (forward > 3.0) & (result.time > 1.0)
        slip = 1.0 - 0.344 * turning[fast] / forward[fast]
        shares.append(float(np.mean(slip > 0.9)))
        speed, way = (result[name].values[case] for name in ("initial_speed", "stopping_distance"))
        assert 9.0 < speed**2 / (2.0 * way) < 1.1 * 9.81
    assert shares[0] > 0.9
    assert shares[1] == 0.0


def test_sine_with_dwell_passes_with_yaw_control_alone(drive):
    """FMVSS 126, S5.2: 35 % after 1 s, 20 % after 1.75 s, 1.83 m after 1.07 s."""
    result = drive(DWELL, YAW_CONTROL, speed=80, duration=4.3)
    first, second, displacement = (
        result[name].values
        for name in ("first_yaw_rate_ratio", "second_yaw_rate_ratio", "lateral_displacement")
    )
    assert first[0] > 0.35 >= first[1]
    assert second[1] <= 0.20
    assert displacement[1] >= 1.83


def test_braking_on_split_friction_turns_the_car_without_yaw_control(drive):
    result = drive(BRAKING, YAW_CONTROL, duration=4.0, right=0.3)
    turned = np.abs(result["heading_change"].values)
    assert turned[0] > np.pi
    assert turned[1] < np.radians(45.0)
