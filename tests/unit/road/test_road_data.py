"""A wheel that leaves the data of a road file is named with the time."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from crg_files import crg

from vehicledyn.cli import main
from vehicledyn.cli.commands.files import read_file
from vehicledyn.road.manoeuvres.channel_recorder import ChannelRows
from vehicledyn.road.manoeuvres.road_data import RoadDataMonitor
from vehicledyn.road.surfaces.enveloped import Enveloped
from vehicledyn.road.surfaces.flat import Flat
from vehicledyn.road.surfaces.heightfield import Heightfield
from vehicledyn.road.surfaces.opencrg import OpenCrgRoad

ROOT = Path(__file__).parents[3]
TIME = np.linspace(0.0, 1.0, 11)


def watch_on(surface):
    corners = [SimpleNamespace(name="left"), SimpleNamespace(name="right")]
    return RoadDataMonitor(SimpleNamespace(surface=surface, corners=corners))


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
        watch.take(
            ChannelRows(TIME[part], {name: values[part] for name, values in channels.items()})
        )
    (entry,) = watch.entries()
    # The centres of the cells are the nodes: the grid spans x and y from 0 to 4 m.
    assert (entry.name, entry.value, entry.unit) == ("road_data_left_at", 0.0, "s")
    assert "right is beside the data" in entry.description


def test_ground_without_an_end_is_not_watched():
    watch = watch_on(Flat())
    assert watch.channels == []
    assert watch.entries() == []


def gapped(tmp_path):
    """A level road of 30 m with one missing height at u = 10 m, v = 0.5 m, filled by 1 m beside."""
    heights = np.zeros((31, 7))
    heights[:, 4] = 1.0
    heights[10, 5] = np.nan
    file = tmp_path / "gap.crg"
    file.write_bytes(crg(heights, places=np.linspace(-1.5, 1.5, 7) - 0.5))
    return OpenCrgRoad(file=str(file))


def test_a_wheel_on_missing_heights_is_named_with_time_and_place(tmp_path):
    watch = watch_on(gapped(tmp_path))
    x, y = 20.0 * TIME, {"left": 0.6, "right": -0.2}
    channels = {
        f"{wheel}.contact_{axis}": x if axis == "x" else np.full(11, y[wheel])
        for wheel in y
        for axis in "xy"
    }
    for part in (slice(0, 4), slice(4, 11)):
        watch.take(
            ChannelRows(TIME[part], {name: values[part] for name, values in channels.items()})
        )
    (entry,) = watch.entries()
    assert (entry.name, entry.value, entry.unit) == ("road_data_missing_at", TIME[5], "s")
    assert entry.description.endswith("filled: u = 10 m, v = 0.6 m")
    assert "left rolls" in entry.description


def test_heights_that_rest_on_a_missing_one_are_those_that_move_with_it(tmp_path):
    road = gapped(tmp_path).ground().road
    x, y = np.random.default_rng(2).uniform((8.0, -1.9), (12.0, 0.9), (400, 2)).T
    heights = road.heights.copy()
    heights[10, 5] += 1.0
    moves = abs(replace(road, heights=heights).height_at(x, y) - road.height_at(x, y)) > 1e-12
    assert moves.any()
    assert np.array_equal(road.lacks(x, y), moves)


def test_missing_heights_are_counted_with_the_first_place(tmp_path):
    assert "gap.crg: 1 of 217 height is missing, the first at u = 10 m, v = 0.5 m" in (
        gapped(tmp_path).gaps()
    )
    assert (
        Enveloped(road=gapped(tmp_path), cam_length=0.3, cam_height=0.3).gaps()
        == gapped(tmp_path).gaps()
    )


SCENARIO = """\
title: A car on a road with a gap, along a path through points far apart
model: small_car
speed: 20 m/s
road: {kind: opencrg, file: gap.crg}
manoeuvre:
  kind: path
  xs: [0 m, 40 m, 80 m]
  ys: [0 m, 0 m, 10 m]
  driver: {kind: preview, preview_time: 0.5 s, lag_frequency: 20 rad/s, lag_damping: 0.8,
    rack_stop: 50 mm}
  speed_control: {proportional_gain: 1000 N*s, integral_gain: 300 N}
duration: 4 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


def test_a_check_tells_missing_heights_and_a_path_that_dips(tmp_path, capsys, monkeypatch):
    gapped(tmp_path)
    file = tmp_path / "gap.yaml"
    file.write_text(SCENARIO)
    monkeypatch.setattr("sys.argv", ["vehicledyn", "validate", str(file)])
    with pytest.raises(SystemExit) as ended:
        main()
    assert not ended.value.code
    said = capsys.readouterr()
    assert said.out.endswith("gap.yaml: ok\n")
    first, second = said.err.splitlines()
    assert "gap.yaml: warning: " in first
    assert "1 of 217 height is missing, the first at u = 10 m, v = 0.5 m" in first
    assert "gap.yaml: manoeuvre: the spline" in second
    assert "swings 0.61 m aside between points 1 and 2" in second


def test_a_check_tells_missing_heights_of_the_road_of_a_system(tmp_path):
    gapped(tmp_path)
    car = (ROOT / "systems" / "small_car.yaml").read_text()
    road = "road: {kind: opencrg, file: gap.crg}"
    assert "road: {kind: flat}" in car
    (tmp_path / "car.yaml").write_text(car.replace("road: {kind: flat}", road))
    changed = SCENARIO.replace(f"{road}\n", "").replace("model: small_car", "model: car.yaml")
    (tmp_path / "drive.yaml").write_text(changed)
    warning, _ = read_file(tmp_path / "drive.yaml", None)
    assert "1 of 217 height is missing" in warning
    (alone,) = read_file(tmp_path / "car.yaml", None)
    assert alone == warning


STUDIES = {
    "sweep": """
scenario: smooth.yaml
cases: {kind: grid, vary: {road: [{kind: flat}, {kind: opencrg, file: gap.crg}]}}
output: {interval: 20 ms, channels: [body.*]}
""",
    "optimisation": """
scenarios: gap.yaml
variables: {body.mass: {from: 700 kg, to: 1200 kg}}
minimise: {max(body.roll): 1}
""",
    "uncertainty": """
scenario: gap.yaml
of: [max(body.roll)]
parameters: {body.mass: {kind: uniform, from: 700 kg, to: 1200 kg}}
""",
}


@pytest.mark.parametrize("kind", STUDIES)
def test_a_check_of_a_study_tells_missing_heights_and_paths_of_its_scenarios(
    kind, tmp_path, monkeypatch
):
    monkeypatch.setattr("vehicledyn.studies.optimisation.file.note_mistakes", lambda *_: None)
    monkeypatch.setattr("vehicledyn.studies.uncertainty.study.note_mistakes", lambda *_, **__: None)
    gapped(tmp_path)
    (tmp_path / "gap.yaml").write_text(SCENARIO)
    smooth = SCENARIO.replace("{kind: opencrg, file: gap.crg}", "{kind: flat}")
    (tmp_path / "smooth.yaml").write_text(smooth)
    (tmp_path / "study.yaml").write_text(f"title: Of a road with a gap{STUDIES[kind]}")
    told = " ".join(read_file(tmp_path / "study.yaml", None))
    assert told.count("1 of 217 height is missing") == 1
    assert told.count("swings 0.61 m aside") == 1
