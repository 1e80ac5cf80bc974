"""The stabiliser of the caravan damps beyond the critical speed."""

import pytest
from reference_cases.caravan import SPEEDS, driven

pytestmark = [pytest.mark.validation, pytest.mark.long]


def test_the_stabiliser_damps_beyond_the_critical_speed():
    """Without it the damping is negative there, see above."""
    ((held, _),) = driven(
        SPEEDS[1:],
        caravan__stabiliser__torque="250 N*m",
        manoeuvre__free_after="0.2 s",
        duration="5 s",
    )
    assert held > 0.0
