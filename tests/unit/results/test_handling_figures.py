"""Figures of handling tests draw what each of them is about."""

import numpy as np
import pytest

from vehicledyn.results.plots.handling.test_figures import handling_figures
from vehicledyn.results.tables.columns import Column
from vehicledyn.results.tables.handling_table import HandlingTable

TIME = np.linspace(0.0, 10.0, 101)
SIGNALS = ("steering", "yaw_rate", "lateral_acceleration", "sideslip", "forward_speed", "x", "y")


def figure_of(test, name="", **signals):
    given = {"time": TIME, **{signal: 1e-14 * np.sin(TIME) for signal in SIGNALS}, **signals}
    sheet = {signal: Column("1", "", values) for signal, values in given.items()}
    return dict(handling_figures([HandlingTable("tests", "car", {test: sheet}, [])]))[name or test]


def test_a_coast_down_shows_speed_and_way():
    drawn = figure_of("coast_down", forward_speed=30.0 - TIME, x=30.0 * TIME - 0.5 * TIME**2)
    assert [axes.get_ylabel() for axes in drawn.axes] == ["Speed [m/s]", "Way [m]"]
    assert drawn.axes[0].lines[0].get_ydata()[-1] == pytest.approx(20.0)
    assert drawn.axes[0].get_ylim()[0] == 0.0


def test_braking_on_the_straight_shows_the_deviation_and_no_angle_of_a_car_at_rest():
    drawn = figure_of("straight_braking")
    assert drawn.axes[-1].get_ylabel() == "Deviation from the path [m]"


def test_rounding_of_a_symmetric_car_is_drawn_as_nothing():
    for axes in figure_of("step_steer").axes:
        assert not axes.lines[0].get_ydata().any()


def test_the_loop_of_a_weave_ends_with_the_steering():
    steering = np.where(TIME < 9.05, np.sin(2.0 * TIME), 1e-17)
    drawn = figure_of("weave", "weave_loops", steering=steering, yaw_rate=TIME)
    assert np.degrees(9.0) == pytest.approx(drawn.axes[0].lines[0].get_ydata().max())
