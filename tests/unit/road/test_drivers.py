"""Laws of the drivers against closed forms, on bodies placed by hand and in runs of a small car."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from vehicledyn.road.drivers.macadam import MacAdam
from vehicledyn.road.drivers.optimal_preview import optimal_gains, prediction, single_track
from vehicledyn.road.drivers.pure_pursuit import PurePursuit
from vehicledyn.road.drivers.stanley import Stanley
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.parameters import ParameterTable
from vehicledyn.symbolic.sparse_rows import matrix_of

WHEELBASE, FRONT = 2.6, 1.2
HANDS = {"lag_frequency": 20.0, "lag_damping": 0.8, "rack_stop": 0.1}


def vehicle():
    return SimpleNamespace(
        system=SimpleNamespace(table=ParameterTable()), chassis="chassis", rack="rack",
        steering_gain=1.0, wheelbase=WHEELBASE, front_distance=FRONT,
    )  # fmt: skip


def situation(x, y, heading, velocity=(20.0, 0.0), yaw_rate=0.0):
    c, s = math.cos(heading), math.sin(heading)
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return SimpleNamespace(
        kinematics=SimpleNamespace(
            position=lambda _: (x, y, 0.0),
            velocity=lambda _: (*velocity, 0.0),
            rotation=lambda _: rotation,
            angular_velocity=lambda _: np.array([0.0, 0.0, yaw_rate]),
        )
    )


def angle_of(driver, path, place):
    car = vehicle()
    part = driver.part(car, path)
    symbols = ops.column([entry.symbol for entry in car.system.table.entries] or [ops.symbol("n")])
    values = [entry.value for entry in car.system.table.entries] or [0.0]
    law = ops.numeric([symbols], ops.column([part.wanted(place)]))
    return float(np.ravel(law(values))[0])


@pytest.mark.parametrize("distance", [3.0, 8.0, 15.0])
@pytest.mark.parametrize("along", [0.0, 0.2])
def test_pure_pursuit_on_a_circle_steers_by_the_angle_of_the_circle(distance, along):
    radius = 50.0
    rear = (radius * math.sin(along), radius * (1.0 - math.cos(along)))
    behind = FRONT - WHEELBASE
    x, y = rear[0] - behind * math.cos(along), rear[1] - behind * math.sin(along)

    def circle(at):
        return radius - ops.sqrt(radius**2 - at * at)

    found = angle_of(PurePursuit(distance=distance, **HANDS), circle, situation(x, y, along))
    assert found == pytest.approx(math.atan(WHEELBASE / radius), rel=1e-12)


def test_stanley_steers_by_offset_and_heading():
    driver = Stanley(gain=2.5, **HANDS)
    heading, offset, speed = 0.05, 0.4, 20.0
    y = -offset - FRONT * math.sin(heading)
    found = angle_of(driver, lambda x: 0.0 * x, situation(0.0, y, heading, (speed, 0.0)))
    assert found == pytest.approx(-heading + math.atan(2.5 * offset / speed), rel=1e-12)


def test_stanley_brings_a_rolling_car_to_its_path_as_its_equation_says():
    """Of a car that rolls without slip, ė = -k e / √(1 + (k e/v)²); integrated both ways."""
    gain, speed, step = 2.0, 10.0, 1e-3
    driver = Stanley(gain=gain, **HANDS)
    car = vehicle()
    part = driver.part(car, lambda x: 0.0 * x)
    x, y, heading = (ops.symbol(name) for name in "xyh")
    rotation = matrix_of([{0: ops.cos(heading)}, {0: ops.sin(heading)}, {}], 1)
    place = SimpleNamespace(
        kinematics=SimpleNamespace(
            position=lambda _: (x, y, 0.0), velocity=lambda _: (speed, 0.0, 0.0),
            rotation=lambda _: rotation,
        )
    )  # fmt: skip
    known = ops.column([entry.symbol for entry in car.system.table.entries])
    values = [entry.value for entry in car.system.table.entries]
    law = ops.numeric([ops.column([x, y, heading]), known], ops.column([part.wanted(place)]))
    front_y, course = -1.0, 0.0
    exact = 1.0
    for _ in range(800):
        at = [0.0, front_y - FRONT * math.sin(course), course]
        angle = float(np.ravel(law(at, values))[0])
        front_y += step * speed * math.sin(course + angle)
        course += step * speed * math.sin(angle) / WHEELBASE
        exact -= step * gain * exact / math.sqrt(1.0 + (gain * exact / speed) ** 2)
    assert -front_y == pytest.approx(exact, rel=2e-3)
    assert exact < 0.25


def test_macadams_gain_of_a_double_integrator_is_the_closed_form():
    """With g = τ²/2 the sums tend to integrals: Σ g/Σ g² = (T³/6)/(T⁵/20) = 10/(3 T²)."""
    matrix, given = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([0.0, 1.0])
    preview = 1.5
    single = optimal_gains(matrix, given, np.array([preview]))
    assert single.gains[0] == pytest.approx(2.0 / preview**2, rel=1e-12)  # MacAdam 1980
    times = preview * (np.arange(1, 2001) - 0.5) / 2000
    many = optimal_gains(matrix, given, times)
    assert many.gains.sum() == pytest.approx(10.0 / (3.0 * preview**2), rel=1e-6)
    assert many.free == pytest.approx(np.stack([np.ones_like(times), times], axis=1))


def macadam(**changes):
    numbers = {
        "preview_time": 1.0, "points": 12, "speed": 25.0, "mass": 1500.0, "yaw_inertia": 2400.0,
        "front_distance": 1.2, "rear_distance": 1.4,
        "front_stiffness": 9e4, "rear_stiffness": 1.1e5,
    }  # fmt: skip
    return MacAdam(**(numbers | changes), **HANDS)


def test_macadams_angle_keeps_the_predicted_car_nearest_to_the_path():
    """The gradient of the squared distance vanishes: predicted by Runge and Kutta's method."""
    driver = macadam()
    expected = prediction(driver)
    matrix, given = single_track(driver)
    state = np.array([0.1, -0.2, 0.05, 0.02])
    wanted = 0.5 * (1.0 - np.cos(2.0 * expected.times))
    angle = float(expected.gains @ (wanted - expected.free @ state))

    def lateral(delta):
        x, found, step = state.copy(), [], 1e-3
        for time in np.arange(round(1.0 / step)) * step:
            k1 = matrix @ x + given * delta
            k2 = matrix @ (x + 0.5 * step * k1) + given * delta
            k3 = matrix @ (x + 0.5 * step * k2) + given * delta
            k4 = matrix @ (x + step * k3) + given * delta
            x = x + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
            found.append((time + step, x[0]))
        times, ys = np.array(found).T
        return np.interp(expected.times, times, ys)

    def cost(delta):
        return float(((lateral(delta) - wanted) ** 2).sum())

    around = [cost(angle + change) for change in (-1e-3, 0.0, 1e-3)]
    lowest = angle + 0.5e-3 * (around[0] - around[2]) / (around[0] - 2 * around[1] + around[2])
    assert lowest == pytest.approx(angle, abs=1e-6)


def test_macadam_goes_straight_on_a_straight_path():
    found = angle_of(macadam(), lambda x: 0.0 * x + 3.0, situation(5.0, 3.0, 0.0, (25.0, 0.0)))
    assert found == pytest.approx(0.0, abs=1e-12)
