"""Integrals along splines, against SciPy's and against polynomials they hold exactly."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from vehicledyn.base.numbers.spline import spline_integral

ALGEBRA = 1e-12


@pytest.mark.parametrize("count", [2, 3, 4, 5, 60])
def test_integral_is_that_of_scipy(count):
    rng = np.random.default_rng(count)
    places = np.cumsum(rng.uniform(0.2, 1.5, count)) - 2.0
    values = rng.normal(size=count)
    expected = CubicSpline(places, values).antiderivative()(places)
    assert spline_integral(places, values) == pytest.approx(expected, rel=ALGEBRA, abs=ALGEBRA)


@pytest.mark.parametrize(("count", "degree"), [(2, 1), (3, 2), (4, 3), (9, 3)])
def test_polynomials_are_integrated_exactly(count, degree):
    places = np.linspace(-1.0, 2.0, count) ** 3
    polynomial = np.polynomial.Polynomial(np.arange(1.0, degree + 2.0))
    integral = polynomial.integ()
    expected = integral(places) - integral(places[0])
    assert spline_integral(places, polynomial(places)) == pytest.approx(
        expected, rel=ALGEBRA, abs=ALGEBRA * abs(expected).max()
    )
