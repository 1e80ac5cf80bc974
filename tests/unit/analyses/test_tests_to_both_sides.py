"""Tests to both sides and at growing speeds, with drives that are made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from vehicledyn.analyses.handling import lane_changes
from vehicledyn.analyses.handling import tip_up_search as search
from vehicledyn.analyses.handling.dwell_series import dwell_series
from vehicledyn.road.manoeuvres.speed_control import SpeedControl

CONTROL = SpeedControl(proportional_gain=300.0, integral_gain=10.0)
TIME = np.linspace(0.0, 5.0, 501)
CAR = SimpleNamespace(has_steering_wheel=False, mass=1500.0, mass_ahead=0.0)


def dwelling(limit):
    """Return a drive whose car turns on, first to the right, from an amplitude on."""

    def drive(words, test):
        amplitude = test.amplitude
        way = np.sign(amplitude)
        left = 0.0 if amplitude > -limit else 0.6
        rate = way * np.interp(TIME, [0.0, 0.4, 1.2, 2.0, 5.0], [0.0, 1.0, -1.0, -left, -left])
        signals = SimpleNamespace(
            time=TIME, yaw_rate=rate, y=amplitude * TIME**2, yaw=np.zeros_like(TIME)
        )
        return SimpleNamespace(signals=signals, ended_by="", test=test, words=words)

    return drive


def test_a_sine_with_dwell_fails_by_the_side_that_fails():
    run, figures, notes = dwell_series(CAR, 1.0, control=CONTROL, drive=dwelling(3.2))
    found = {figure.name: figure.value for figure in figures}
    assert not found["passed"]
    assert found["passed_left"]
    assert not found["passed_right"]
    assert found["last_amplitude_left"] == pytest.approx(6.5)
    assert found["last_amplitude_right"] == pytest.approx(3.5)
    assert run.test.amplitude == pytest.approx(-3.5)
    assert found["first_yaw_rate_ratio"] == pytest.approx(0.6, rel=1e-9)
    assert not notes


def test_a_car_that_tips_up_to_one_side_tips_up(monkeypatch):
    def judged(car, name, run):
        side, speed = run
        return [], side == "right" and speed > 17.3

    monkeypatch.setattr(search, "_judged", judged)
    run, figures = search.tip_up_search(
        CAR, "j_turn", lambda speed: iter([("left", speed), ("right", speed)]), (15.0, 18.0, 20.0)
    )
    found = {figure.name: figure.value for figure in figures}
    assert found["tips_up"]
    assert found["safe_speed"] <= 17.3 < found["tip_up_speed"] <= 1.01 * found["safe_speed"] + 1e-9
    assert run == ("right", found["tip_up_speed"])


@pytest.mark.parametrize(("best", "shown"), [(60.0, 60.0), (0.0, 50.0)])
def test_a_lane_change_that_ends_in_standstill_is_no_failure(monkeypatch, best, shown):
    """At 40 and 45 km/h the car stands before the end; from there on it passes up to a speed."""

    def drive(tests, car, test, speed):
        return SimpleNamespace(speed=3.6 * speed, ended_by="")

    def figures(car, name, run):
        passes = run.speed <= best + 0.1
        return [] if run.speed < 49.0 else [SimpleNamespace(name="passed", value=float(passes))]

    monkeypatch.setattr(lane_changes, "_drive", drive)
    monkeypatch.setattr(lane_changes, "figures_of", figures)
    monkeypatch.setattr(lane_changes, "_unfinished", lambda car, run: "it stands")
    monkeypatch.setattr(lane_changes, "sheet_of", lambda run: run.speed)
    tests = SimpleNamespace(figures=[], sheets={}, notes=[])
    lane_changes._until_left(tests, CAR, "obstacle_avoidance", lambda speed: None)
    assert tests.sheets["obstacle_avoidance"] == pytest.approx(shown)
    assert [words.split(":")[0][-7:] for words in tests.notes] == ["40 km/h", "45 km/h"]
    largest = [3.6 * f.value for f in tests.figures if f.name == "largest_speed"]
    assert largest == (pytest.approx([best]) if best else [])
