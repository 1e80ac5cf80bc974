"""Tracks and irregularities in files: what they mean, and what is wrong with bad ones."""

import casadi as ca
import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.contact.track_view import view_track
from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import read_part
from vehicledyn.files.scenario import load_scenario
from vehicledyn.symbolic import ops

RAILS = {"gauge": "1435 mm", "inclination": "1/40", "rail": "60E1"}
SEGMENTS = """\
# A curve to the right
kind, length [m], radius [m], cant [mm], widening [mm]
straight, 40
clothoid, 60
arc, 100, -300, -100, 5   # canted
bloss, 50
straight, 40
"""
WRITTEN = [
    {"kind": "straight", "length": 40},
    {"kind": "clothoid", "length": 60},
    {"kind": "arc", "length": 100, "radius": -300, "cant": -0.1, "widening": 0.005},
    {"kind": "bloss", "length": 50},
    {"kind": "straight", "length": 40},
]
OWN_FILE = """\
kind: layout_table
gauge: 1435 mm
inclination: 1/40
rail: 60E1
file: segments.csv
"""


def poses(track, places):
    s = ops.symbol("s")
    frame = track.frame(s)
    shifts = [ops.scalar(x) for side in ("left", "right") for x in track.rail_shift(side, s)]
    all_of_it = ca.vertcat(frame.position, ca.vec(frame.rotation), *shifts)
    function = ca.Function("f", [s], [ca.densify(all_of_it)])
    return np.array([np.array(function(p)).ravel() for p in places])


def test_table_yaml_and_file_of_its_own_are_one_track(tmp_path):
    (tmp_path / "segments.csv").write_text(SEGMENTS)
    (tmp_path / "track.yaml").write_text(OWN_FILE)
    written = read_part("track", {"kind": "layout", **RAILS, "segments": WRITTEN}).track(tmp_path)
    places = np.linspace(-5.0, 300.0, 37)
    for given in (
        {"kind": "layout_table", **RAILS, "file": "segments.csv"},
        {"kind": "file", "file": "track.yaml"},
    ):
        assert poses(read_part("track", given).track(tmp_path), places) == pytest.approx(
            poses(written, places), abs=1e-12
        )


def test_measured_track_is_the_layout_it_was_measured_on(tmp_path):
    """A clothoid, an even ramp and a rounded gradient are straight lines of their columns."""
    layout = {
        "kind": "layout",
        **RAILS,
        "cant_about": "low_rail",
        "segments": [
            {"kind": "straight", "length": 40},
            {"kind": "clothoid", "length": 60},
            {"kind": "arc", "length": 50, "radius": 250, "cant": 0.09},
        ],
        "gradients": [{"at": 70, "slope": 0.02, "radius": 2000}],
    }
    written = read_part("track", layout)
    design = written.alignment(tmp_path)
    s = np.arange(0.0, 151.0, 10.0)
    lines = ["s [m]; curvature [1/km]; cant [mm]; gradient [permil]; gauge [mm]"]
    slope = np.interp(s, [50.0, 90.0], [0.0, 20.0])
    for k, place in enumerate(s):
        bend, cant = 1e3 * design.curvature(place, "before"), 1e3 * design.cant(place)
        lines.append(f"{1200 + place}; {bend:.12g}; {cant:.12g}; {slope[k]:.12g}; 1441")
    (tmp_path / "measured.csv").write_text("\n".join(lines))
    given = {"kind": "measured", **RAILS, "cant_about": "low_rail", "file": "measured.csv"}
    track = read_part("track", given).track(tmp_path)
    places = np.linspace(0.0, 150.0, 31)
    found, wanted = poses(track, places), poses(written.track(tmp_path), places)
    assert found[:, :12] == pytest.approx(wanted[:, :12], abs=2e-8)
    assert found[:, 12] == pytest.approx(0.003, abs=1e-12)
    assert found[:, 14] == pytest.approx(-0.003, abs=1e-12)


def test_record_runs_through_its_values(tmp_path):
    s = np.sort(np.random.default_rng(2).uniform(0.0, 100.0, 300))
    s = np.unique(np.concatenate([np.arange(0.0, 100.1, 0.4), s[np.diff(s, prepend=-1) > 0.05]]))
    level, cross = 3.0 * np.sin(0.4 * s), 2.0 * np.cos(0.3 * s)
    rows = [f"{a},{b},{c}" for a, b, c in zip(s, level, cross, strict=True)]
    (tmp_path / "rough.csv").write_text("\n".join(["s [m],level [mm],cross_level [mm]", *rows]))
    given = {"kind": "record", "file": "rough.csv", "start": 20, "fade": 10, "scale": -2}
    shift = read_part("irregularity", given).shift(tmp_path)
    x = ops.symbol("s")
    both = [ops.scalar(v) for side in ("left", "right") for v in shift.at(side, x)]
    function = ca.Function("f", [x], [ca.vertcat(*both)])
    for place in (35.0, 61.23, 99.5):
        z, c = 6e-3 * np.sin(0.4 * (place - 20.0)), 4e-3 * np.cos(0.3 * (place - 20.0))
        expected = [0.0, -z + 0.5 * c, 0.0, -z - 0.5 * c]
        assert np.array(function(place)).ravel() == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("arc, 100, -300, -100", "arc, 100, -300, -100000", "5:17: cant: a cant of -100000 mm"),
        ("arc, 100, -300", "arc, 100, -2", "5:11: radius: a curve of -2 m is too tight"),
        ("clothoid, 60\n", "", "4:17: cant: the cant jumps from 0 mm to -100 mm"),
        ("clothoid, 60", "clothoid, 0", "4:11: length: must be greater than 0 m, is 0.0"),
        ("clothoid, 60", "clothoid", "4:1: length: the value is missing"),
        ("clothoid, 60", "clothoid, sixty", "4:11: length: 'sixty' is no number"),
        ("clothoid", "clotoid", "4:1: kind: no segment named 'clotoid'; did you mean 'clothoid'"),
        ("clothoid, 60", "clothoid, 60, 300", "4:15: radius: unknown key"),
        ("cant [mm]", "cant", "2:31: cant: say the unit of the column, such as 'cant [m]'"),
        ("cant [mm]", "cant [kg]", "2:31: cant: the unit 'kg' does not measure a quantity in m"),
        ("cant [mm]", "kant [mm]", "2:31: kant: no column named 'kant'; did you mean 'cant'"),
        ("kind, length [m]", "kind, kind", "2:7: kind: the column 'kind' is there twice"),
    ],
)
def test_bad_table_of_segments_is_told_with_its_lines(old, new, told, tmp_path):
    (tmp_path / "segments.csv").write_text(SEGMENTS.replace(old, new, 1))
    given = {"kind": "layout_table", **RAILS, "file": "segments.csv"}
    with pytest.raises(InputError) as error:
        read_part("track", given).track(tmp_path)
    assert f"{tmp_path / 'segments.csv'}:{told}" in str(error.value)


MEASURED = "s [m], curvature [1/km], cant [mm], gauge [mm]\n" + "\n".join(
    f"{10 * k}, {0.1 * k}, {k}, 1436" for k in range(20)
)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("50, 0.5, 5", "40, 0.5, 5", "7:1: s: the place is there twice"),
        ("50, 0.5, 5", "5, 0.5, 5", "7:1: s: 5 m comes after 40 m; sort the lines by s"),
        ("\n190, 1.9", "\n290, 1.9", "21:1: s: a gap of 110 m before this line"),
        ("50, 0.5, 5,", "50, 0.5, ,", "7:10: cant: the value is missing"),
        ("cant [mm]", "cant [m]", "3:10: cant: 1 m is too much for a gauge of 1435 mm"),
        ("gauge [mm]", "gauge [m]", "2:12: gauge: a gauge of 1.436e+06 mm is not one"),
        ("curvature [1/km]", "curvature [1/m]", "6:5: curvature: 0.4 1/m is too much"),
    ],
)
def test_bad_measured_track_is_told_with_its_lines(old, new, told, tmp_path):
    (tmp_path / "measured.csv").write_text(MEASURED.replace(old, new, 1))
    given = {"kind": "measured", **RAILS, "file": "measured.csv"}
    with pytest.raises(InputError) as error:
        read_part("track", given).track(tmp_path)
    assert f"{tmp_path / 'measured.csv'}:{told}" in str(error.value)


def test_a_scenario_tells_what_is_wrong_with_the_files_of_its_track(tmp_path):
    (tmp_path / "segments.csv").write_text(SEGMENTS.replace("clothoid, 60", "clothoid, sixty"))
    (tmp_path / "track.yaml").write_text(OWN_FILE.replace("1435 mm", "1435"))
    (tmp_path / "rider.yaml").write_text(
        "title: t\nbodies: {b: {joints: [{kind: track_frame, position: 0 m}, T2], mass: 1 kg}}\n"
    )
    path = tmp_path / "ride.yaml"
    rest = "model: rider.yaml\nduration: 1 s\nsolver: {kind: rk4, step: 1 ms}\n"
    path.write_text(f"title: t\ntrack: track.yaml\n{rest}output: {{interval: 0.1 s}}\n")

    def told():
        with pytest.raises(InputError) as error:
            load_scenario(path)
        return str(error.value).replace(f"{tmp_path}/", "")

    assert "ride.yaml:2:8: track: track.yaml:2:8: gauge: must be less than 3 m" in told()
    (tmp_path / "track.yaml").write_text(OWN_FILE)
    assert "ride.yaml:2:8: track: segments.csv:4:11: length: 'sixty' is no number" in told()
    (tmp_path / "segments.csv").unlink()
    assert "track: segments.csv: there is no such file" in told()
    (tmp_path / "segments.csv").write_text(SEGMENTS)
    assert load_scenario(path).resolved["track"] == {"kind": "file", "file": "track.yaml"}


def test_columns_of_the_printed_table_do_not_touch(tmp_path):
    (tmp_path / "segments.csv").write_text(SEGMENTS)
    (tmp_path / "track.yaml").write_text(OWN_FILE)
    report = view_track(tmp_path / "track.yaml", every=7.5).as_text()
    names, _, *rows = report.split("\n\n")[1].splitlines()
    assert len(rows) == 40
    assert {len(row.split()) for row in rows} == {len(names.split())}
