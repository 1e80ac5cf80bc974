"""Damping from the extremes of an oscillation against the oscillation it was made from."""

import numpy as np
import pytest

from vehicledyn.road.standards.decay import decay_of


@pytest.mark.parametrize("sigma", [0.3, -0.2])
def test_damping_of_a_known_oscillation_with_an_offset(sigma):
    time = np.arange(0.0, 6.0, 0.01)
    omega = 5.0
    found = decay_of(time, 0.4 + 0.1 * np.exp(-sigma * time) * np.cos(omega * time + 0.7))
    assert found.damping_ratio == pytest.approx(sigma / np.hypot(sigma, omega), rel=1e-3)
    assert found.frequency == pytest.approx(omega / (2.0 * np.pi), rel=1e-4)


def test_too_few_extremes_show_no_damping():
    time = np.arange(0.0, 1.0, 0.01)
    assert np.isnan(decay_of(time, np.cos(5.0 * time)).damping_ratio)
