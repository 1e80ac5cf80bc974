"""Brakes of manoeuvres: dry friction that slides with its limit and then holds without creep."""

import numpy as np
import pytest

from vehicledyn.multibody.equations.derivation import derive
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.system import System
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.kinds.braking.straight_braking import StraightBraking
from vehicledyn.road.manoeuvres.kinds.recorded.open_loop import OpenLoop
from vehicledyn.road.manoeuvres.pedals import STIFFNESS, Pedals
from vehicledyn.road.vehicle import Corner
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.parameters import ParameterTable

WEIGHT, LIMIT, INERTIA = 10.0 * 9.81 * 0.5, 260.0, 4.0
CORNER = Corner("wheel", "wheel", "spin", True, True, 0.3)


def unbalanced_wheel():
    """A wheel whose weight turns it, under a car that stands, as equations."""
    pedals = Pedals(
        "drive", "car", (CORNER,), lambda _: 0.0, lambda _: 0.0, lambda _: 0.0,
        lambda _: LIMIT / 0.65, 0.65, 0.0, 0.0,
    )  # fmt: skip
    car = Body("car", "ground", joints=(Joint("T1", "x"),), mass=1e3, inertia=(1, 1, 1, 0, 0, 0))
    wheel = Body(
        "wheel", "car", joints=(Joint("R2", "spin"),), mass=10.0, com=(0.5, 0, 0),
        inertia=(1.5, INERTIA - 2.5, 1.5, 0, 0, 0),
    )  # fmt: skip
    return derive(System("rig", ParameterTable(), (car, wheel), parts=(pedals,)))


def test_a_brake_holds_a_wheel_that_it_has_stopped():
    e = unbalanced_wheel()
    values = [p.value for p in e.parameters]
    rate = ops.numeric([e.time, e.state, e.algebraic, e.parameter], e.rate)
    names = [s.name for s in e.states]
    state = np.zeros(len(names))
    spin = names.index("spin_rate")
    state[spin] = 10.0

    def slope(x):
        return rate(0.0, x, [], values)[:, 0]

    sliding = slope(state + 1.0 * (np.array(names) == "drive.brake_twist_wheel"))[spin]
    assert sliding == pytest.approx((WEIGHT - LIMIT) / INERTIA, rel=1e-3)
    for _ in range(3000):
        a = slope(state)
        b = slope(state + 5e-4 * a)
        c = slope(state + 5e-4 * b)
        state = state + 1e-3 / 6 * (a + 2 * b + 2 * c + slope(state + 1e-3 * c))
    assert abs(state[spin]) < 1e-9
    held = STIFFNESS * state[names.index("drive.brake_twist_wheel")]
    assert held == pytest.approx(WEIGHT * np.cos(state[names.index("spin")]), rel=1e-6)


def test_only_tests_that_brake_to_rest_have_brakes_that_stick():
    """Elsewhere the twists would be modes of no meaning, and steady turns need none."""
    assert StraightBraking(torque=1e3).brakes_to_rest()
    assert OpenLoop(times=[0.0], brake_torques=[0.0]).brakes_to_rest()
    assert not OpenLoop(times=[0.0]).brakes_to_rest() and not DrivingTest().brakes_to_rest()
