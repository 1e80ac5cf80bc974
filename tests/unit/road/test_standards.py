"""Quantities of the standards against signals of which they are known in closed form."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import find
from vehicledyn.road.manoeuvres.sine_dwell_test import SineDwellTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal, sine_with_dwell
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.standards.braking import STOPPED, deceleration_figures
from vehicledyn.road.standards.evasion import (
    Lane,
    double_lane_change,
    obstacle_avoidance,
    passage,
)
from vehicledyn.road.standards.frequency_response import transient_response
from vehicledyn.road.standards.gradients import initial_gradient
from vehicledyn.road.standards.hysteresis import loop_of
from vehicledyn.road.standards.peaks import peak
from vehicledyn.road.standards.signals import Signals
from vehicledyn.road.standards.sine_dwell import Dwelling, Verdict, judged
from vehicledyn.road.standards.steering_shares import STANDARD_GRAVITY, angle_at_third_g
from vehicledyn.road.standards.step_response import half_of_step, step_response
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.parameters import ParameterTable

TIME = np.arange(0.0, 20.0, 1e-3)


def signals(**given):
    names = Signals.__dataclass_fields__
    return Signals(
        **{name: given.get(name, np.zeros_like(TIME)) for name in names} | {"time": TIME}
    )


def test_a_first_order_lag_answers_a_step_after_its_time_constant_times_the_logarithm_of_ten():
    lag, begin, ramp = 0.15, 1.0, 0.02
    steering = np.clip((TIME - begin) / ramp, 0.0, 1.0)
    middle = begin + 0.5 * ramp
    answer = np.where(middle < TIME, 7.0 * (1.0 - np.exp(-(TIME - middle) / lag)), 0.0)
    reference = half_of_step(TIME, steering)
    assert reference == pytest.approx(middle, abs=1e-9)
    found = step_response(TIME, answer, reference=reference, settled=15.0)
    assert found.steady == pytest.approx(7.0, rel=1e-9)
    assert found.response_time == pytest.approx(lag * math.log(10.0), abs=1e-5)


def test_an_oscillator_overshoots_by_the_closed_form():
    damping, pulsation = 0.5, 6.0
    damped = pulsation * math.sqrt(1.0 - damping**2)
    decay = np.exp(-damping * pulsation * TIME)
    tail = np.cos(damped * TIME) + damping * pulsation / damped * np.sin(damped * TIME)
    found = step_response(TIME, -3.0 * (1.0 - decay * tail), reference=0.0, settled=15.0)
    assert found.overshoot == pytest.approx(
        math.exp(-math.pi * damping / math.sqrt(1.0 - damping**2)), rel=1e-5
    )
    assert found.peak_time == pytest.approx(math.pi / damped, abs=1e-6)


def test_a_constant_deceleration_is_its_own_mean_and_stops_after_its_way():
    speed, slower = 30.0, 6.0
    found = {e.name: e.value for e in deceleration_figures(
        signals(forward_speed=np.maximum(speed - slower * TIME, 0.0)))}  # fmt: skip
    assert found["initial_speed"] == speed
    assert found["mean_deceleration"] == pytest.approx(slower, rel=1e-9)
    way = (speed**2 - STOPPED**2) / (2.0 * slower)
    assert found["stopping_distance"] == pytest.approx(way, rel=1e-6)
    still = deceleration_figures(signals(forward_speed=speed + 0.0 * TIME))
    assert [e.name for e in still] == ["initial_speed"]


def test_an_unsteady_start_and_a_lost_speed_are_reported_and_a_steady_test_is_not():
    control = {"proportional_gain": "400 N*s", "integral_gain": "100 N"}
    step = find("manoeuvre", "step_steer")(angle=0.1, begin=1.0, speed_control=control)
    turns = np.where(TIME > 1.0, 0.3, 0.0)
    assert step.conditions(signals(forward_speed=22.0 + 0.0 * TIME, yaw_rate=turns)) == []
    jumps = np.where(TIME > 1.0 - 1e-9, 0.3, 0.0)
    assert 1.0 in TIME.round(9)
    assert step.conditions(signals(forward_speed=22.0 + 0.0 * TIME, yaw_rate=jumps)) == []
    (start,) = step.conditions(signals(forward_speed=22.0 + 0.0 * TIME, yaw_rate=0.1 * TIME))
    assert "yaw rate changes by 2.859 deg/s in the 0.5 s before the input" in start
    (speed,) = step.conditions(signals(forward_speed=22.0 - 0.5 * np.maximum(TIME - 1.0, 0.0)))
    assert "79.2 km/h by up to -34.2 km/h" in speed
    assert "by more than 2 km/h from t = 2.11 s on" in speed


def test_the_speed_is_judged_only_where_the_test_holds_it():
    control = {"proportional_gain": "400 N*s", "integral_gain": "100 N"}
    for kind, given, holds in (
        ("weave", {"amplitude": 0.1}, True),
        ("fishhook", {"angle": 0.1}, False),
        ("split_braking", {"torque": 900.0}, False),
        ("constant_steer", {"angle": 0.1, "last_speed_change": 3.0}, False),
    ):
        assert find("manoeuvre", kind)(speed_control=control, **given).holds_speed() == holds
        assert not find("manoeuvre", kind)(**given).holds_speed()


def test_the_path_of_the_obstacle_avoidance_cuts_corners_on_the_inside_of_the_third_lane():
    car = SimpleNamespace(outline=((1.8, 0.8), (-2.0, 0.8), (-2.0, -0.8), (1.8, -0.8)))
    driver = {"kind": "stanley", "gain": "3 Hz", "lag_frequency": "20 rad/s", "lag_damping": 0.8,
              "rack_stop": "60 mm"}  # fmt: skip
    test = find("manoeuvre", "obstacle_avoidance")(driver=driver, release_at=0.0, begin=0.0)
    path, third = test.path(car), test.lanes(car)[1]
    assert path.places == pytest.approx((9.0, 28.5, 33.5, 52.0))
    assert path.offsets[1] - 0.8 - third.right == pytest.approx(0.3 * 1.0)
    assert path.offsets[1] == path.offsets[2] < third.middle


def test_a_lane_change_that_does_not_reach_its_end_has_no_verdict():
    outline = ((1.8, 0.8), (-2.0, 0.8), (-2.0, -0.8), (1.8, -0.8))
    car = SimpleNamespace(outline=outline)
    driver = {"kind": "stanley", "gain": "3 Hz", "lag_frequency": "20 rad/s", "lag_damping": 0.8,
              "rack_stop": "60 mm"}  # fmt: skip
    test = find("manoeuvre", "obstacle_avoidance")(driver=driver, release_at=0.0, begin=0.0)
    aside = test.lanes(car)[1].middle

    def found(last):
        x = np.linspace(-5.0, last, len(TIME))
        y = np.interp(x, [14.5, 23.0, 39.0, 46.0], [0.0, aside, aside, 0.0])
        recording = SimpleNamespace(channels={"driver.path_error": np.zeros_like(TIME)})
        driven = signals(x=x, y=y)
        return {e.name: e.value for e in test.quantities(driven, recording, car)}

    assert "section 3" in found(25.0)["unfinished"]
    assert "passed" not in found(25.0)
    assert "unfinished" not in found(80.0)
    assert found(80.0)["passed"]


def test_a_peak_lies_between_samples():
    time = np.arange(0.0, 1.0, 0.01)
    at, largest = peak(time, 3.0 - 40.0 * (time - 0.3127) ** 2)
    assert (at, largest) == pytest.approx((0.3127, 3.0), abs=1e-9)
    assert peak(time, time) == pytest.approx((0.99, 0.99))
    assert peak(time, np.minimum(time, 0.5)) == pytest.approx((0.5, 0.5), abs=0.0051)


def test_the_fishhook_turns_back_when_the_roll_rate_falls_between_samples():
    test = find("manoeuvre", "fishhook")(angle=1.0, rate=10.0, begin=0.0, hold=2.0)
    assert test.turned_at == pytest.approx(0.1)
    fall, limit = 7000.0, 1.5
    for way in (1.0, -1.0):
        rate = np.radians(way * (20.0 - fall * np.maximum(TIME - 0.2, 0.0)))
        found = test.roll_settled(signals(roll_rate=rate))
        assert found == pytest.approx(0.1 + (20.0 - limit) / fall, abs=1e-9)
        late = np.where(TIME < 0.15, 0.0, rate)
        assert test.roll_settled(signals(roll_rate=late)) == pytest.approx(found, abs=1e-9)
    assert math.isnan(test.roll_settled(signals(roll_rate=np.ones_like(TIME))))
    assert test.roll_settled(signals(roll_rate=np.zeros_like(TIME))) == 0.0


def test_a_sine_with_dwell_coasts_and_asks_less_of_a_heavy_car():
    assert SineDwellTest(amplitude=1.0).throttle().at(1.0) == 0.0
    aside = Verdict(0.1, 0.1, 1.6)
    assert aside.is_responsive(3600.0)
    assert not aside.is_responsive(3500.0)


def test_the_peak_of_a_sine_with_dwell_is_the_first_behind_the_reversal():
    """A car that goes on to spin, to either side, is no better for its large yaw rate."""
    time = np.linspace(0.0, 4.0, 4001)
    given = Dwelling(0.0, 0.7, 0.5, math.radians(10.0))
    end = 1.0 / 0.7 + 0.5
    places = [0.0, 0.4, 0.8, 1.2, 1.6, end + 1.0, end + 1.75, 4.0]
    spinning = np.interp(time, places, [0.0, 0.9, 0.6, -0.5, -0.4, -1.4, -2.0, -4.0])
    for way in (1.0, -1.0):
        verdict = judged(time, way * spinning, np.zeros_like(time), given)
        assert verdict.first_ratio == pytest.approx(1.4 / 0.5, rel=1e-2)
        assert verdict.second_ratio == pytest.approx(2.0 / 0.5, rel=1e-2)
    never = judged(time, np.minimum(time, 1.0), np.zeros_like(time), given)
    assert never.first_ratio == math.inf
    assert not never.is_stable


def test_the_displacement_of_a_sine_with_dwell_counts_from_5_degrees():
    time = np.linspace(0.0, 2.0, 2001)
    given = Dwelling(0.0, 0.7, 0.5, math.radians(10.0))
    begun = math.asin(0.5) / (2.0 * math.pi * 0.7)
    verdict = judged(time, np.sin(time), time**2, given)
    assert verdict.displacement == pytest.approx((begun + 1.07) ** 2 - begun**2, rel=1e-6)
    front_wheels = Dwelling(0.0, 0.7, 0.5, None)
    verdict = judged(time, np.sin(time), time**2, front_wheels)
    assert verdict.displacement == pytest.approx(1.07**2, rel=1e-6)


@pytest.mark.parametrize("kind", ["straight_braking", "split_braking", "acceleration"])
def test_torques_on_wheels_of_a_given_rate_are_refused(kind):
    test = find("manoeuvre", kind)(torque=900.0)
    assert not test.problems(free_wheels=True)
    assert "wheel_spin: free" in "".join(test.problems(free_wheels=False))


def test_a_pulse_gives_the_response_of_a_first_order_lag():
    lag, width = 0.2, 0.4
    given = np.where(width > TIME, np.sin(math.pi * TIME / width), 0.0)
    answer = np.zeros_like(given)
    fall = math.exp(-1e-3 / lag)
    for k in range(1, len(given)):
        middle = 0.5 * (given[k] + given[k - 1])
        answer[k] = fall * answer[k - 1] + (1.0 - fall) * middle
    frequencies = np.array([0.2, 0.5, 1.0, 1.5])
    found = transient_response(TIME, given, answer, frequencies=frequencies)
    exact = 1.0 / (1.0 + 2j * math.pi * frequencies * lag)
    assert np.abs(found.response / exact - 1.0).max() < 1e-4
    assert found.leftover < 1e-9
    assert found.bandwidth(1.0) == pytest.approx(1.0)  # 1/(2π 0.2 s) = 0.8 Hz, next one listed


def test_a_frequency_that_nothing_excites_is_refused():
    with pytest.raises(InputError, match="does not excite"):
        transient_response(TIME, np.zeros_like(TIME), TIME, frequencies=np.array([1.0]))


def test_the_angle_at_third_g_comes_from_the_line():
    share = np.clip(TIME / 40.0, 0.0, 0.5)
    steering = 0.02 + 2.0 * share
    found = angle_at_third_g(
        signals(lateral_acceleration=share * STANDARD_GRAVITY, steering=-steering)
    )
    assert found == pytest.approx(0.62, rel=1e-9)
    with pytest.raises(InputError, match=r"reaches 0\.2 g"):
        angle_at_third_g(signals(lateral_acceleration=0.4 * share * STANDARD_GRAVITY))


def test_a_lag_opens_the_loop_of_a_weave_by_the_closed_form():
    frequency, lag, gain = 0.2, 0.1, 5.0
    turn = 2.0 * math.pi * frequency
    period = TIME[TIME <= 5.0]
    loop = loop_of(period, np.sin(turn * period), gain * np.sin(turn * (period - lag)), frequency)
    assert loop.lag == pytest.approx(lag, abs=1e-4)
    assert loop.height == pytest.approx(2.0 * gain * math.sin(turn * lag), rel=1e-3)
    assert loop.width == pytest.approx(2.0 * math.sin(turn * lag), rel=1e-3)
    assert loop.gain == pytest.approx(gain * math.cos(turn * lag), rel=1e-2)


def test_an_initial_gradient_is_the_slope_of_a_line():
    acceleration = np.linspace(0.0, 8.0, 81)
    assert initial_gradient(acceleration, 0.003 * acceleration - 1.0, 4.0) == pytest.approx(0.003)
    with pytest.raises(InputError, match="no two points"):
        initial_gradient(acceleration[60:], acceleration[60:], 4.0)


def test_lanes_are_those_of_the_standards():
    width = 1.8
    lanes = double_lane_change(width, 20.0)
    assert [lane.width for lane in lanes] == pytest.approx([2.23, 2.41, 2.59])
    assert [(lane.begin, lane.end) for lane in lanes] == [(20, 35), (65, 90), (115, 130)]
    assert lanes[1].right - lanes[0].right == pytest.approx(3.5)
    first, third, fifth = obstacle_avoidance(width, 0.0)
    assert [first.width, third.width, fifth.width] == pytest.approx([2.23, 2.8, 3.0])
    assert third.right - first.left == pytest.approx(1.0)
    assert fifth.end == pytest.approx(61.0)


def test_a_corner_that_leaves_its_lane_is_found():
    lane = Lane(10.0, 20.0, -1.2, 1.2)
    outline = ((2.0, 0.9), (-2.0, 0.9), (-2.0, -0.9), (2.0, -0.9))
    x = np.linspace(0.0, 30.0, 301)
    straight = np.array([x, np.full_like(x, 0.1), np.zeros_like(x)])
    assert passage(lane, outline, straight).clearance == pytest.approx(0.2)
    turned = np.array([x, np.zeros_like(x), np.full_like(x, 0.2)])
    found = passage(lane, outline, turned)
    assert found.clearance == pytest.approx(1.2 - 2.0 * math.sin(0.2) - 0.9 * math.cos(0.2))
    short = straight[:, :100]
    assert not passage(lane, outline, short).entered


def evaluated(signal, times):
    t, table = ops.symbol("t"), ParameterTable()
    law = signal.enter(table, "test")
    symbols = [entry.symbol for entry in table.entries]
    assert {entry.name: entry.value for entry in table.entries} == dict(signal.settings("test"))
    function = ops.numeric([t, *symbols], ops.column([law(t)]))
    values = [entry.value for entry in table.entries]
    return [float(np.ravel(function(time, *values))[0]) for time in times]


def test_a_steering_signal_is_what_its_numbers_say():
    knots = TimeTable((1.0, 2.0, 4.0), (0.0, 3.0, -1.0))
    assert [knots.at(t) for t in (0.0, 1.5, 3.0, 9.0)] == pytest.approx([0.0, 1.5, 1.0, -1.0])
    assert evaluated(SteeringSignal(knots), (0.0, 1.5, 3.0, 9.0)) == pytest.approx(
        [0.0, 1.5, 1.0, -1.0]
    )
    dwell = sine_with_dwell(2.0, 0.5, 0.3)
    found = evaluated(dwell, (0.5, 1.5, 1.79, 2.3, 3.0))
    assert found == pytest.approx([2.0, -2.0, -2.0, 0.0, 0.0], abs=1e-9)
    sweep = SteeringSignal(amplitude=1.0, frequency=1.0, sweep_rate=2.0, cycles=2.0, hold_at=1e6)
    assert evaluated(sweep, (0.5, 1.0, 5.0)) == pytest.approx(
        [math.sin(2.0 * math.pi * 0.75), 0.0, 0.0], abs=1e-9
    )


def test_a_table_of_time_refuses_what_it_cannot_be():
    with pytest.raises(InputError, match="must increase"):
        TimeTable((1.0, 1.0), (0.0, 1.0))
    with pytest.raises(InputError, match="1 to 8 times"):
        TimeTable(tuple(range(9)), tuple(range(9)))
