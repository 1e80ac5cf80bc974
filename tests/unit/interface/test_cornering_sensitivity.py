"""Derivatives of yaw responses, held wheels, yaw moments and limits of acceleration of a car."""

import re

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError, NumericalError

OWN = ["body.*", "front.*", "rear.*", "track", "hub.*", "wheel.*"]
DISCRETE = [
    "steady(yaw_rate_gain, response, 1 Hz)",
    "steady(lateral_acceleration_phase, response, 1 Hz)",
    "steady(yaw_rate, constant_steering, 15 m/s)",
    "steady(yaw_acceleration, yaw_moments, -3 deg:3 deg:2, steering=2 deg)",
    "steady(smallest_wheel_load, yaw_moments, 3 deg, steering=2 deg)",
    "steady(eigenvalues, constant_speed, 1 m/s^2)",
]


def _moved(of, parts, table, h):
    """Return figures with parameters moved by parts of them."""
    new = zip(table.parameters, table.parameter_values + h * parts, strict=True)
    changes = {f"parameters.{p.name}": f"{float(v)!r} {p.unit}" for p, v in new}
    return vd.sensitivity("small_car", of, list(changes), set=changes).report.table.values


def _against_differences(of, to, size, *, rel):
    """Compare derivatives along random parts with Richardson's differences of turns found anew."""
    table = vd.sensitivity("small_car", of, to).report.table
    values = np.array(table.parameter_values)
    parts = values * np.random.default_rng(8).uniform(-1.0, 1.0, len(values))
    wide, near = (
        (_moved(of, parts, table, h) - _moved(of, parts, table, -h)) / (2.0 * h)
        for h in (size, 0.5 * size)
    )
    along, most = table.slopes @ parts, np.abs(table.slopes * parts).sum(axis=1)
    floor = 1e-9 * most.max()
    missed = np.abs(along - (4.0 * near - wide) / 3.0) / np.maximum(most, floor)
    assert missed == pytest.approx(0.0, abs=rel)


@pytest.mark.long
def test_points_of_turns_follow_all_parameters():
    _against_differences(DISCRETE, OWN, 4e-3, rel=1e-8)


@pytest.mark.long
def test_limits_of_acceleration_follow_the_track():
    """A limit in driving, found anew as a fold."""
    of = "steady(limit, acceleration_limits, 1 m/s^2)"
    _against_differences(of, "track", 2e-3, rel=1e-8)


@pytest.mark.long
def test_gradients_with_the_wheel_held_follow_where_the_points_lie():
    of = "steady(sideslip_gradient, constant_steering, steering=1 deg)"
    table = vd.sensitivity("small_car", of, "body.mass").report.table
    high, low = (_moved(of, table.parameter_values, table, h)[0] for h in (2e-5, -2e-5))
    exact = (high - low) / (4e-5 * table.parameter_values[0])
    assert table.slopes[0, 0] == pytest.approx(exact, rel=1e-8)


@pytest.mark.long
def test_two_smallest_loads_have_no_derivative():
    of = ["steady(smallest_wheel_load, yaw_moments, 0 deg)"]
    table = vd.sensitivity("small_car", [*of, DISCRETE[0]], ["body.mass"]).report.table
    assert np.isfinite(table.slopes).all()  # both move alike
    with pytest.raises(NumericalError, match="no balance at 40 deg of side-slip angle"):
        vd.sensitivity("small_car", "steady(yaw_acceleration, yaw_moments, 40 deg)")


@pytest.mark.parametrize(
    ("of", "match"),
    [
        ("steady(yaw_rate_gain, response)", "needs frequencies, such as 1 Hz"),
        ("steady(yaw_rate_gain, response, 0 Hz)", "frequencies must be above zero"),
        ("steady(yaw_rate_gain, constant_speed, 1 m/s^2)", "no quantity named 'yaw_rate_gain'"),
        ("steady(limit, acceleration_limits)", "needs accelerations along the path"),
        ("steady(braking, acceleration_limits, 1 m/s^2)", "give no values"),
        ("steady(yaw_acceleration, yaw_moments, 1 deg, radius=9 m)", "no setting named 'radius'"),
        ("steady(yaw_rate, constant_steering, 10 m/s, speed=0 m/s)", "speed must be above zero"),
    ],
)
def test_names_are_checked(of, match):
    with pytest.raises(InputError, match=re.escape(match)):
        vd.sensitivity("small_car", of)
