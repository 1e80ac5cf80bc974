"""Cams in files: tables, drawings, pictures, and files that are refused with line and remedy."""

import re

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyses.cams.view import view_cam
from vehicledyn.base.errors import InputError
from vehicledyn.cams.cam_file import read_cam

TEXT = """\
title: An intake cam
motion:
  - {kind: polynomial_4567, over: 65 deg, lift: 9 mm}
  - {kind: harmonic, over: 65 deg, lift: -9 mm}
  - {kind: dwell, over: 230 deg}
base_radius: 30 mm
follower: {kind: roller, radius: 9 mm}
load: {speed: 3000 rpm, mass: 0.2 kg, stiffness: 40 N/mm, preload: 250 N}
steps: 90
"""


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "intake.yaml"
    path.write_text(TEXT)
    return path


def vertices(path, layer):
    """Return the points of the polyline of a layer of a DXF file, and all entities, [mm]."""
    lines = path.read_text().splitlines()
    pairs = list(zip(map(int, lines[::2]), lines[1::2], strict=True))
    entities, values = [], []
    for code, value in pairs:
        if code == 0:
            values.append({})
            entities.append(value)
        elif values:
            values[-1].setdefault(code, value)
    found = [
        (float(v[10]), float(v[20]))
        for name, v in zip(entities, values, strict=True)
        if name == "VERTEX" and v[8] == layer
    ]
    return np.array(found), entities


def test_a_table_holds_the_cam_and_reads_back(file, tmp_path):
    cam = read_cam(file)
    report = view_cam(cam, output=tmp_path / "t.csv")
    rows = np.genfromtxt(tmp_path / "t.csv", delimiter=",", skip_header=1)
    assert rows.shape == (91, 1 + len(report.table.columns))
    assert rows[:, 1] == pytest.approx(report.table.columns["lift"].values, rel=1e-13)
    view_cam(cam, output=tmp_path / "t.h5")
    data = vd.open_result(tmp_path / "t.h5")
    assert (data.kind, data.model) == ("cam", "roller")
    assert data["lift"].values == pytest.approx(rows[:, 1], rel=1e-13)
    assert data["lift"].unit == "m" and data.attributes["greatest_lift"] == pytest.approx(0.009)
    text = report.as_text()
    assert "the acceleration jumps at 65, 130 deg" in text
    assert re.search("the normal force is below zero from .* take a stronger spring", text)


def test_a_drawing_is_a_closed_polyline_within_its_tolerance(file, tmp_path):
    cam = read_cam(file)
    view_cam(cam, profile=tmp_path / "p.dxf", tolerance=1e-6)
    points, entities = vertices(tmp_path / "p.dxf", "PROFILE")
    assert entities.count("SECTION") == entities.count("ENDSEC") == 3
    assert entities.count("POLYLINE") == entities.count("SEQEND") == 2
    assert entities[-1] == "EOF"
    exact = 1e3 * cam.geometry(np.linspace(0.0, 2.0 * np.pi, 40_001)).profile.T
    closed = np.vstack([points, points[:1]])
    middle = 0.5 * (closed[1:] + closed[:-1])[::7]
    nearest = [np.hypot(*(exact - point).T).min() for point in middle]
    assert max(nearest) < 1e-3 + 3e-3  # [mm], tolerance and spacing of the samples
    view_cam(cam, profile=tmp_path / "p.csv", tolerance=1e-5)
    rows = np.genfromtxt(tmp_path / "p.csv", delimiter=",", skip_header=1)
    assert rows[:3] == pytest.approx(1e3 * cam.geometry(cam.samples(len(rows))).profile.T[:3])


def test_cams_from_python(tmp_path):
    disc = {
        "outline": {"kind": "eccentric_circle", "radius": "40 mm", "eccentricity": "10 mm"},
        "follower": {"kind": "flat"},
        "load": {"speed": 120, "mass": 0.5, "stiffness": 2000, "preload": 20},
    }
    found = vd.cam(disc, angles=[0.0, 1.0, "90 deg"], profile=tmp_path / "disc.dxf")
    assert found["lift"].values == pytest.approx(0.01 * (1 - np.cos([0.0, 1.0, np.pi / 2])))
    assert found.attributes["lift_off_speed"] == pytest.approx(109.5445115010332, rel=1e-12)
    assert (tmp_path / "disc.dxf").exists()
    with pytest.raises(InputError, match="must end in"):
        vd.cam(disc, profile=tmp_path / "disc.pdf")
    with pytest.raises(InputError, match="eccentricity: must be below the radius"):
        vd.cam({**disc, "outline": {**disc["outline"], "eccentricity": "50 mm"}})


@pytest.mark.long
def test_pictures_are_drawn(file, tmp_path):
    view_cam(read_cam(file), plots=tmp_path / "pictures")
    names = {p.stem for p in (tmp_path / "pictures").iterdir()}
    assert names == {"profile", "motion", "pressure_angle", "forces"}


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("30 mm", "2 mm", 6, "base_radius: the roller undercuts .* take a base radius of"),
        ("230 deg", "200 deg", 2, "motion: the motion does not close: .* a dwell of 30 deg"),
        ("-9 mm", "-8 mm", 2, "motion: the motion does not close: its laws rise by 1 mm"),
        ("-9 mm", "-9 kg", 4, "motion.1..lift: '-9 kg' has the wrong unit"),
        ("radius: 9 mm", "radiu: 9 mm", 7, "follower.radiu: unknown key"),
        ("harmonic", "harmonik", 4, "did you mean 'harmonic'"),
        ("kind: dwell", "kind: table, file: none.csv", 5, "none.csv: there is no such file"),
        ("steps: 90", "steps: 2", 9, "steps: must be at least 8"),
        (TEXT, "- 1\n", 1, "a cam is a mapping"),
    ],
)
def test_files_are_refused_with_line_and_remedy(file, old, new, line, words):
    file.write_text(TEXT.replace(old, new))
    with pytest.raises(InputError) as caught:
        read_cam(file)
    assert re.search(rf"intake.yaml:{line}:\d+: .*{words}", str(caught.value)), str(caught.value)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("x,y\n0,0\n", "end the head with its unit"),
        ("x [deg],y [mm]\n0,0\n1,a\n", ":3: expected two numbers"),
        ("x [deg],y [mm]\n0,0\n1,1\n", "2 rows; four are the least"),
        ("x [deg],y [m]\n0,0\n1,2e3\n2,0\n3,0\n", ":3: 2000 m is none of a cam"),
        ("x [deg],y [mm]\n0,0\n20,1\n10,1\n230,0\n", "law.csv: the angles must grow"),
        ("x [deg],y [kg]\n0,0\n", "its unit in brackets, m or rad"),
        ("x [deg],y [mm]\n0,0\n10,1\n20,1\n90,0\n", "spans 90 deg, the law takes 230 deg"),
    ],
)
def test_tables_are_refused_with_their_line(file, table, words):
    file.with_name("law.csv").write_text(table)
    file.write_text(TEXT.replace("kind: dwell", "kind: table, file: law.csv"))
    with pytest.raises(InputError, match=words):
        read_cam(file)


def test_a_table_that_is_no_text_is_refused(file):
    file.with_name("law.csv").write_bytes(bytes(range(256)))
    file.write_text(TEXT.replace("kind: dwell", "kind: table, file: law.csv"))
    with pytest.raises(InputError, match="is not a text file"):
        read_cam(file)


def test_a_motion_from_a_table_is_that_of_the_law(file):
    exact = read_cam(file)
    angles = np.linspace(0.0, 360.0, 721)
    lifts = exact.moving(np.radians(angles[:-1])).coordinate - exact.start
    rows = [f"{a:.15g},{1e3 * v:.15g}" for a, v in zip(angles, [*lifts, 0.0], strict=True)]
    file.with_name("law.csv").write_text("\n".join(["a [deg],lift [mm]", *rows]))
    laws = TEXT[TEXT.index("  - ") : TEXT.index("base_radius")]
    file.write_text(TEXT.replace(laws, "  - {kind: table, over: 360 deg, file: law.csv}\n"))
    found = read_cam(file)
    x = np.linspace(0.0, 6.28, 101)
    assert found.moving(x).coordinate == pytest.approx(exact.moving(x).coordinate, abs=1e-7)
