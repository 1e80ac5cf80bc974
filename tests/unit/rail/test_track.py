"""The frame of a track, and the arc coordinate of a point beside it."""

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from pydantic import ValidationError

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import read_part
from vehicledyn.files.scenario import load_scenario
from vehicledyn.rail.track.kinds.straight import StraightTrack
from vehicledyn.rail.track.layout_pieces import grade_faults
from vehicledyn.rail.track.pieces import Grade
from vehicledyn.symbolic import ops

RAILS = {"kind": "straight", "gauge": "1435 mm", "inclination": "1/40", "rail": "60E1"}


def test_straight_track_spends_no_operations():
    track = read_part("track", RAILS).track(Path())
    s, guess = ops.symbol("s"), ops.symbol("guess")
    frame = track.frame(s)
    values = ca.vertcat(*frame.position[1:].nonzeros(), ca.vec(frame.rotation), *frame.turning.nz)
    assert not ca.depends_on(values, s)
    place = ops.vector(ops.symbol("x"), ops.symbol("y"), ops.symbol("z"))
    assert track.locate(place, guess).is_symbolic()
    assert track.rail_shift("left", s) == (0.0, 0.0)
    assert track.inclination == pytest.approx(np.arctan(0.025), abs=1e-15)
    function = ca.Function("f", [s], [ca.densify(values)])
    assert function.n_instructions() - values.numel() - 1 <= values.numel()


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("gauge", 1435, "less than 3"),
        ("inclination", "1/2", "at most 0.2"),
        ("inclination", "1:x", "1:x"),
        ("gauge", "1.4 kg", "unit"),
    ],
)
def test_impossible_rails_are_refused(field, value, words):
    with pytest.raises(ValidationError, match=words):
        StraightTrack.model_validate(
            {**{k: v for k, v in RAILS.items() if k != "kind"}, field: value}
        )


def test_a_profile_beside_the_file_is_found(tmp_path):
    (tmp_path / "worn.txt").write_text("0 0\n")
    assert read_part("track", {**RAILS, "rail": "worn.txt"}).track(tmp_path).rail == str(
        tmp_path / "worn.txt"
    )
    assert read_part("track", RAILS).track(tmp_path).rail == "60E1"


PENDULUM = "title: A rod\nbodies: {rod: {joints: [R2 a], mass: 1 kg, "
PENDULUM += "inertia: [1 kg*m^2, 1 kg*m^2, 0]}}\n"
LAYOUT = """\
title: A curve
model: pendulum.yaml
track:
  kind: layout
  gauge: 1435 mm
  inclination: 1/40
  rail: 60E1
  segments:
    - {kind: straight, length: 50 m}
    - {kind: clothoid, length: 40 m}
    - {kind: arc, length: 100 m, radius: 300 m, cant: 100 mm}
    - {kind: clothoid, length: 40 m}
    - {kind: straight, length: 50 m}
  gradients:
    - {at: 90 m, slope: 12 permil, radius: 3000 m}
duration: 1 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("cant: 100 mm", "cant: 100", "11:55: track.segments[2].cant: a cant of 100000 mm"),
        ("radius: 300 m,", "radius: 2 m,", "11:42: track.segments[2].radius: a curve of 2 m"),
        (
            "    - {kind: clothoid, length: 40 m}\n",
            "",
            "10:55: track.segments[1].cant: the cant jumps",
        ),
        ("length: 40 m", "length: 0 m", "10:32: track.segments[1].length: must be greater than 0"),
        ("clothoid", "clothid", "10:14: track.segments[1].kind: no segment named 'clothid'"),
        ("12 permil", "12", "15:25: track.gradients[0].slope: a gradient of 12 is too steep"),
        ("1435 mm", "1435", "5:10: track.gauge: must be less than 3 m, is 1435"),
    ],
)
def test_a_bad_layout_is_told_with_line_and_field(old, new, told, tmp_path):
    path = tmp_path / "curve.yaml"
    path.write_text(LAYOUT.replace(old, new, 1))
    (tmp_path / "pendulum.yaml").write_text(PENDULUM)
    with pytest.raises(InputError) as error:
        load_scenario(path)
    assert f"{path}:{told}" in str(error.value)


def test_gradients_that_overlap_are_refused():
    grades = [Grade(50.0, 0.01, 4000.0), Grade(80.0, -0.01, 4000.0)]
    assert [fault.number for fault in grade_faults(grades)] == [1]
    assert grade_faults([Grade(50.0, 0.01, 2000.0), Grade(90.0, -0.01, 2000.0)]) == []
