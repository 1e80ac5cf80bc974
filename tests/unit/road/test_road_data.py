"""A wheel that leaves the data of a road file is named with the time."""

from types import SimpleNamespace

import numpy as np

from vehicledyn.road.manoeuvres.channel_recorder import Rows
from vehicledyn.road.manoeuvres.road_data import RoadDataWatch
from vehicledyn.road.surfaces.flat import Flat
from vehicledyn.road.surfaces.heightfield import Heightfield

TIME = np.linspace(0.0, 1.0, 11)


def watch_on(surface):
    corners = [SimpleNamespace(name="left"), SimpleNamespace(name="right")]
    return RoadDataWatch(SimpleNamespace(surface=surface, corners=corners))


def test_the_first_wheel_that_leaves_the_grid(tmp_path):
    file = tmp_path / "g.asc"
    file.write_text("ncols 2\nnrows 2\nxllcorner 0\nyllcorner -2\ncellsize 4\n0 0\n0 0\n")
    watch = watch_on(Heightfield(file=str(file), x=-2.0))
    x, y = 4.0 * TIME, {"left": 1.0, "right": -0.5}
    channels = {
        f"{wheel}.contact_{axis}": x if axis == "x" else np.full(11, y[wheel])
        for wheel in y
        for axis in "xy"
    }
    assert set(watch.channels) == set(channels)
    for part in (slice(0, 4), slice(4, 11)):
        watch.take(Rows(TIME[part], {name: values[part] for name, values in channels.items()}))
    (entry,) = watch.entries()
    # The centres of the cells are the nodes: the grid spans x and y from 0 to 4 m.
    assert (entry.name, entry.value, entry.unit) == ("road_data_left_at", 0.0, "s")
    assert "right is beside the data" in entry.description


def test_ground_without_an_end_is_not_watched():
    watch = watch_on(Flat())
    assert watch.channels == []
    assert watch.entries() == []
