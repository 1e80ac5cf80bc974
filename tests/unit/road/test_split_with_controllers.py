"""Braking on split friction with anti-lock and yaw control: the car stops straight."""

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = pytest.mark.long

SCENARIO = """\
title: The controlled sedan brakes with its right side slippery, and the driver steers
model: controlled_sedan
tyres: {file: passenger_245_40R18_pac2002.tir}
speed: 80 km/h
wheel_spin: free
manoeuvre:
  kind: split_braking
  torque: 8 kN*m
  driver: {kind: preview, preview_time: 0.5 s, lag_frequency: 20 rad/s, lag_damping: 0.8,
    rack_stop: 60 mm}
  speed_control: {proportional_gain: 3000 N*s, integral_gain: 600 N}
duration: 6 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


def test_controllers_keep_the_car_straight(tmp_path):
    path = tmp_path / "split.yaml"
    path.write_text(SCENARIO)
    run = vd.simulate(path)
    kept = run.summary
    assert kept["largest_lateral_deviation"].value < 1.0
    along, across, yaw = (run[f"car.chassis.{n}"].values for n in ("x_rate", "y_rate", "yaw"))
    aside = np.abs(np.arctan2(across, along) - yaw)
    assert aside[np.hypot(along, across) > 5.0].max() < 0.06
    assert kept["largest_sideslip_angle"].value < 0.12  # at walking pace
    assert kept["stopping_distance"].value == pytest.approx(46.1, rel=0.01)
    alone = vd.load(path).changed({"parameters.brakes.yaw_control.active": 0})
    assert vd.simulate(alone).summary["largest_sideslip_angle"].value > 1.0
