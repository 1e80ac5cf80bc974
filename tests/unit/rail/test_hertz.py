"""Hertz's contact: exact integrals, smooth shape, force and approach, limits, conforming bodies."""

import math

import numpy as np
import pytest
from scipy.special import ellipe, ellipkm1

from vehicledyn.rail.geometry.hertz import (
    CURVATURE_FLOOR,
    effective_modulus,
    hertz,
    is_hertzian,
)
from vehicledyn.rail.geometry.hertz_shape import ellipse_shape, exact_shape
from vehicledyn.symbolic import ops

MODULUS = 1.1e11


@pytest.mark.parametrize("g", [1e-3, 0.02, 0.3, 0.9, 0.999999])
def test_exact_shape_by_other_elliptic_integrals(g):
    ratio, shape = exact_shape(g)
    k, e = ellipkm1(g * g), ellipe(1.0 - g * g)
    m = (2.0 * e / math.pi / g**2) ** (1.0 / 3.0)
    assert shape.semi_axis_x == pytest.approx(m, rel=1e-12)
    assert shape.semi_axis_y == pytest.approx(g * m, rel=1e-12)
    assert shape.approach == pytest.approx(2.0 * k / math.pi / m, rel=1e-12)
    if g < 0.99:  # the textbook's form loses its digits for circles
        assert ratio == pytest.approx((k - e) * g * g / (e - g * g * k), rel=1e-11)


def test_smooth_shape_over_its_whole_range():
    worst = 0.0
    for g in np.geomspace(3e-3, 0.9999, 500):
        ratio, exact = exact_shape(g)
        if ratio < 1e-4:
            continue
        for shape, turned in ((ellipse_shape(ratio), False), (ellipse_shape(1.0 / ratio), True)):
            axes = shape.semi_axis_x, shape.semi_axis_y
            x, y = reversed(axes) if turned else axes
            found = np.array([x, y, shape.approach])
            wanted = np.array([exact.semi_axis_x, exact.semi_axis_y, exact.approach])
            worst = max(worst, np.abs(found / wanted - 1.0).max())
    assert worst < 1e-7


def test_sphere():
    """Johnson (1985), equations 4.22 to 4.24: sphere of radius R on a plane."""
    radius, force = 0.46, 5e4
    contact = hertz(0.5 / radius, 0.5 / radius, MODULUS)
    ellipse = contact.ellipse(force)
    a = (3.0 * force * radius / (4.0 * MODULUS)) ** (1.0 / 3.0)
    assert ellipse.semi_axis_x == pytest.approx(a, rel=1e-7)
    assert ellipse.semi_axis_y == pytest.approx(a, rel=1e-7)
    assert contact.approach(force) == pytest.approx(a * a / radius, rel=1e-7)
    p = (6.0 * force * MODULUS**2 / (math.pi**3 * radius**2)) ** (1.0 / 3.0)
    assert ellipse.largest_pressure(force) == pytest.approx(p, rel=1e-7)


def test_slender_ellipse_becomes_a_line_contact():
    """Half width of a line contact b² = 4 N' /(π E* 2B), with the load 3N/(4a) in the middle."""
    force, a, b = 1e4, 2e-4, 2.0
    ellipse = hertz(a, b, MODULUS)  # A is below the floor and B/A held at 200
    assert ellipse.curvature_sum == pytest.approx(CURVATURE_FLOOR + b)
    contact = hertz(0.02, 200.0, MODULUS).ellipse(force)
    line = 0.75 * force / contact.semi_axis_x
    width = math.sqrt(4.0 * line / (math.pi * MODULUS * 400.0))
    assert contact.semi_axis_y == pytest.approx(width, rel=2e-3)


@pytest.mark.parametrize("curvatures", [(1.09, 1.67), (1.67, 1.09), (1.1, 40.0), (0.5, 0.5)])
def test_force_and_approach_undo_each_other(curvatures):
    contact = hertz(*curvatures, MODULUS)
    for force in (1.0, 1e3, 1e5):
        approach = contact.approach(force)
        assert contact.force(approach) == pytest.approx(force, rel=1e-12)
        by_force, by_approach = contact.ellipse(force), contact.ellipse_at(approach)
        assert by_force.semi_axis_x == pytest.approx(by_approach.semi_axis_x, rel=1e-12)
        assert by_force.semi_axis_y == pytest.approx(by_approach.semi_axis_y, rel=1e-12)


def test_turning_the_axes_turns_the_ellipse():
    one, other = hertz(1.0, 3.0, MODULUS).ellipse(1e4), hertz(3.0, 1.0, MODULUS).ellipse(1e4)
    assert one.semi_axis_x == pytest.approx(other.semi_axis_y, rel=1e-14)
    assert one.semi_axis_x > one.semi_axis_y


def test_apart_there_is_no_force_and_all_slopes_are_finite():
    a, b, x = (ops.symbol(name) for name in "abx")
    contact = hertz(a, b, MODULUS)
    ellipse = contact.ellipse_at(x)
    loaded = contact.ellipse(x)
    column = ops.column(
        [contact.force(x), ellipse.semi_axis_x, ellipse.semi_axis_y, loaded.semi_axis_x]
    )
    value = ops.numeric([a, b, x], column)
    slope = ops.numeric([a, b, x], ops.jacobian(column, ops.column([a, b, x])))
    for felt in ((1.0, 2.0, -1e-3), (1.0, 1.0, 0.0), (-5.0, 1.0, 1e-5), (0.0, 0.0, 0.0)):
        assert np.isfinite(value(*felt)).all() and np.isfinite(slope(*felt)).all(), felt
        assert (value(*felt)[1:] > 0.0).all()
    assert value(1.0, 2.0, -1e-3)[0, 0] == 0.0
    assert float(hertz(1.0, 2.0, MODULUS).approach(-5.0)) == 0.0


def test_conforming_bodies_are_told():
    assert is_hertzian(1.09, 1.67)
    assert not is_hertzian(1.09, -0.1)
    assert not is_hertzian(1.09, 0.0)
    assert not is_hertzian(1.0, 2e4)


def test_modulus_of_equal_and_of_unequal_bodies():
    assert effective_modulus(2.1e11, 0.28, 2.1e11, 0.28) == pytest.approx(
        2.1e11 / (2.0 * (1.0 - 0.28**2)), rel=1e-14
    )
    rigid = effective_modulus(2.1e11, 0.28, 1e30, 0.28)
    assert rigid == pytest.approx(2.1e11 / (1.0 - 0.28**2), rel=1e-12)
