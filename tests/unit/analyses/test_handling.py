"""Steady cornering and driving tests against closed forms, each other and the linear analyses."""

import numpy as np
import pytest

import vehicledyn
from vehicledyn.analyses.handling.circle import constant_radius, constant_speed, constant_steering
from vehicledyn.analyses.handling.cornering_modes import CorneringModes
from vehicledyn.analyses.handling.equal_curvature import gradients_on_circle
from vehicledyn.analyses.handling.standard_tests import StandardTests
from vehicledyn.analyses.handling.steady_turn import POWER_SLIDE, SteadyTurn, solver_for
from vehicledyn.analyses.handling.test_run import drive, figures_of
from vehicledyn.analyses.handling.tested_car import CONTROL, TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.analyses.handling.yaw_moment import yaw_moments
from vehicledyn.analyses.preparation.build_model import build_tested
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.interface.targets import read_target
from vehicledyn.road.manoeuvres import frequency_test
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.kinds.braking.split_braking import SplitBraking
from vehicledyn.road.manoeuvres.kinds.braking.straight_braking import StraightBraking
from vehicledyn.road.manoeuvres.kinds.fishhook import Fishhook
from vehicledyn.road.manoeuvres.kinds.pulse_steer import PulseSteer
from vehicledyn.road.manoeuvres.kinds.step_steer import StepSteer
from vehicledyn.road.manoeuvres.kinds.swept_sine import SweptSine
from vehicledyn.road.standards.frequency_response import transient_response

pytestmark = pytest.mark.long

SPEED = 25.0
FREQUENCIES = np.array(frequency_test.FREQUENCIES)
GRAVITY = 9.81
LOAD, FRONT, REAR = 2500.0, 30e3, 42e3
LINEAR = f"""\
title: A small car on linear tyres
model: small_car
tyres:
  front: {{kind: linear, nominal_load: {LOAD} N, longitudinal_stiffness: 60 kN,
    cornering_stiffness: {FRONT} N/rad, friction: 1}}
  rear: {{kind: linear, nominal_load: {LOAD} N, longitudinal_stiffness: 60 kN,
    cornering_stiffness: {REAR} N/rad, friction: 1}}
wheel_spin: free
road: {{kind: flat}}
speed: {SPEED} m/s
duration: 1 s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 10 ms}}
manoeuvre: {{kind: straight}}
"""


def solver_of(target):
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(read_target(target), backend="auto", progress=lambda *_: None, test=test)
    return solver_for(car)


@pytest.fixture(scope="module")
def small_car() -> SteadyTurn:
    return solver_of("small_car")


@pytest.fixture(scope="module")
def linear_car(tmp_path_factory) -> SteadyTurn:
    path = tmp_path_factory.mktemp("linear") / "linear.yaml"
    path.write_text(LINEAR)
    return solver_of(path)


def test_understeer_of_linear_tyres_is_that_of_the_single_track_model(linear_car):
    """K = F_0/g (1/C_front - 1/C_rear), as stiffness is proportional to load."""
    by_hand = LOAD / GRAVITY * (1.0 / FRONT - 1.0 / REAR)
    points = [
        linear_car.find(
            TurnDemand(SPEED, "lateral_acceleration", lateral), linear_car.straight(SPEED)
        )
        for lateral in (0.05, 0.1)
    ]
    angles = [linear_car.car.outputs(p)["steering_angle.understeer_angle"] for p in points]
    assert angles[1] / 0.1 == pytest.approx(by_hand, rel=0.01)
    assert (angles[1] - angles[0]) / 0.05 == pytest.approx(by_hand, rel=0.01)


def test_the_three_methods_of_the_circle_agree_on_the_gradient(small_car):
    curves = [
        constant_speed(small_car, 22.0, last=4.0),
        constant_radius(small_car, 100.0, last=4.0),
        constant_steering(small_car, 0.024, last=4.0),
    ]
    for first in (0.25, 2.0):
        found = [curve.gradient("understeer_angle", 4.0, first=first) for curve in curves]
        assert max(found) / min(found) < 1.02


def test_at_one_curvature_the_three_methods_have_one_gradient(small_car):
    circle = constant_radius(small_car, 30.0, last=4.2)
    found = gradients_on_circle(small_car, circle, 30.0, first=2.0, last=4.0)
    assert len(found) == 3
    by_line = circle.gradient("understeer_angle", 4.0, first=2.0)
    assert list(found.values()) == pytest.approx([found["constant_radius"]] * 3, rel=0.005)
    assert found["constant_radius"] == pytest.approx(by_line, rel=0.02)


def test_a_steady_turn_is_where_a_simulated_step_ends(small_car):
    turn = TurnDemand(SPEED, "lateral_acceleration", 3.0)
    point = small_car.find(turn, small_car.straight(SPEED))
    wanted = small_car.car.outputs(point)
    test = StepSteer(
        speed_control=small_car.car.control, angle=wanted["steering_angle.angle"], begin=0.0
    )
    run = drive(small_car.car, test, small_car.straight(SPEED), 12.0)
    for name in (
        "body.yaw_rate",
        "body.sideslip_angle",
        "chassis.roll",
        "front_left.tyre.normal_force",
    ):
        assert run.recording.channels[name][-1] == pytest.approx(wanted[name], rel=1e-3), name


def test_swept_sine_pulse_and_linear_response_agree(small_car):
    straight = small_car.straight(SPEED)
    linear = CorneringModes(small_car).about(straight, held_speed=True)
    exact = linear.response("body.yaw_rate", FREQUENCIES)
    control = small_car.car.control
    tests = (
        (SweptSine(speed_control=control, amplitude=0.0015, sweep_time=20.0), 24.0),
        (PulseSteer(speed_control=control, amplitude=0.003), 5.0),
    )
    for test, duration in tests:
        signals = drive(small_car.car, test, straight, duration).signals
        found = transient_response(
            signals.time, signals.steering, signals.yaw_rate, frequencies=FREQUENCIES
        )
        assert np.abs(found.response / exact - 1.0).max() < 0.03


def test_the_linear_response_is_that_of_the_general_analysis(small_car):
    """One reduces exact derivatives in axes along the heading, the other keeps the world's.

    Half the steering rate, as a slope at a knot of the steering table is, would make 1e-3.
    """
    at = [0.3, 1.0, 2.0]
    general = vehicledyn.response(
        "small_car", "road_wheel_angle", "body.yaw_rate", speed=SPEED, first=0.3, last=2.0, at=at,
        points=5, spacing="linear",
    )  # fmt: skip
    frequencies = np.asarray(general["response"].coords["frequency"].values)
    expected = np.asarray(general["response"].values).reshape(len(frequencies), -1)[:, 0]
    linear = CorneringModes(small_car).about(small_car.straight(SPEED))
    found = linear.response("body.yaw_rate", frequencies)
    assert np.abs(found / expected - 1.0).max() < 1e-9


def test_the_yaw_moment_vanishes_in_a_steady_turn(small_car):
    point = small_car.find(
        TurnDemand(SPEED, "lateral_acceleration", 4.0), small_car.straight(SPEED)
    )
    outputs = small_car.car.outputs(point)
    found = yaw_moments(
        small_car,
        SPEED,
        sideslip=np.array([outputs["body.sideslip_angle"]]),
        steering=np.array([outputs["steering_angle.angle"]]),
    )
    assert abs(found.yaw_acceleration[0, 0]) < 1e-4
    assert found.lateral_acceleration[0, 0] == pytest.approx(4.0, rel=1e-3)


def test_the_speed_that_is_held_is_that_along_the_path(small_car):
    point = small_car.find(TurnDemand(15.0, "curvature", 0.03), small_car.straight(15.0))
    outputs = small_car.car.outputs(point)
    ahead, aside = (outputs[f"body.{name}_speed"] for name in ("forward", "lateral"))
    assert abs(aside) > 0.1
    assert np.hypot(ahead, aside) == pytest.approx(15.0, rel=1e-9)
    assert outputs["body.yaw_rate"] == pytest.approx(0.03 * 15.0, rel=1e-9)


def test_steady_cornering_ends_where_a_power_slide_begins():
    """Beyond, a wheel of the truck spins and its driver steers against the turn."""
    solver = solver_of("off_road_truck")
    for curve in (constant_speed(solver, 100.0 / 3.6), constant_radius(solver, 100.0)):
        assert curve.reason == POWER_SLIDE
        assert np.isnan(curve.limit)
        assert curve.values["lateral_acceleration"][-1] == pytest.approx(6.4, abs=0.1)


def test_a_steady_turn_with_a_wheel_in_the_air_is_no_limit():
    """Any rate of that wheel is a balance; a simulated drive keeps such a turn."""
    solver, speed = solver_of("tractor_semitrailer"), 80.0 / 3.6
    curve = constant_speed(solver, speed)
    assert curve.limit == pytest.approx(4.068, abs=0.01)
    lateral = curve.values["lateral_acceleration"]
    k = int(np.searchsorted(lateral, 4.0)) - 1
    assert lateral[k] > 3.94
    point, outputs = curve.points[k], solver.car.outputs(curve.points[k])
    assert curve.values["smallest_wheel_load"][k] == 0.0
    angle = float(curve.values["steering_angle"][k])
    held = {f"test.steering.angle.value_{k}": angle for k in range(8)}
    run = drive(solver.car, DrivingTest(speed_control=solver.car.control), point, 3.0, held)
    loads = [v[-1] for n, v in run.recording.channels.items() if n.endswith("tyre.normal_force")]
    assert min(loads) == 0.0
    assert run.signals.yaw_rate[-1] == pytest.approx(outputs["body.yaw_rate"], rel=1e-4)


def test_a_curve_that_bends_before_its_limit_shows_it():
    """A wheel of this car spins more and more there, so the way to the last turn misleads."""
    curve = constant_radius(solver_of("automatic_sedan"), 100.0)
    assert not curve.is_lost
    assert curve.limit == pytest.approx(7.57, abs=0.02)


def test_a_turn_beyond_the_grip_is_refused_with_what_was_asked(small_car):
    with pytest.raises(NumericalError, match="lateral acceleration 15 at 25 m/s"):
        small_car.find(TurnDemand(SPEED, "lateral_acceleration", 15.0), small_car.straight(SPEED))


def test_a_fishhook_reports_when_its_first_roll_ends(small_car):
    test = Fishhook(speed_control=small_car.car.control, angle=0.12, hold=2.0)
    run = drive(small_car.car, test, small_car.straight(SPEED), 3.0)
    figures = {figure.name: figure.value for figure in figures_of(small_car.car, "fishhook", run)}
    rates = np.abs(run.signals.roll_rate)
    at = test.turned_at + figures["first_roll_settled"]
    assert np.interp(at, run.signals.time, rates) == pytest.approx(np.radians(1.5), rel=1e-6)
    before = (run.signals.time >= test.turned_at) & (run.signals.time < at - 1e-9)
    assert (rates[before] >= np.radians(1.5)).all()


def split_run(small_car, side):
    test = SplitBraking(
        speed_control=small_car.car.control, torque=2500.0, brake_at=0.1, build_up=0.01,
        low_friction=0.1, low_side=side, start=-10.0,
    )  # fmt: skip
    return drive(small_car.car, test, small_car.straight(SPEED), 1.2)


def test_split_friction_turns_the_car_by_the_moment_of_its_brake_forces(small_car):
    """I_z ψ̈ = (track/2) (F_left - F_right) at first, then with the moment of lateral forces too.

    I_z is that of the body, of hubs and wheels and of the distances of their 25 kg.
    """
    places = {"front": 1.115, "rear": -1.385}  # m, from the common centre of mass
    half_track, corner = 0.7, 25.0
    inertia = 1400.0 + 900.0 * 0.015**2 + 4 * 0.5
    inertia += 2 * corner * sum(x**2 + half_track**2 for x in places.values())
    run = split_run(small_car, "right")
    time, channels = run.signals.time, run.recording.channels

    def forces(axle, name):
        left, right = (channels[f"{axle}_{s}.tyre.{name}"] for s in ("left", "right"))
        return left, right

    first = 0.0 * time
    across = 0.0 * time
    for axle, x in places.items():
        left, right = forces(axle, "longitudinal_force")
        first += half_track * (right - left)
        across += x * sum(forces(axle, "lateral_force")) + sum(forces(axle, "aligning_moment"))

    def gained(moment, begin, end):
        kept = (time > begin - 1e-6) & (time < end + 1e-6)
        return float(np.trapezoid(moment[kept], time[kept])) / inertia

    rate = dict(zip(np.round(time, 2), run.signals.yaw_rate, strict=True))
    assert rate[0.13] - rate[0.11] == pytest.approx(gained(first, 0.11, 0.13), rel=0.05)
    assert rate[0.3] - rate[0.13] == pytest.approx(gained(first + across, 0.13, 0.3), rel=0.01)
    assert gained(first, 0.13, 0.3) > 1.1 * (rate[0.3] - rate[0.13])


def test_the_other_side_slippery_mirrors_the_motion(small_car):
    right, left = (split_run(small_car, side).signals for side in ("right", "left"))
    assert right.y[-1] > 0.2
    for name in ("y", "yaw", "yaw_rate", "roll", "sideslip"):
        mirrored = -getattr(left, name)
        assert getattr(right, name) == pytest.approx(mirrored, abs=1e-10), name
    assert right.x == pytest.approx(left.x, abs=1e-10)


def test_the_tested_car_has_the_mass_of_its_file(small_car):
    assert small_car.car.mass == pytest.approx(1000.0, rel=1e-8)
    front = sum(small_car.car.wheel_loads[f"front_{side}"] for side in ("left", "right"))
    assert front / (9.81 * 1000.0) == pytest.approx(1.385 / 2.5, rel=2e-3)


def test_the_slippery_side_is_gone_in_the_next_test(small_car):
    before = drive_straight(small_car)
    split_run(small_car, "left")
    assert drive_straight(small_car).speed.tolist() == before.speed.tolist()


def drive_straight(small_car):
    test = StraightBraking(speed_control=small_car.car.control, torque=2500.0, brake_at=0.1)
    return drive(small_car.car, test, small_car.straight(SPEED), 0.5).signals


def test_what_is_no_road_vehicle_is_refused():
    with pytest.raises(InputError, match="no road vehicle"):
        vehicledyn.steady("four_bar")


def test_the_report_holds_curves_and_figures(tmp_path):
    data = vehicledyn.steady("small_car", limits=False, save_to=tmp_path / "steady.h5")
    assert data.kind == "handling"
    assert data["constant_speed.steering_angle"].unit == "rad"
    report = data.report
    assert report.table.figure("constant_speed.limit") == pytest.approx(7.86, abs=0.05)
    assert "Understeer gradient" in report.as_text()
    assert "under equal curvature the methods compare" in report.as_text()
    assert report.as_dict()["cars"][0]["model"] == "small_car"


LOST = """\
title: Much too fast
model: small_car
speed: SPEED
manoeuvre:
  kind: double_lane_change
  begin: 1 m
  driver: {kind: pure_pursuit, distance: 8 m, lag_frequency: 20 rad/s, lag_damping: 0.8,
    rack_stop: STOP}
  speed_control: {proportional_gain: 400 N*s, integral_gain: 100 N}
duration: 4 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


def test_a_driver_who_loses_the_car_says_when_and_where(tmp_path):
    path = tmp_path / "lost.yaml"
    path.write_text(LOST.replace("SPEED", "50 m/s").replace("STOP", "60 mm"))
    with pytest.warns(vehicledyn.UnfinishedWarning, match="driver lost the car"):
        data = vehicledyn.simulate(path)
    assert data.status == "overturned"
    summary = data.summary
    assert not summary["passed"].value
    time, x = summary["lost_at_time"].value, summary["lost_at_x"].value
    error = np.abs(data["driver.path_error"].values)
    assert np.interp(time, data.time, error) >= 5.0
    assert np.interp(time, data.time, data["chassis.x"].values) == pytest.approx(x)


def test_a_path_tighter_than_the_car_is_refused(tmp_path):
    path = tmp_path / "tight.yaml"
    path.write_text(LOST.replace("SPEED", "10 m/s").replace("STOP", "2 mm"))
    with pytest.raises(InputError, match=r"radius of .* m behind x = .* rack_stop"):
        vehicledyn.simulate(path)


def test_a_truck_is_tested_within_its_limits():
    """It tips over at 4 m/s²: a step of that would have no steady value to tell."""
    solver = solver_of("tractor_semitrailer")
    assert solver.car.vehicle.articulation == "trailer.yaw"
    tests = StandardTests(solver, lambda *_: None)
    tests.transients()
    tests.braking()
    tests.trailer_sway()
    found = {(f.test, f.name): f.value for f in tests.figures}
    assert found["step_steer", "lateral_acceleration_steady"] == pytest.approx(2.41, rel=0.03)
    assert abs(found["straight_braking", "heading_change"]) < 0.02
    assert any("wheels lock" in note for note in tests.notes)
    assert found["trailer_sway", "sway_damping_ratio"] > 0.0
    assert all(" in place of " in note for note in tests.notes)
    assert found["straight_braking", "stopping_distance"] > 60.0
    assert not any("overturned" in note for note in tests.notes)


def test_figures_of_a_drive_that_rolls_over_are_left_out():
    solver = solver_of("tractor_semitrailer")
    tests = StandardTests(solver, lambda *_: None)
    step = StepSteer(speed_control=solver.car.control, angle=0.05)
    assert tests._run("step_steer", step, 80.0 / 3.6, 4.5).ended_by
    assert not tests.figures
    assert "step_steer" in tests.sheets


def test_a_car_that_rolls_over_has_tipped_up_whatever_its_chassis_is_called():
    solver = solver_of("jeep")
    tests = StandardTests(solver, lambda *_: None)
    tests.fishhook(0.01)
    found = {f.name: f.value for f in tests.figures}
    assert any("chassis.overturned" in note for note in tests.notes)
    assert found["tips_up"]
    assert 41.5 * 0.44704 < found["safe_speed"] < found["tip_up_speed"] <= 43.0 * 0.44704
    assert found["tip_up_speed"] - found["safe_speed"] <= 0.01 * found["tip_up_speed"]
    assert "two_wheel_height" not in found  # that of a car which lies on its side says nothing


@pytest.mark.parametrize(
    ("name", "angle"),
    [
        ("jeep", None),
        ("small_car", None),
        ("car_and_caravan", "caravan.body.yaw"),
        ("car_and_trailer", "trailer.yaw"),
        ("tractor_semitrailer", "trailer.yaw"),
    ],
)
def test_a_trailer_turns_on_its_coupling_and_an_axle_is_none(name, angle):
    assert build_tested(read_target(name), DrivingTest()).vehicle.articulation == angle


def test_a_car_that_does_not_come_to_rest_has_no_stopping_distance_and_says_so(small_car):
    tests = StandardTests(small_car, lambda *_: None)
    braking = StraightBraking(speed_control=small_car.car.control, torque=2000.0)
    tests._run("straight_braking", braking, 80.0 / 3.6, 2.0)
    (note,) = tests.notes
    assert "straight braking: no stopping distance: after 2 s the car still moves at" in note
