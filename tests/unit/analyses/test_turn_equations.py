"""The equations of a steady turn: exact derivatives against differences along closed loops."""

import numpy as np
import pytest

from vehicledyn.analyses.handling.tested_car import CONTROL, CarPoint, TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnDemand, TurnEquations
from vehicledyn.analyses.handling.turn_states import TurnStates
from vehicledyn.interface.targets import read_target
from vehicledyn.road.manoeuvres.driving_test import DrivingTest

STEP = 1e-6
SPEED = 20.0


@pytest.fixture(scope="module")
def car() -> TestedCar:
    test = DrivingTest(speed_control=CONTROL)
    target = read_target("small_car")
    return TestedCar(target, backend="interpreted", progress=lambda *_: None, test=test)


@pytest.fixture(scope="module")
def equations(car) -> TurnEquations:
    return TurnEquations(car, TurnStates(car))


@pytest.fixture(scope="module")
def rolling(car) -> CarPoint:
    state = car.standing.state.copy()
    state[car.state("chassis.x_rate")], state[car.state("chassis.y_rate")] = SPEED, -0.2
    state[car.state("chassis.yaw_rate")], state[car.state("chassis.roll")] = 0.15, 0.02
    for corner in car.vehicle.corners:
        state[car.state(f"{corner.spin}_rate")] = 1.002 * SPEED / corner.radius
    return CarPoint(state, car.standing.unknowns, car.standing.parameters)


def differenced(function, place):
    columns = []
    for k, value in enumerate(place):
        step = np.eye(len(place))[k] * STEP * max(1.0, abs(value))
        columns.append((function(place + step) - function(place - step)) / (2.0 * step[k]))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize(
    ("turn", "drive"),
    [
        (TurnDemand(SPEED, "lateral_acceleration", 3.0), 300.0),
        (TurnDemand(SPEED, "curvature", 0.01, acceleration=1.0), 300.0),
        (TurnDemand(SPEED, "steering", 0.1, acceleration=-1.0), -0.4),
        (TurnDemand(SPEED, "steering", 0.1, sideslip=0.02), 300.0),
    ],
)
def test_derivatives_by_unknowns_are_those_of_differences(car, equations, rolling, turn, drive):
    unknowns = equations.unknowns(turn, rolling)
    unknowns[-2:] = 0.2, drive

    def rows(x):
        return equations.at(turn, equations.moved(turn, rolling, x), x)

    found = rows(unknowns)[1][:, : len(unknowns)]
    expected = differenced(lambda x: rows(x)[0], unknowns)
    scale = np.abs(found).max(axis=1, keepdims=True)
    assert found / scale == pytest.approx(expected / scale, abs=1e-6)


def test_the_derivative_by_a_value_is_that_of_differences(equations, rolling):
    """On a circle of 100 m the speed grows with the lateral acceleration, here while braking."""

    def turn(lateral):
        return TurnDemand(
            float(np.sqrt(100.0 * lateral)), "curvature", 0.01, acceleration=-0.1 * lateral
        )

    unknowns = equations.unknowns(turn(4.0), rolling)
    unknowns[-1] = -0.4

    def rows(lateral):
        return equations.at(
            turn(lateral), equations.moved(turn(lateral), rolling, unknowns), unknowns
        )

    found = equations.along(turn, 4.0, rows(4.0)[1])
    expected = differenced(lambda v: rows(float(v[0]))[0], np.array([4.0]))[:, 0]
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-6)
