"""The g-g diagram: what ends it where cars are driven hard."""

import numpy as np
import pytest

from vehicledyn.analyses.handling.acceleration_limits import acceleration_limits
from vehicledyn.analyses.handling.steady_turn import FULL_THROTTLE, POWER_SLIDE, solver_for
from vehicledyn.analyses.handling.tested_car import CONTROL, TestedCar
from vehicledyn.interface.targets import read_target
from vehicledyn.road.manoeuvres.driving_test import DrivingTest

pytestmark = pytest.mark.long


def limits_of(model):
    test = DrivingTest(speed_control=CONTROL)
    car = TestedCar(read_target(model), backend="auto", progress=lambda *_: None, test=test)
    return acceleration_limits(solver_for(car), 100.0 / 3.6)


def test_power_slides_are_left_out():
    """Rear-wheel drive and an open differential: the inner wheel spins, opposite lock holds."""
    found = limits_of("sedan")
    assert not found.lost
    driven = found.longitudinal >= 0.0
    assert (np.diff(found.lateral[driven]) < 0.0).all()
    slides = [end == POWER_SLIDE for end in found.ends]
    assert found.longitudinal[slides] == pytest.approx(np.arange(3.0, 9.0))
    assert found.lateral[[0, -1]] == pytest.approx(0.0)


def test_a_motor_ends_the_diagram_at_full_throttle():
    found = limits_of("electric_car")
    assert not found.lost
    assert found.ends[-1] == FULL_THROTTLE
    assert found.longitudinal[-1] == pytest.approx(3.43, abs=0.05)
