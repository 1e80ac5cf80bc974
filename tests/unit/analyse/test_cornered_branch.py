"""The sense of a branch of limit cycles stays round a corner, where contact begins."""

import math

import numpy as np
import pytest
from cycle_examples import cornered_circles, field, sampled_orbit

from vehicledyn.analyse.periodic.collocation import Direction
from vehicledyn.analyse.periodic.multiple_shooting import closed, direction_of


def way(model, r, value, before):
    """Growth of the radius, of the parameter and the sense of the direction at a circle."""
    orbit = sampled_orbit(
        math.pi, value,
        lambda s: r * np.column_stack([np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)]),
    )  # fmt: skip
    found = closed(model, orbit)
    along, sense = direction_of(found, 0.2, before or Direction(orbit.states, 0.0, 0.0))
    outwards = orbit.states / r
    return float((along.states * outwards).sum(axis=1).mean()), along.parameter, sense, along


@pytest.mark.parametrize("back", [0.1, 4.0])
def test_the_sense_tells_the_way_on_round_a_corner(back):
    """μ = r, then μ = 1 - back (r - 1): the way on makes up to more than a right angle."""
    model = field(cornered_circles(back), "mu")
    growth, rise, sense, along = way(model, 0.99, 0.99, None)
    assert growth > 0.0 and rise == pytest.approx(growth, rel=1e-4)
    beyond, fall, own, _ = way(model, 1.01, 1.0 - 0.01 * back, along)
    assert sense * own != 0.0
    assert sense * own * beyond > 0.0
    assert fall == pytest.approx(-back * beyond, rel=1e-4)
    if back == 4.0:
        assert beyond < 0.0  # the nearer direction leads back
