"""Tyres of files in scenarios: found beside the scenario or in the library, checked with it."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.build_model import build_vehicle
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_scenario
from vehicledyn.road.manoeuvres.channel_recorder import ChannelRows
from vehicledyn.road.manoeuvres.tyre_ranges import RangeMonitor
from vehicledyn.road.wheel.road_wheel import RoadWheel

SLALOM = Path(__file__).parents[3] / "scenarios" / "iltis_slalom.yaml"
LIBRARY = Path(__file__).parents[3] / "vehicledyn" / "library" / "tyres"


def scenario(folder, tyre):
    text = SLALOM.read_text().replace("kind: magic_formula_1987", tyre)
    (folder / "s.yaml").write_text(text)
    return folder / "s.yaml"


def test_file_of_the_library(tmp_path):
    vehicle = build_vehicle(load_scenario(scenario(tmp_path, "file: passenger_R0394_mf61.tir")))
    wheels = [part for part in vehicle.system.parts if isinstance(part, RoadWheel)]
    mirrored = {w.name: w.tyre.mirror for w in wheels}
    assert {name: mirror == "always" for name, mirror in mirrored.items()} == {
        name: name.endswith("l") for name in mirrored
    }


def test_file_beside_the_scenario_is_checked_with_it(tmp_path):
    text = (LIBRARY / "passenger_R0394_mf61.tir").read_text()
    (tmp_path / "a.tir").write_text(text.replace("PKY1 =", "PKX9 ="))
    with pytest.raises(InputError, match=r"4:1: tyres.front: .*a.tir: PKY1: missing"):
        load_scenario(scenario(tmp_path, "file: a.tir"))
    with pytest.raises(InputError, match=r"tyres.rear: .*b.tir: there is no such file"):
        load_scenario(scenario(tmp_path, "file: b.tir"))


def test_ranges_that_a_run_leaves_are_reported(tmp_path):
    vehicle = build_vehicle(load_scenario(scenario(tmp_path, "file: passenger_R0394_mf61.tir")))
    watch = RangeMonitor(vehicle)
    assert len(watch.channels) == 16
    time = np.linspace(0.0, 1.0, 11)
    channels = dict.fromkeys(watch.channels, 0.0 * time)
    channels["wheel_fl.tyre.slip_angle"] = np.where(time > 0.45, -2.0 * time, 0.0)
    channels["wheel_rr.tyre.normal_force"] = 20e3 * time
    watch.take(ChannelRows(time, channels))
    watch.take(ChannelRows(time + 1.0, dict.fromkeys(watch.channels, 0.0 * time)))
    entries = {entry.name: entry for entry in watch.entries()}
    assert set(entries) == {"wheel_fl_slip_angle_outside_range", "wheel_rr_load_outside_range"}
    angle = entries["wheel_fl_slip_angle_outside_range"]
    assert angle.value == -2.0 and "-0.96 to 0.96 rad" in angle.description
    assert "first at 0.5 s" in angle.description
    usual = build_vehicle(load_scenario(scenario(tmp_path, "kind: magic_formula_1987")))
    assert RangeMonitor(usual).channels == []
