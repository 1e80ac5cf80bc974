"""Kalker's coefficients: smooth, joined to their asymptotes, the same as number or expression."""

import numpy as np
import pytest

from vehicledyn.rail.creep.kalker import asymptotes, creep_coefficients
from vehicledyn.symbolic import ops

NAMES = ("longitudinal", "lateral", "lateral_spin", "spin")


def values(ratio, nu):
    coefficients = creep_coefficients(ratio, nu)
    return np.array([float(getattr(coefficients, name)) for name in NAMES])


@pytest.fixture(scope="module")
def symbolic():
    """Coefficients and their logarithmic slopes as functions of l = ln(a/b) and ν."""
    place, nu = ops.symbol("place"), ops.symbol("nu")
    coefficients = creep_coefficients(ops.exp(place), nu)
    column = ops.column([ops.log(getattr(coefficients, name)) for name in NAMES])
    slope = ops.jacobian(column, place)
    return ops.numeric([place, nu], ops.stacked(column, slope, ops.jacobian(slope, place)))


@pytest.mark.parametrize("nu", [0.0, 0.1, 0.25, 0.28, 0.5])
@pytest.mark.parametrize("ratio", [1e-5, 0.03, 0.1, 0.55, 1.0, 1.9, 10.0, 40.0, 1e5])
def test_number_and_expression_agree(symbolic, ratio, nu):
    found = np.exp(symbolic(np.log(ratio), nu)[:4, 0])
    assert found == pytest.approx(values(ratio, nu), rel=1e-10)


def test_without_poissons_effect_both_directions_are_equal():
    for ratio in np.geomspace(0.1, 10.0, 30):
        coefficients = values(ratio, 0.0)
        assert coefficients[0] == pytest.approx(coefficients[1], rel=1e-12)


@pytest.mark.parametrize("nu", [0.0, 0.28, 0.5])
def test_no_kinks_and_no_waves(symbolic, nu):
    """Slopes stay between those of the two asymptotes, as far as the table's rounding allows."""
    places = np.linspace(np.log(3e-4), np.log(3e3), 1500)
    slopes = np.array([symbolic(place, nu)[4:8, 0] for place in places])
    lowest, highest = [-0.05, -0.03, 0.05, -1.1], [1.05, 1.05, 1.55, 0.1]
    assert (slopes > lowest).all() and (slopes < highest).all()
    assert np.abs(np.diff(slopes, axis=0)).max() < 0.05


@pytest.mark.parametrize("nu", [0.0, 0.25, 0.5])
def test_far_off_the_asymptotes_hold(nu):
    for ratio, apart in ((1e-3, 1e-3), (1e-4, 1e-3), (1e3, 0.03), (1e4, 0.02)):
        assert values(ratio, nu) == pytest.approx(asymptotes(ratio, nu), rel=apart)


@pytest.mark.parametrize("nu", [0.1, 0.28, 0.4])
def test_between_tabulated_poissons_ratios_the_asymptotes_hold_too(nu):
    for ratio, apart in ((1e-3, 5e-3), (1e3, 0.03)):
        assert values(ratio, nu) == pytest.approx(asymptotes(ratio, nu), rel=apart)
