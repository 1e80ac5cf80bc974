"""The electric car from standstill: the work of its motor is in what moves, and in its tyres."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]

SYSTEMS = Path(__file__).parents[2] / "systems"
START = """
title: Standing start
model: {model}
road: {{kind: flat}}
wheel_spin: free
speed: 0 km/h
start: static
manoeuvre: {{kind: acceleration, torque: 300 N*m, begin: 0.2 s}}
duration: 3 s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 10 ms, animation: false}}
"""
MASS = 1850.0 + 1.889 + 4 * (1.032 + 1.611 + 1.397 + 25.803)
"""Of body, rack, arms, uprights and wheels [kg]."""
INERTIA = 4 * (1.099496 + 0.4) + 9.0**2 * 0.08 + 0.6
"""Of wheels, half shafts, rotor and cage about the wheels' axes [kg m2]."""


@pytest.mark.filterwarnings("ignore:wheels stand at the start")
def test_work_of_the_motor(tmp_path):
    path = tmp_path / "start.yaml"
    path.write_text(START.format(model=SYSTEMS / "electric_car.yaml"), encoding="utf-8")
    result = vd.simulate(path)
    torque = np.asarray(result["motor.torque"])
    shaft = np.asarray(result["car.driveline.propeller.angle_rate"])
    speed = np.asarray(result["car.chassis.x_rate"])
    assert torque[-1] == pytest.approx(300.0, rel=1e-6)
    work = np.trapezoid(torque * shaft, result.time)
    moving = 0.5 * MASS * speed[-1] ** 2 + 0.5 * INERTIA * (shaft[-1] / 9.0) ** 2
    assert moving < work < 1.05 * moving
