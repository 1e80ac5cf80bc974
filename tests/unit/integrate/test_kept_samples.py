"""Samples kept for key figures: chosen columns, in order, however many come."""

import numpy as np

from vehicledyn.integrate.kept_samples import KeptSamples


def test_more_samples_than_expected_are_kept():
    rng = np.random.default_rng(1)
    times, outputs = np.arange(9.0), rng.normal(size=(9, 4))
    kept = KeptSamples(4, [2, 0])
    for rows in (slice(0, 3), slice(3, 5), slice(5, 9)):
        assert np.array_equal(kept.take(times[rows], outputs[rows]), outputs[rows][:, [2, 0]])
    assert np.array_equal(kept.times, times)
    assert np.array_equal(kept.values, outputs[:, [2, 0]])


def test_nothing_kept_is_empty():
    kept = KeptSamples(4, [2, 0])
    assert kept.times.shape == (0,)
    assert kept.values.shape == (0, 2)
