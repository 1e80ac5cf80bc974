"""Splines of equal cells are those of SciPy."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from vehicledyn.base.numbers.even_spline import even_spline


@pytest.mark.parametrize("count", [4, 5, 6, 40, 700])
def test_coefficients_are_those_of_scipy(count):
    values = np.random.default_rng(count).normal(size=count)
    expected = CubicSpline(np.arange(float(count)), values).c[::-1].T
    np.testing.assert_allclose(even_spline(values), expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("count", [2, 3])
def test_few_values_give_the_polynomial_through_them(count):
    values = np.array([1.5, -0.3, 0.9])[:count]
    expected = CubicSpline(np.arange(float(count)), values).c[::-1].T
    np.testing.assert_allclose(even_spline(values), expected, rtol=0, atol=1e-15)


def test_cubics_come_out_exactly():
    x = np.arange(9.0)
    cells = even_spline(x**3 - 2 * x)
    np.testing.assert_allclose(cells[4], [56.0, 46.0, 12.0, 1.0], rtol=1e-14)
