"""A measured car brakes with anti-lock: speed and stopping distance of a BMW M8.

Masses are published; tyres and brakes are estimated. One number is fitted, the friction: 1.20. The
brake torque on the bus reaches 16 kN m, some 60 % more than such a car's mass and measured
deceleration need, so it is taken for what the driver asks for; the pedal follows its first 0.75 s
by a straight line. The engine's drag is left out.
"""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

DATA = Path(__file__).parent / "data"
BRAKING = """
title: A BMW M8 brakes
model: {model}
road: {{kind: flat}}
tyres: {{kind: linear, nominal_load: 5 kN, longitudinal_stiffness: 110 kN,
  cornering_stiffness: 90 kN/rad, friction: 1.2}}
wheel_spin: free
speed: {speed} m/s
start: static
manoeuvre: {{kind: straight_braking, torque: 15700 N*m, brake_at: 0.01 s, build_up: 0.75 s}}
duration: 1.95 s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 10 ms, animation: false}}
"""


def test_speed_and_stopping_distance(tmp_path):
    time, speed = np.loadtxt(DATA / "bmw_m8_braking.csv", delimiter=",", skiprows=4, unpack=True)
    path = tmp_path / "braking.yaml"
    numbers = {"model": DATA / "bmw_m8.yaml", "speed": speed[0]}
    path.write_text(BRAKING.format(**numbers), encoding="utf-8")
    result = vd.simulate(path)
    found = np.asarray(result["car.chassis.x_rate"])
    moving = speed > 0.0
    apart = np.interp(time, result.time, found) - speed
    assert np.abs(apart[moving]).max() < 0.02 * speed[0]
    measured = np.trapezoid(speed[moving], time[moving])
    place = np.asarray(result["car.chassis.x"])
    assert place.max() - place[0] == pytest.approx(measured, rel=0.03)
