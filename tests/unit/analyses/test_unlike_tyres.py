"""A wheel that has the property file of another size says so."""

import pytest

from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.validity.unlike_tyres import unlike_tyres
from vehicledyn.interface.targets import read_target

RUN = """
title: Other tyres
model: small_car
tyres:
  front: {{file: {front}}}
  rear: {{file: passenger_245_40R18_pac2002.tir}}
parameters: {{wheel: {{radius: 0.34 m}}}}
wheel_spin: free
speed: 10 m/s
manoeuvre: {{kind: straight}}
duration: 1 s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 10 ms}}
"""


@pytest.mark.parametrize(
    ("front", "told"),
    [("passenger_R0394_mf61.tir", 1), ("passenger_245_40R18_pac2002.tir", 0)],
)
def test_wheels_of_another_radius_than_their_file_are_told(tmp_path, front, told):
    (tmp_path / "run.yaml").write_text(RUN.format(front=front))
    found = list(unlike_tyres(build_subject(read_target(tmp_path / "run.yaml")).system))
    assert len(found) == told
    for words in found:
        assert words.startswith("front_left, front_right: passenger_R0394_mf61.tir is of a tyre of")
        assert "0.3943 m" in words
        assert "0.34 m" in words
