"""Slip: definitions above the floors, finiteness below, reverse driving, signs."""

import math

import pytest

from vehicledyn.road.tyres.smooth import BLEND, floored
from vehicledyn.road.wheel.slip import (
    LATERAL_FLOOR,
    LONGITUDINAL_FLOOR,
    WheelMotion,
    longitudinal_slip,
    slip_angle,
)
from vehicledyn.symbolic import ops


@pytest.mark.parametrize("speed", [10.0, -10.0, LONGITUDINAL_FLOOR * (1 + BLEND) + 1e-9])
def test_slips_are_exact_above_the_floors(speed):
    motion = WheelMotion(speed, 0.3, speed / 0.36 + 1.0, 0.36)
    assert longitudinal_slip(motion, LONGITUDINAL_FLOOR) == pytest.approx(
        (motion.spin * 0.36 - speed) / abs(speed), abs=1e-15
    )
    assert slip_angle(motion, LATERAL_FLOOR) == math.atan(0.3 / abs(speed))


@pytest.mark.parametrize("speed", [6.0, -6.0])
def test_halving_the_floors_changes_nothing_above_them(speed):
    motion = WheelMotion(speed, 0.3, 20.0, 0.36)
    for law, floor in ((longitudinal_slip, LONGITUDINAL_FLOOR), (slip_angle, LATERAL_FLOOR)):
        assert law(motion, floor) == law(motion, 0.5 * floor)


def test_driving_is_positive_forwards_and_braking_positive_backwards():
    assert longitudinal_slip(WheelMotion(10, 0, 30, 0.36), 4.0) > 0.0
    assert longitudinal_slip(WheelMotion(10, 0, 0, 0.36), 4.0) == -1.0
    assert longitudinal_slip(WheelMotion(-10, 0, 0, 0.36), 4.0) == 1.0


def test_standing_wheel_has_no_slip_and_finite_slopes():
    names = [ops.symbol(k) for k in ("x", "y", "s")]
    motion = WheelMotion(*names, 0.36)
    slips = ops.column([longitudinal_slip(motion, 4.0), slip_angle(motion, 0.8)])
    values = ops.numeric(names, slips)(0, 0, 0)
    slopes = ops.numeric(names, ops.jacobian(slips, ops.column(names)))(0, 0, 0)
    assert list(values[:, 0]) == [0.0, 0.0]
    assert slopes[0] == pytest.approx([-1 / 4.0, 0.0, 0.36 / 4.0])
    assert slopes[1] == pytest.approx([0.0, 1 / 0.8, 0.0])


@pytest.mark.parametrize("value", [0.75, 1.0, 1.25])
def test_floor_is_continuous_with_its_slope(value):
    step = 1e-7
    below, at, above = (floored(value + k * step, 1.0) for k in (-1, 0, 1))
    assert at - below == pytest.approx(above - at, abs=1e-13)
    assert at >= 1.0


def test_floor_keeps_the_value_bit_for_bit_above():
    for value in (1.2500001, 1.3, 17.123456789):
        assert floored(value, 1.0) == value
    assert floored(-5.0, 1.0) == 1.0
