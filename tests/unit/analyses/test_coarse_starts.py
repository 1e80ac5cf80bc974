"""Starts at which neighbouring numbers are too far apart are refused, whoever gives them."""

from types import SimpleNamespace

import numpy as np
import pytest

from vehicledyn.analyses.preparation.coarse_starts import refuse_coarse_start
from vehicledyn.base.errors import InputError

EQUATIONS = SimpleNamespace(
    states=[
        SimpleNamespace(name="arm.angle", unit="rad"),
        SimpleNamespace(name="arm.angle_rate", unit="rad/s"),
        SimpleNamespace(name="pressure", unit="Pa"),
    ],
    positions=(0,),
    velocities=(1,),
)


@pytest.mark.parametrize("value", [1e17, -1e308, 7e7, np.inf, np.nan])
def test_large_starts_are_refused_by_name(value):
    with pytest.raises(InputError, match=r"'arm\.angle_rate': .* is too large to start") as told:
        refuse_coarse_start(EQUATIONS, np.array([1.0, value, 0.0]))
    assert list(told.value.about) == ["arm.angle_rate"]


def test_usual_starts_and_other_states_pass():
    refuse_coarse_start(EQUATIONS, np.array([6e7, -6e7, 1e12]))
