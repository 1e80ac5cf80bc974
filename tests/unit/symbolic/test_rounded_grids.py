"""Grids whose kinks across are rounded: the mean of the straight lines, with continuous slope."""

from itertools import pairwise

import numpy as np
import pytest

from vehicledyn.symbolic.grids.grid_table import GridTable

EVEN, UNEVEN = np.array([-1.0, 0.0, 1.0, 2.0]), np.array([-1.5, -1.25, 0.0, 2.0])
HEIGHTS = np.array([[0.0, 0.3, -0.2, 0.5], [0.1, 0.2, 0.0, 0.4], [0.4, -0.1, 0.3, 0.2]])
RADIUS = 0.05


def grids(v):
    return (GridTable("g", 0.0, 1.0, v, HEIGHTS, True, radius) for radius in (0.0, RADIUS))


@pytest.mark.parametrize("v", [EVEN, UNEVEN])
def test_heights_are_the_mean_over_the_rounded_width(v):
    sharp, rounded = grids(v)
    points, weights = np.polynomial.legendre.leggauss(2)
    for u in (0.0, 0.4, 1.7):
        for place in np.concatenate([v, v + 0.03, v - 0.02, [-3.0, 0.5, 5.0]]):
            ends = [place - RADIUS, *v[np.abs(v - place) < RADIUS], place + RADIUS]
            mean = sum(
                0.5 * (b - a) * w * float(sharp.value(u, 0.5 * (a + b) + 0.5 * (b - a) * x))
                for a, b in pairwise(ends)
                for x, w in zip(points, weights, strict=True)
            ) / (2.0 * RADIUS)
            assert float(rounded.value(u, place)) == pytest.approx(mean, abs=1e-14)


@pytest.mark.parametrize("v", [EVEN, UNEVEN])
def test_slopes_are_continuous_and_those_of_the_heights(v):
    _, rounded = grids(v)
    h = 1e-6
    for place in np.concatenate([v, v + RADIUS, v - RADIUS, v + 0.02]):
        before, after = (rounded.slopes(0.6, place + side)[1] for side in (-1e-9, 1e-9))
        assert float(after) == pytest.approx(float(before), abs=1e-6)
    for place in np.linspace(-2.0, 2.5, 46) + 0.003:
        along, across = (float(item) for item in rounded.slopes(0.6, place))
        by_u = (rounded.value(0.6 + h, place) - rounded.value(0.6 - h, place)) / (2 * h)
        by_v = (rounded.value(0.6, place + h) - rounded.value(0.6, place - h)) / (2 * h)
        assert (along, across) == pytest.approx((float(by_u), float(by_v)), abs=1e-8)


def test_nothing_is_rounded_far_from_the_sections():
    sharp, rounded = grids(EVEN)
    for v in (0.5, 9.0):
        assert float(rounded.value(0.3, v)) == pytest.approx(float(sharp.value(0.3, v)), rel=1e-14)
