"""Measured runs: reading the record, driving by it, and starts that its speed does not disturb."""

import math
from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError
from vehicledyn.road.manoeuvres.run_record import read_record
from vehicledyn.symbolic import ops

RECORD = Path(__file__).with_name("measured_run.csv")
SCENARIO = """
title: Driven as measured
model: small_car
tyres: {kind: magic_formula_1987}
wheel_spin: free
speed: 10 m/s
MORE
duration: 0.3 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
MEASURED = "manoeuvre: {kind: measured_run, file: run.csv, towing_gain: 10 kN*s/m}"
PATH = """manoeuvre:
  kind: path
  xs: [0 m, 40 m]
  ys: [0 m, 0 m]
  distances: [0 m, 40 m]
  speeds: [12 m/s, 10 m/s]
  driver: {kind: preview, preview_time: 0.5 s, lag_frequency: 20 rad/s, lag_damping: 0.8,
    rack_stop: 50 mm}
  speed_control: {proportional_gain: 1000 N*s, integral_gain: 300 N}"""


def test_a_record_has_its_signals_in_si_and_joins_gaps():
    record = read_record(RECORD, 0.1)
    assert (record.first, record.last) == pytest.approx((-0.1, 0.2))
    assert record.value("speed", 0.15) == pytest.approx(35.75 / 3.6)
    assert record.value("yaw_rate", 0.1) == pytest.approx(math.radians(0.5))
    time = ops.symbol("t")
    angle = ops.numeric([time], ops.column([record.law("steering_wheel_angle")(time)]))
    found = [math.degrees(float(angle(t)[0, 0])) for t in (-1.0, 0.05, 0.1, 0.15, 3.0)]
    assert found == pytest.approx([0.0, 2.0, 4.0, 2.0, 0.0], abs=1e-9)
    assert record.law("road_wheel_angle")(0.1) == 0.0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time [s], speed [m/s]\n0, 1\n0.2, 1\n0.1, 1\n", "csv:4: the time 0.1 s does not grow"),
        ("time [s], speed [m/s]\n0, 1\n", "two at least"),
        ("time [s], speed [m/s]\n1, 1\n2, 1\n", "begin: 0 s lies outside of the record"),
        ("time [s], colour [1]\n0, 1\n1, 1\n", "no column but the time is known"),
        ("time [s], Speed [m/s]\n0, 1\n1, 1\n", "column 'Speed' is not .* mean 'speed'"),
        (
            "time [s], steering wheel angle [deg], speed [m/s]\n0, 1, 1\n1, 1, 1\n",
            "column 'steering wheel angle' is not known; did you mean 'steering_wheel_angle'",
        ),
        (
            "time [s], stering_wheel_angle [deg], speed [m/s]\n0, 1, 1\n1, 1, 1\n",
            "column 'stering_wheel_angle' is not known; did you mean 'steering_wheel_angle'",
        ),
        ("time [s], speed [kg]\n0, 1\n1, 1\n", "does not measure a quantity in m/s"),
        (
            "time [s], steering_wheel_angle [deg], road_wheel_angle [deg]\n0, 1, 1\n1, 1, 1\n",
            "both steer",
        ),
    ],
)
def test_a_record_that_is_none_is_refused(tmp_path, text, words):
    (tmp_path / "run.csv").write_text(text)
    with pytest.raises(InputError, match=words):
        read_record(tmp_path / "run.csv", 0.0)
    (tmp_path / "drive.yaml").write_text(SCENARIO.replace("MORE", MEASURED))
    with pytest.raises(InputError, match=words):
        vd.load(tmp_path / "drive.yaml")


def test_cells_may_be_quoted(tmp_path):
    """As R and table programs write them."""
    (tmp_path / "run.csv").write_text('"time [s]","speed [km/h]"\n0,"36"\n"1",\n2,72\n')
    assert read_record(tmp_path / "run.csv", 0.0).value("speed", 1.0) == pytest.approx(15.0)


def test_further_columns_are_passed_over(tmp_path):
    """Also those that are named much like one that is there."""
    head = "time [s], speed [m/s], speed_2 [m/s], rear_wheel_angle [deg], Yaw [deg]\n"
    (tmp_path / "run.csv").write_text(f"{head}0, 1, 2, 3, 4\n1, 1, 2, 3, 4\n")
    assert list(read_record(tmp_path / "run.csv", 0.0).curves) == ["speed"]


@pytest.mark.long
def test_a_signal_is_compared_where_it_was_measured_and_a_short_record_is_told(tmp_path):
    head = "time [s], speed [m/s], yaw_rate [rad/s]\n"
    (tmp_path / "run.csv").write_text(f"{head}0, 10,\n0.1, 10, 0.5\n0.12, 10, 0\n0.14, 10, 0\n")
    (tmp_path / "drive.yaml").write_text(SCENARIO.replace("MORE", MEASURED))
    summary = vd.simulate(tmp_path / "drive.yaml").summary
    assert summary["yaw_rate_largest_apart"].value == pytest.approx(0.5, abs=1e-6)
    assert summary["yaw_rate_rms_apart"].value == pytest.approx(
        math.sqrt((0.5**2 + 0.25**2) / 5), abs=1e-6
    )
    assert "the record ends 0.14 s after its begin" in summary["test_conditions"].value


@pytest.mark.long
def test_a_car_steers_and_brakes_as_measured_and_says_how_far_it_is_from_the_record(tmp_path):
    (tmp_path / "run.csv").write_bytes(RECORD.read_bytes())
    (tmp_path / "drive.yaml").write_text(SCENARIO.replace("MORE", MEASURED))
    run = vd.simulate(tmp_path / "drive.yaml")
    record = read_record(RECORD, 0.0)
    steering = run["steering_angle.angle"].values
    assert steering == pytest.approx(record.values("steering_wheel_angle", run.time), abs=1e-12)
    braked = run["drive.brake_torque"].values
    assert braked == pytest.approx(record.values("brake_torque", run.time), abs=1e-9)
    pulled = run["body.forward_speed"].values - record.values("speed", run.time)
    assert -run["towing.force"].values / 1e4 == pytest.approx(pulled, abs=2e-3)
    apart = run["body.yaw_rate"].values - record.values("yaw_rate", run.time)
    summary = run.summary
    assert summary["yaw_rate_rms_apart"].value == pytest.approx(np.sqrt(np.mean(apart**2)))
    assert summary["yaw_rate_largest_apart"].value == pytest.approx(np.abs(apart).max())
    assert summary["way_apart"].value == pytest.approx(np.trapezoid(pulled, run.time))
    assert "roll_angle_rms_apart" not in summary
    faster = vd.simulate(tmp_path / "drive.yaml", speed="12 m/s")
    assert "the run starts at 12 m/s, the record at 10" in faster.summary["test_conditions"].value


@pytest.mark.long
@pytest.mark.parametrize("manoeuvre", [MEASURED, PATH])
def test_a_start_at_rest_is_not_driven_by_the_speed_to_come(tmp_path, manoeuvre):
    (tmp_path / "run.csv").write_bytes(RECORD.read_bytes())
    loads = []
    for text in (manoeuvre, "manoeuvre: {kind: straight}"):
        (tmp_path / "drive.yaml").write_text(SCENARIO.replace("MORE", f"start: static\n{text}"))
        run = vd.simulate(tmp_path / "drive.yaml", duration="10 ms")
        loads.append(run["front_left.tyre.normal_force"].values[0])
    assert loads[0] == pytest.approx(loads[1], rel=1e-9)
