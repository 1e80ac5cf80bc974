"""Manoeuvres that name a coordinate are refused, with file and line, where there is none."""

import pytest

import vehicledyn.catalogue
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_scenario

assert vehicledyn.catalogue

SCENARIO = """title: A caravan sways
model: car_and_caravan
road: {kind: flat}
wheel_spin: free
speed: 25 m/s
manoeuvre:
  kind: trailer_sway
  amplitude: 20 deg
  articulation: caravan.body.yaw
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


def test_an_unknown_articulation_is_refused_with_file_and_line(tmp_path):
    path = tmp_path / "sway.yaml"
    path.write_text(SCENARIO.replace("caravan.body.yaw", "caravan.body.yw"), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_scenario(path)
    lines = str(caught.value).splitlines()
    place = f"{path}:9:17: manoeuvre.articulation: no coordinate named 'caravan.body.yw'"
    assert lines[0].startswith(place)
    assert "did you mean 'caravan.body.yaw'" in lines[0]


def test_an_unknown_articulation_of_an_option_names_the_option(tmp_path):
    path = tmp_path / "sway.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    assert load_scenario(path).scenario.manoeuvre.articulation == "caravan.body.yaw"
    with pytest.raises(InputError, match=r"^manoeuvre\.articulation: no coordinate named 'gone'"):
        load_scenario(path, ["manoeuvre.articulation=gone"])
