"""Key figures found block by block are those of all samples at once."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from vehicledyn.analyses.preparation import energy_figures
from vehicledyn.road.drivers.driver import Driver
from vehicledyn.road.manoeuvres import channel_recorder, key_figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.kinds.slalom import Slalom
from vehicledyn.road.surfaces.flat import Flat

COUNT = 1000
TIME = np.sort(np.append(np.linspace(0.0, 5.0, COUNT - 2), [1.3, 1.3]))  # an event's two samples
VEHICLE = SimpleNamespace(
    chassis="body",
    rack="rack",
    system=SimpleNamespace(parts=()),
    surface=Flat(),
    corners=[SimpleNamespace(name="left"), SimpleNamespace(name="right")],
    outline=[(2.0, 1.0), (-2.0, 1.0), (-2.0, -1.0), (2.0, -1.0)],
)


@pytest.fixture
def recording():
    random = np.random.default_rng(4)
    values = {
        name: np.cumsum(random.normal(size=COUNT)) / 10.0 for name in key_figures.channels(VEHICLE)
    }
    values |= {"body.x": 5.0 * TIME, "body.y": np.sin(3.0 * TIME), "body.yaw": 0.3 * np.cos(TIME)}
    values |= {"energy.kinetic": np.cos(TIME) ** 2, "energy.gravity": 0.5 * TIME}
    values["power.forces"] = np.sin(7.0 * TIME)
    return Recording(TIME, values)


def in_blocks(monkeypatch, size):
    for module in (channel_recorder, energy_figures):
        monkeypatch.setattr(module, "BLOCK", size)


def close(found, known):
    assert [(entry.name, entry.value) for entry in found] == [
        (entry.name, entry.value if isinstance(entry.value, str) else pytest.approx(entry.value))
        for entry in known
    ]


@pytest.mark.parametrize("size", [1, 7, 333])
def test_figures_of_a_road_vehicle_in_a_slalom(monkeypatch, recording, size):
    course = Slalom.model_construct(
        cones=4, spacing=5.0, first_cone=4.0, cone_radius=0.2, path_offset=1.0, driver=Driver
    )
    whole = course.summarise(recording, VEHICLE)
    values = recording.channels
    by_name = {entry.name: entry.value for entry in whole}
    assert by_name["largest_roll_angle"] == np.abs(values["body.roll"]).max()
    assert by_name["speed_mean"] == pytest.approx(values["body.forward_speed"].mean())
    in_blocks(monkeypatch, size)
    close(course.summarise(recording, VEHICLE), whole)


@pytest.mark.parametrize("size", [7, 333, COUNT])
def test_the_energy_error(monkeypatch, recording, size):
    values = recording.channels
    times, first = np.unique(TIME, return_index=True)
    work = CubicSpline(times, values["power.forces"][first], bc_type="not-a-knot").antiderivative()
    gained = values["energy.kinetic"] + values["energy.gravity"] - 1.0
    in_blocks(monkeypatch, size)
    (entry,) = energy_figures.energy_error(recording)
    assert entry.value == pytest.approx(np.abs(gained - work(TIME)).max(), rel=1e-12)


def test_a_value_that_is_no_number_stays_one(monkeypatch, recording):
    in_blocks(monkeypatch, 10)
    recording.channels["rack"][501] = np.nan
    low, high = energy_figures.ranges(recording, ["rack", "body.x"])
    assert np.isnan([low["rack"], high["rack"]]).all()
    assert (low["body.x"], high["body.x"]) == (0.0, 25.0)
