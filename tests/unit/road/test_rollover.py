"""A vehicle that rolls over says when."""

from types import SimpleNamespace

import numpy as np
import pytest

from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.key_figures import channels, summarise
from vehicledyn.road.surfaces.flat import Flat


@pytest.mark.parametrize("angle", ["roll", "pitch"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_first_sample_beyond_a_right_angle_is_named(angle, sign):
    time = np.linspace(0.0, 2.0, 21)
    vehicle = SimpleNamespace(
        chassis="car",
        rack="rack",
        corners=[SimpleNamespace(name="wheel")],
        system=SimpleNamespace(parts=()),
        surface=Flat(),
    )
    values = {name: np.zeros(21) for name in channels(vehicle)}
    assert rollovers(Recording(time, values), vehicle) == []
    values[f"car.{angle}"] = sign * 1.6 * time
    (entry,) = rollovers(Recording(time, values), vehicle)
    assert (entry.value, entry.unit) == (pytest.approx(1.0), "s")


def rollovers(recording, vehicle):
    return [e for e in summarise(recording, vehicle) if e.name == "rolled_over_at"]
