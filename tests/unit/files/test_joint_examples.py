"""The shipped examples of the quaternion joint and the screw against their closed forms."""

from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import vehicledyn as vd

SCENARIOS = Path(__file__).parents[3] / "scenarios" / "systems"


def test_t_handle_flips_with_the_period_of_the_closed_form():
    """ω = (a cn τ, b sn τ, c dn τ) from the middle axis on; the signs by symmetry."""
    result = vd.simulate(SCENARIOS / "t_handle.yaml")
    i1, i2, i3 = 0.4e-3, 0.7e-3, 1.0e-3
    w1, w2 = 0.05, 8.0
    twice, square = i1 * w1**2 + i2 * w2**2, (i1 * w1) ** 2 + (i2 * w2) ** 2
    pace = np.sqrt((i2 - i1) * (i3 * twice - square) / (i1 * i2 * i3))
    share = (i3 - i2) * (square - twice * i1) / ((i2 - i1) * (i3 * twice - square))
    # With more momentum than that of the middle axis the two outer axes change their parts.
    if share > 1.0:
        pace, share = pace * np.sqrt(share), 1.0 / share
    turning, time = np.asarray(result["handle.omega_y"]), np.asarray(result["time"])
    size = np.abs(turning).max()
    sn = ellipj(pace * time + ellipk(share), share)[0]
    assert np.abs(turning - size * sn).max() < 1e-4 * size
    assert np.diff(np.sign(turning)).nonzero()[0].size >= 2
    momentum = np.asarray(result["momentum"])
    assert np.ptp(momentum) < 1e-8 * momentum[0]


def test_load_sinks_on_its_screw_as_the_closed_form_says():
    result = vd.simulate(SCENARIOS / "screw_jack.yaml")
    h, mass, inertia, friction, g = 0.02 / (2.0 * np.pi), 200.0, 0.02, 0.05, 9.81
    last, constant = -mass * g * h / friction, (inertia + mass * h * h) / friction
    time = np.asarray(result["time"])
    rate = last * (1.0 - np.exp(-time / constant))
    assert np.asarray(result["nut.turn_rate"]) == pytest.approx(rate, rel=1e-8, abs=1e-8)
    assert np.asarray(result["load.velocity_z"]) == pytest.approx(h * rate, rel=1e-8, abs=1e-9)
