"""The filter of a sensor, against closed forms."""

import numpy as np
import pytest

from vehicledyn.studies.identification.low_pass import LowPass

TIMES = np.concatenate([[0.0, 0.03], np.linspace(0.04, 0.5, 24), [0.5, 0.51, 0.58, 1.0]])
"""Uneven, with a step that has no length, as at an event."""


def test_filters_of_ramps_lag_as_their_closed_forms():
    """First and second order from rest, exact at uneven samples, on top of a level."""
    frequency = 1.7
    s = 2.0 * np.pi * frequency * TIMES
    first = s - 1.0 + np.exp(-s)
    r = np.sqrt(0.5)
    second = s - 2.0 * r + 2.0 * r * np.exp(-r * s) * np.cos(r * s)
    signals = np.stack([s, 3.0 + 2.0 * s], axis=1)
    for order, expected in ((1, first), (2, second)):
        found = LowPass(frequency, order).applied(TIMES, signals)
        assert found[:, 0] == pytest.approx(expected, abs=1e-12)
        assert found[:, 1] == pytest.approx(3.0 + 2.0 * expected, abs=1e-12)


def test_oscillations_at_the_corner_fall_by_three_decibels():
    """Of any order, once the start has died away."""
    times = np.linspace(0.0, 12.0, 4801)
    found = LowPass(1.0, 4).applied(times, np.sin(2.0 * np.pi * times)[:, None])
    assert np.max(np.abs(found[times > 10.0])) == pytest.approx(np.sqrt(0.5), rel=1e-3)
