"""What every kind of track must obey: its frame is one curve, consistent with its derivatives."""

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.parameters import read_part
from vehicledyn.base.registry import kinds
from vehicledyn.symbolic import ops

pytestmark = pytest.mark.long

RAILS = {"gauge": "1435 mm", "inclination": "1/40", "rail": "60E1"}
SEGMENTS = """\
kind, length [m], radius [m], cant [mm], widening [mm]
straight, 33.3
clothoid, 40
arc, 51.7, -200, -90, 10
cubic_parabola, 45
"""
MEASURED = "s [m], curvature [1/km], cant [mm], gradient [permil], gauge [mm]\n" + "\n".join(
    f"{7 * k}, {5 * np.sin(0.3 * k)}, {80 * np.sin(0.3 * k)}, {8 * np.cos(0.2 * k)}, {1435 + k % 3}"
    for k in range(30)
)
FILES = {
    "segments.csv": SEGMENTS,
    "measured.csv": MEASURED,
    "track.yaml": "kind: measured\ngauge: 1435 mm\ninclination: 1/20\nrail: 60E1\n"
    "file: measured.csv\ncant_about: low_rail\n",
}
EXAMPLES = {
    "straight": {},
    "layout_table": {"file": "segments.csv"},
    "measured": {"file": "measured.csv"},
    "file": {"file": "track.yaml"},
    "layout": {
        "cant_about": "low_rail",
        "segments": [
            {"kind": "straight", "length": 20.01},
            {"kind": "bloss", "length": 30},
            {"kind": "arc", "length": 25, "radius": 150, "cant": 0.12, "widening": 0.008},
            {"kind": "clothoid", "length": 41.234},
            {"kind": "arc", "length": 20, "radius": -180, "cant": -0.08},
            {"kind": "clothoid", "length": 30},
        ],
        "gradients": [
            {"at": 35, "slope": 0.02, "radius": 900},
            {"at": 130, "slope": -0.01, "radius": 1200},
        ],
    },
}
SHARPEST = 1.0 / 150.0
"""Largest jump of a rate of the examples, curvature or twist [1/m]."""

PLACES = (-7.0, 0.3, 41.7, 60.01, 93.3, 149.9, 500.0)


def track_of(kind, folder):
    for name, text in FILES.items():
        (folder / name).write_text(text)
    rails = {} if kind == "file" else RAILS
    return read_part("track", {"kind": kind, **rails, **EXAMPLES[kind]}).track(folder)


def frame_function(track):
    s = ops.symbol("s")
    frame = track.frame(s)
    outputs = [frame.position, frame.rotation, ca.SX(frame.stretch), frame.turning]
    function = ca.Function("frame", [s], [ca.densify(o) for o in outputs])
    return lambda value: [np.array(o).squeeze() for o in function(value)]


@pytest.mark.parametrize("kind", kinds("track"))
def test_the_frame_follows_its_curve(kind, tmp_path):
    at, step = frame_function(track_of(kind, tmp_path)), 1e-4
    for s in PLACES:
        _, rotation, stretch, turning = at(s)
        ahead, behind = at(s + step), at(s - step)
        tangent = (ahead[0] - behind[0]) / (2.0 * step)
        assert tangent == pytest.approx(stretch * rotation[:, 0], abs=1e-7)
        spin = rotation.T @ (ahead[1] - behind[1]) / (2.0 * step)
        assert [spin[2, 1], spin[0, 2], spin[1, 0]] == pytest.approx(turning, abs=1e-7)
        assert rotation.T @ rotation == pytest.approx(np.eye(3), abs=1e-13)


@pytest.mark.parametrize("kind", kinds("track"))
def test_the_riding_frame_is_smooth_and_never_far_from_that_of_the_track(kind, tmp_path):
    track, s = track_of(kind, tmp_path), ops.symbol("s")
    riding = ca.vertcat(*(ops.scalar(c) for c in track.line.riding(s)))
    frame = track.frame(s)
    bends = ca.jacobian(ca.jacobian(riding, s), s)
    turn = ca.vec(frame.rotation)
    function = ca.Function("both", [s], [riding, bends, frame.position, turn])
    step = 0.01
    places = np.arange(-5.0, 230.0, step)
    coordinates, bend, position, rotation = (np.array(o) for o in function(places[None, :]))
    assert np.abs(coordinates[:3] - position).max() < 2e-3
    ours = Rotation.from_euler("ZYX", coordinates[3:].T).as_matrix()
    theirs = rotation.T.reshape(-1, 3, 3).transpose(0, 2, 1)
    assert np.abs(ours - theirs).max() < 6e-3
    assert np.abs(np.diff(bend)).max() < 4.0 * step * SHARPEST


@pytest.mark.parametrize("kind", kinds("track"))
def test_a_point_beside_the_track_is_located_and_its_progress_known(kind, tmp_path):
    track, s, guess = track_of(kind, tmp_path), ops.symbol("s"), ops.symbol("guess")
    frame, beside = track.frame(s), ops.vector(0.0, 0.8, -0.4)
    point = frame.position + frame.rotation @ beside
    found = ca.Function("found", [s, guess], [ops.scalar(track.locate(point, guess))])
    rate = ops.derivative(point, s, 1.0)
    progress = track.progress(frame, beside, frame.rotation.T @ rate)
    one = ca.Function("one", [s], [ops.scalar(progress)])
    for place in PLACES:
        assert float(found(place, place + 1e-4)) == pytest.approx(place, abs=2e-9)
        # Slopes of tables that are wrong by 1e-8 m over cells of about a metre.
        assert float(one(place)) == pytest.approx(1.0, abs=2e-8)
