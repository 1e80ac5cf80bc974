"""The tractor with semitrailer against the geometry of off-tracking."""

import numpy as np
import pytest
from reference_cases.semitrailer import AXLES, CORNERING, FIFTH_WHEEL, GRAVITY, SCENARIO

import vehicledyn as vd

pytestmark = [pytest.mark.validation, pytest.mark.long]


def test_off_tracking_of_a_slow_turn():
    """The axles roll as one at Σ x²/Σ x, so that the articulation angle is its arcsine over R.

    The slip that the lateral acceleration takes, a/(g C/F), turns the trailer back.
    """
    run = vd.simulate(SCENARIO)
    names = ("tractor.x_rate", "tractor.y_rate", "tractor.yaw_rate", "tractor.yaw", "trailer.yaw")
    along, sideways, turn, yaw, articulation = (float(np.asarray(run[n])[-1]) for n in names)
    heading = np.array([np.cos(yaw), np.sin(yaw)])
    across = np.array([-heading[1], heading[0]])
    velocity = np.array([along, sideways]) + turn * FIFTH_WHEEL * across
    radius = np.hypot(*velocity) / turn
    length = (AXLES**2).sum() / -AXLES.sum()
    direction = np.arctan2(velocity @ across, velocity @ heading)
    slip = turn * np.hypot(*velocity) / (GRAVITY * CORNERING)
    assert direction - articulation == pytest.approx(np.arcsin(length / radius) - slip, rel=1e-2)
