"""Courses against closed forms, and cars that drive them."""

from types import SimpleNamespace

import numpy as np
import pytest
from crg_files import crg

import vehicledyn
from vehicledyn.analyses.handling.circle import constant_radius
from vehicledyn.analyses.handling.steady_turn import solver_for
from vehicledyn.analyses.handling.tested_car import CONTROL, TestedCar
from vehicledyn.base.errors import InputError
from vehicledyn.interface.targets import read_target
from vehicledyn.road.courses.course import CircleCourse, course_through, largest_dip
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.kinds.path import Path

RADIUS = 60.0
DRIVER = (
    "{kind: preview, preview_time: AHEAD, understeer: 0.001 rad*s^2/m, lag_frequency: 20 rad/s, "
    "lag_damping: 0.8, rack_stop: STOP}"
)
SCENARIO = """\
title: The small car on a course
model: small_car
speed: SPEED
manoeuvre:
  kind: KIND
  driver: DRIVER
  speed_control: {proportional_gain: 1000 N*s, integral_gain: 300 N}
duration: DURATION
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
BEND = "path\n  xs: [0 m, 40 m, 80 m, 110 m]\n  ys: [0 m, 0 m, 10 m, 40 m]"
LIMIT = (
    f"constant_radius\n  radius: {RADIUS} m\n  begin: 2 s\n  acceleration: 0.4 m/s^2\n"
    "  last_speed_change: 12 m/s\n  steering_integral_gain: 0.05 rad/(m*s)"
)


def scenario(folder, **words):
    text = SCENARIO.replace("DRIVER", DRIVER)
    for word, value in (
        {"STOP": "50 mm", "AHEAD": "0.8 s", "SPEED": "15 m/s", "DURATION": "6 s"} | words
    ).items():
        text = text.replace(word, value)
    path = folder / "course.yaml"
    path.write_text(text)
    return path


def test_a_closed_course_through_points_of_a_circle_is_that_circle():
    angle = np.linspace(0.0, 2.0 * np.pi, 81)[:-1]
    x, y = RADIUS * np.sin(angle), RADIUS * (1.0 - np.cos(angle))
    course = course_through(x, y, is_closed=True)
    exact = CircleCourse(RADIUS, RADIUS)
    assert course.length == pytest.approx(exact.length, rel=1e-6)
    for station in (0.0, 17.3, 200.0, 500.0):
        assert course.place(station) == pytest.approx(exact.place(station), abs=1e-3)
        assert course.curvature(station) == pytest.approx(1.0 / RADIUS, rel=1e-3)
    turned = float(course.heading(17.3)) - float(course.heading(0.0))
    assert turned == pytest.approx(17.3 / RADIUS, abs=1e-4)


def test_an_open_course_goes_straight_on_beyond_its_ends():
    course = course_through(np.array([0.0, 10.0, 20.0, 30.0]), np.array([0.0, 0.0, 3.0, 9.0]))
    heading = float(course.heading(course.length))
    end, beyond = (np.array(course.place(course.length + s)) for s in (0.0, 5.0))
    along = 5.0 * np.array([np.cos(heading), np.sin(heading)])
    assert beyond - end == pytest.approx(along, abs=1e-3)
    assert float(course.curvature(course.length + 1.0)) == 0.0


def test_the_length_of_a_parabola_is_that_of_its_closed_form():
    x = np.linspace(0.0, 40.0, 81)
    course = course_through(x, 0.01 * x * x)
    slope = 0.02 * 40.0
    exact = (slope * np.sqrt(1.0 + slope**2) + np.arcsinh(slope)) / (2.0 * 0.02)
    assert course.length == pytest.approx(exact, rel=1e-6)
    radius, station = course.tightest()
    assert radius == pytest.approx(1.0 / 0.02, rel=1e-2)
    assert station < 1.0


def refused(folder, match, **words):
    with pytest.raises(InputError, match=match):
        vehicledyn.simulate(scenario(folder, **words))


def test_courses_that_cannot_be_driven_are_refused_by_name(tmp_path):
    refused(tmp_path, r"radius of .* m at x = .*, y = .* rack_stop", KIND=BEND, STOP="4 mm")
    aside = BEND.replace("ys: [0 m", "ys: [9 m")
    refused(tmp_path, r"begins at x = 0 m, y = 9 m .* starts at the origin", KIND=aside)
    refused(tmp_path, "needs points", KIND="path")
    refused(tmp_path, "radius other than zero", KIND=LIMIT.replace(f"{RADIUS} m", "0 m"))
    short = BEND.replace(", 40 m]", "]")
    refused(tmp_path, "3 values and 4 xs; give as many", KIND=short)
    twice = BEND.replace("40 m", "0 m", 1)
    refused(tmp_path, "point 2 is at the place of the one before", KIND=twice)
    falling = f"{BEND}\n  distances: [9 m, 1 m]\n  speeds: [9 m/s, 1 m/s]"
    refused(tmp_path, "distances: must grow", KIND=falling)


@pytest.mark.parametrize("ys", [(0.0, 0.0, 3.5, 3.5), (0.0, 0.0, 0.0, 10.0), (0.0, 5.0, 3.5, 0.0)])
def test_a_path_through_points_begins_where_the_car_stands(ys):
    """Along x at the origin, so that nobody steers before the first point asks for it."""
    path = Path.model_construct(xs=(0.0, 30.0, 60.0, 100.0), ys=ys, closed=False)
    course = path.course(SimpleNamespace())
    assert float(course.heading(0.0)) == pytest.approx(0.0, abs=1e-6)
    x, y = course.place(0.01)
    assert (float(x), float(y)) == pytest.approx((0.01, 0.0), abs=1e-5)


@pytest.mark.long
def test_a_car_keeps_a_path_and_its_speed_profile(tmp_path):
    profile = "\n  distances: [0 m, 20 m, 60 m]\n  speeds: [15 m/s, 15 m/s, 10 m/s]"
    data = vehicledyn.simulate(scenario(tmp_path, KIND=BEND + profile, AHEAD="0.5 s"))
    found = {name: entry.value for name, entry in data.summary.items()}
    assert found["largest_path_error"] < 0.25
    assert found["largest_speed_error"] < 0.8
    assert data["body.forward_speed"].values[-1] == pytest.approx(10.0, abs=0.3)
    place = np.array([data["chassis.x"].values, data["chassis.y"].values])
    points = np.array([0.0, 40.0, 80.0, 110.0]), np.array([0.0, 0.0, 10.0, 40.0])
    curve = course_through(*points, along_x=True)
    at = np.array(curve.place(data["driver.station"].values))
    error = np.hypot(*(place - at))
    assert error == pytest.approx(np.abs(data["driver.path_error"].values), abs=2e-3)


@pytest.mark.long
def test_the_limit_on_a_circle_is_that_of_steady_cornering(tmp_path):
    data = vehicledyn.simulate(scenario(tmp_path, KIND=LIMIT, SPEED="12 m/s", DURATION="29 s"))
    found = {name: entry.value for name, entry in data.summary.items()}
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(read_target("small_car"), backend="auto", progress=lambda *_: None, test=test)
    steady = constant_radius(solver_for(car), RADIUS)
    assert found["limit_lateral_acceleration"] == pytest.approx(steady.limit, rel=0.01)
    assert found["limited_by"] == "front axle"


@pytest.mark.long
def test_a_car_along_a_road_of_opencrg_keeps_its_reference_line(tmp_path):
    """The road bends with a radius of 50 m after 20 m."""
    heading = np.maximum(np.arange(0.0, 61.0) - 20.0, 0.0)[:60] / 50.0
    (tmp_path / "bend.crg").write_bytes(crg(np.zeros((61, 5)), phi=np.append(0.0, heading)))
    path = scenario(tmp_path, KIND="path", SPEED="10 m/s", DURATION="5 s", AHEAD="0.5 s")
    path.write_text(path.read_text() + "road: {kind: opencrg, file: bend.crg}\n")
    data = vehicledyn.simulate(path)
    error = np.abs(data["driver.path_error"].values)
    assert error.max() < 0.25
    assert data["chassis.yaw"].values[-1] == pytest.approx((50.0 - 20.0) / 50.0, abs=0.05)


def test_the_dip_of_a_spline_before_a_bend_is_found():
    x, y = np.array([0.0, 40.0, 80.0, 110.0]), np.array([0.0, 0.0, 10.0, 40.0])
    fine = np.linspace(0.0, 40.0, 401)
    course = course_through(x, y, along_x=True)
    lowest = min(course.y.value(fine))
    dip, after = largest_dip(x, y, along_x=True)
    assert (dip, after) == (pytest.approx(-lowest, rel=2e-3), 0)
    assert dip > 0.3
    angles = np.linspace(0.0, 2.0 * np.pi, 9)[:-1]
    assert largest_dip(RADIUS * np.cos(angles), RADIUS * np.sin(angles), is_closed=True)[0] == 0.0
    near = np.concatenate([[0.0, 20.0, 38.0], x[1:]]), np.concatenate([np.zeros(3), y[1:]])
    assert largest_dip(*near, along_x=True)[0] < 0.1 * dip
