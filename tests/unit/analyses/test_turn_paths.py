"""Paths of steady turns: kinks are passed, limits are shown, the rest is told."""

import numpy as np
import pytest

from vehicledyn.analyses.handling.circle import SteadyCurve, constant_radius, constant_speed
from vehicledyn.analyses.handling.equal_curvature import gradients_on_circle, place_on
from vehicledyn.analyses.handling.steady_turn import SteadyTurn, solver_for
from vehicledyn.analyses.handling.tested_car import CONTROL, TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.analyses.handling.turn_paths import followed, reached
from vehicledyn.base.errors import NumericalError
from vehicledyn.interface.targets import read_target
from vehicledyn.road.manoeuvres.driving_test import DrivingTest

LIMIT = 8.0


def lateral(value):
    return TurnDemand(20.0, "lateral_acceleration", value)


class Curve:
    """Turns on the curve (value, angle) = (a sin s, s), without those in a gap of values."""

    def __init__(self, gap=(np.inf, np.inf), comes_back=True):
        self.gap, self.comes_back = gap, comes_back

    def find(self, turn, near):
        if not abs(turn.value) <= LIMIT or self.gap[0] < turn.value < self.gap[1]:
            raise NumericalError("none")
        return float(np.arcsin(turn.value / LIMIT))

    def orientation(self, turn, point):
        return 1 if point <= 0.5 * np.pi else -1

    def unknowns(self, turn, point):
        return np.array([point])

    def beyond(self, turn, before, last, most):
        angle = last[1] + 2.0 * (last[1] - before[1])
        is_lost = not self.comes_back and abs(angle - 0.5 * np.pi) < 0.5
        return None if is_lost else (LIMIT * np.sin(angle), angle)


def test_a_limit_is_where_the_curve_comes_back():
    path = followed(Curve(), lateral, (0.0, 0.0), np.inf, step=0.3, smallest=0.01)
    assert path.is_limit and not path.is_lost
    assert LIMIT - 0.01 < max(path.values) <= LIMIT


def test_a_search_that_fails_is_no_limit():
    """Along the curve itself the path goes on behind values for which nothing is found."""
    path = followed(Curve(gap=(3.0, 3.4)), lateral, (0.0, 0.0), np.inf, step=0.3, smallest=0.01)
    assert path.is_limit
    assert max(path.values) > LIMIT - 0.01
    lost = followed(Curve(comes_back=False), lateral, (0.0, 0.0), np.inf, step=0.3, smallest=0.01)
    assert lost.is_lost and not lost.is_limit


def test_a_kink_is_passed_where_the_unknowns_begin_to_move():
    """As the steering angle does where a differential begins to slip."""

    class Kinked(Curve):
        def find(self, turn, near):
            return 1e-6 * turn.value + max(turn.value - 3.0, 0.0)

        def orientation(self, turn, point):
            return 1

        def beyond(self, turn, before, last, most):
            return None

    path = followed(Kinked(), lateral, (0.0, 0.0), 6.0, step=0.3, smallest=0.03)
    assert path.end == "found"
    assert path.values[-1] == 6.0


def test_a_path_ends_before_turns_that_are_not_wanted():
    def far(angle):
        return "far" if angle > 0.5 else ""

    steps = {"step": 0.3, "smallest": 0.01}
    path = followed(Curve(), lateral, (0.0, 0.0), np.inf, **steps, unwanted=far)
    assert (path.end, path.reason) == ("unwanted", "far")
    assert LIMIT * np.sin(0.5) - 0.01 < path.values[-1] <= LIMIT * np.sin(0.5)


def test_a_turn_behind_the_limit_is_none_before_it():
    """Newton's method may leap over a limit, to where the curve comes back."""

    class Leaping(Curve):
        def find(self, turn, near):
            return (
                np.pi - super().find(turn, near) if turn.value > 6.0 else super().find(turn, near)
            )

    class Remote(Leaping):
        def orientation(self, turn, point):
            return 1

        def beyond(self, turn, before, last, most):
            return None

    path = followed(Leaping(), lateral, (0.0, 0.0), np.inf, step=0.5, smallest=0.01)
    assert path.is_limit
    assert max(path.values) == pytest.approx(6.0, abs=0.01)
    path = followed(Remote(), lateral, (0.0, 0.0), np.inf, step=0.5, smallest=0.01)
    assert path.is_lost
    assert max(path.values) == pytest.approx(6.0, abs=0.01)


def test_a_turn_is_reached_in_steps_as_fine_as_it_needs():
    class Near(Curve):
        def find(self, turn, near):
            found = super().find(turn, near)
            if abs(found - near) > 0.02:
                raise NumericalError("none as near")
            return found

    assert reached(Near(), lateral, 7.0, 0.0, steps=3) == pytest.approx(np.arcsin(7.0 / LIMIT))
    with pytest.raises(NumericalError, match="none"):
        reached(Near(), lateral, 9.0, 0.0, steps=3)


@pytest.mark.parametrize("near", [2.0, 4.0])
def test_a_neutral_car_is_read_where_it_comes_back_to_the_circle(near):
    """Its curvature with the wheel held grows and falls again, so it has two places."""
    lateral = np.arange(0.0, 5.0, 0.3)
    curvature = 0.01 - 1e-5 * (lateral - 2.0) * (lateral - 4.0)
    values = {
        "lateral_acceleration": lateral,
        "curvature": curvature,
        "understeer_angle": lateral**2,
    }
    curve = SteadyCurve("wheel held", values, [])
    assert place_on(curve, "curvature", 0.01, near) == pytest.approx((near, near**2), abs=1e-9)
    assert np.isnan(place_on(curve, "curvature", 0.02, near)).all()


@pytest.mark.long
def test_the_drive_helps_where_cornering_brakes_more_than_wanted():
    """Gentle braking goes over to driving where the tyres slow the car by themselves."""
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(read_target("small_car"), backend="auto", progress=lambda *_: None, test=test)
    solver = SteadyTurn(car)

    def turn(value):
        return TurnDemand(25.0, "lateral_acceleration", value, -0.5)

    start = solver.find(turn(0.0), solver.straight(25.0))
    path = followed(solver, turn, (0.0, start), np.inf, step=0.5, smallest=0.03)
    brake, drive = car.table_places("test.brake_torque")[0], car.state("drive.speed_error_integral")
    braked = np.array([point.parameters[brake] for point in path.points])
    driven = np.array([point.state[drive] for point in path.points])
    assert path.values[-1] > 7.5
    assert braked[0] > 0.0 == driven[0]
    assert driven[-1] > 0.0 == braked[-1]
    assert (braked * driven == 0.0).all()


@pytest.fixture(scope="module")
def front_driven() -> SteadyTurn:
    test = DrivingTest(speed_control=CONTROL)
    target = read_target("front_wheel_drive_car")
    car = TestedCar(target, backend="auto", progress=lambda *_: None, test=test)
    return solver_for(car)


@pytest.mark.long
def test_friction_that_sticks_does_not_steer(front_driven):
    """It keeps what it has at rest, so the limit of the car is that of its tyres either way."""
    frictions = {f"steering.{name}_friction.twist" for name in ("column", "rack")}
    assert set(front_driven.states.sticking) == frictions
    speed = constant_speed(front_driven, 80.0 / 3.6)
    circle = constant_radius(front_driven, 100.0)
    assert not speed.is_lost and not circle.is_lost
    assert speed.limit == pytest.approx(circle.limit, rel=5e-3)
    for name in frictions:
        place = front_driven.car.state(name)
        assert all(point.state[place] == 0.0 for point in speed.points)


@pytest.mark.long
@pytest.mark.parametrize("model", ["front_wheel_drive_car", "off_road_truck"])
def test_three_methods_read_one_turn(model):
    """The understeer angle of the truck bends back between the two turns, so any miss shows."""
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(read_target(model), backend="auto", progress=lambda *_: None, test=test)
    solver = solver_for(car)
    circle = constant_radius(solver, 100.0, last=4.5)
    found = gradients_on_circle(solver, circle, 100.0, first=2.0, last=4.0)
    assert len(found) == 3
    assert np.ptp(list(found.values())) < 5e-3 * min(found.values())
