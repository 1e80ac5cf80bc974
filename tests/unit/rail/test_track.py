"""The frame of a track, and the arc coordinate of a point beside it."""

from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from pydantic import ValidationError

from vehicledyn.base.parameters import read_part
from vehicledyn.rail.tracks.straight import StraightTrack
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
