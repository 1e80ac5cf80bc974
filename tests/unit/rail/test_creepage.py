"""Creepages and their reference speed."""

import pytest

from vehicledyn.rail.creep.creepage import SPEED_FLOOR, creepages
from vehicledyn.symbolic import ops


def test_creepages_of_a_braked_wheel_that_steers_left():
    """At 20 m/s, 460 mm radius, spinning 2 % too slowly, yawed 1 mrad, tread at 25 mrad."""
    speed, radius = 20.0, 0.46
    rate = 0.98 * speed / radius
    found = creepages((speed - rate * radius, -1e-3 * speed), -rate * 0.025, speed)
    assert found.longitudinal == pytest.approx(0.02, rel=1e-6)
    assert found.lateral == pytest.approx(-1e-3, rel=1e-6)
    assert found.spin == pytest.approx(-0.98 * 0.025 / radius, rel=1e-6)


def test_direction_of_travel_changes_no_sign():
    ahead = creepages((0.1, 0.2), 0.3, 10.0)
    assert ahead == creepages((0.1, 0.2), 0.3, -10.0)


def test_at_standstill_all_stays_finite():
    speed = ops.symbol("speed")
    found = creepages((0.01, 0.0), 0.0, speed).longitudinal
    value = ops.numeric([speed], ops.stacked(found, ops.jacobian(found, speed)))
    assert value(0.0)[:, 0] == pytest.approx([0.01 / SPEED_FLOOR, 0.0])
