"""A vehicle that rolls over says when."""

from types import SimpleNamespace

import numpy as np
import pytest

from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.key_figures import _rollover


@pytest.mark.parametrize("angle", ["roll", "pitch"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_first_sample_beyond_a_right_angle_is_named(angle, sign):
    time = np.linspace(0.0, 2.0, 21)
    channels = {"car.roll": np.zeros(21), "car.pitch": np.zeros(21)}
    vehicle = SimpleNamespace(chassis="car")
    assert _rollover(Recording(time, channels), vehicle) == []
    channels[f"car.{angle}"] = sign * 1.6 * time
    (entry,) = _rollover(Recording(time, channels), vehicle)
    assert (entry.name, entry.value, entry.unit) == ("rolled_over_at", pytest.approx(1.0), "s")
