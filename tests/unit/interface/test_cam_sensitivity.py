"""Derivatives of cams by measures of cam, follower, motion and load."""

import json
import math
from copy import deepcopy
from itertools import pairwise

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyses.sensitivity.report import SensitivityReport
from vehicledyn.base.errors import AccuracyWarning, InputError
from vehicledyn.cams.cam_file import read_cam
from vehicledyn.results.tables.sensitivity_table import read_sensitivity

HEAD = """\
title: A cam
motion:
  - {kind: polynomial_4567, over: 65 deg, RISE: 0.3}
  - {kind: dwell, over: 5 deg}
  - {kind: modified_sine, over: 60 deg, RISE: -0.1}
  - {kind: cycloidal, over: 65 deg, RISE: -0.2}
  - {kind: dwell, over: 165 deg}
base_radius: 30 mm
load: {speed: 1500 rpm, mass: 0.2 kg, stiffness: 40 N/mm, preload: 250 N, inertia: 0.001 kg*m^2,
  turning_stiffness: 30 N*m/rad, preload_torque: 5 N*m}
"""
FOLLOWERS = {
    "roller": "follower: {kind: roller, radius: 9 mm, offset: 2 mm}",
    "flat": "follower: {kind: flat, tilt: 3 deg}",
    "axial_roller": "follower: {kind: axial_roller, distance: 50 mm, radius: 9 mm}",
    "rocker_roller": "follower: {kind: rocker_roller, pivot: 80 mm, arm: 70 mm, radius: 9 mm}",
    "rocker_flat": "follower: {kind: rocker_flat, pivot: 80 mm, offset: 4 mm}",
}
COLUMNS = "lift", "acceleration", "pressure_angle", "profile_x", "profile_radius", "torque"


def _text(kind):
    """Return a file: lifts of 6 mm, or swings of 30 mrad."""
    field, unit, share = ("swing", "rad", 0.1) if kind.startswith("rocker") else ("lift", "m", 0.02)
    text = HEAD.replace("RISE", field)
    for number in (0.3, 0.1, 0.2):
        text = text.replace(f"{number}}}", f"{number * share:g} {unit}}}")
    return text + FOLLOWERS[kind]


def _data(text):
    from ruamel.yaml import YAML

    return YAML(typ="safe", pure=True).load(text)


def _with(data, name, value, unit, closing):
    """Return the data of a cam with another measure, its last law making up for it."""
    *parts, field = name.split(".")
    if parts[:1] == ["motion"]:
        law = int(parts[1]) - 1
        old = _si(data["motion"][law][field], unit)
        data["motion"][law][field] = f"{value!r} {unit}"
        other = len(data["motion"]) - 1 if field == "over" else closing
        share = _si(data["motion"][other][field], unit) + old - value
        data["motion"][other][field] = f"{share!r} {unit}"
    elif parts:
        data[parts[0]][field] = f"{value!r} {unit}".removesuffix(" 1")
    else:
        data[field] = f"{value!r} {unit}"
    return data


def _si(text, unit):
    from vehicledyn.base.units import to_si

    return to_si(text, unit)


@pytest.mark.long
@pytest.mark.parametrize("kind", FOLLOWERS)
def test_no_measure_is_left_out(tmp_path, kind):
    """All change at once by random parts, written into a file that is read anew."""
    path = tmp_path / "cam.yaml"
    path.write_text(_text(kind), encoding="utf-8")
    found = vd.sensitivity(path, [f"cam({column}, 40 deg)" for column in COLUMNS])
    table = found.report.table
    values, slopes = np.array(table.parameter_values), np.array(table.slopes)
    parts = np.where(values, values, 1e-3)
    parts = parts * np.random.default_rng(6).uniform(-1.0, 1.0, len(values))

    def columns(part):
        data = _data(_text(kind))
        for k, quantity in enumerate(table.parameters):
            value = float(values[k] + part * parts[k])
            data = _with(data, quantity.name, value, quantity.unit, closing=3)
        cam = vd.cam(data, angles=["40 deg"])
        return np.array([float(cam[column].values[0]) for column in COLUMNS])

    wide = [(columns(h) - columns(-h)) / (2.0 * h) for h in (4e-4, 2e-4, 1e-4)]
    first = [(4.0 * b - a) / 3.0 for a, b in pairwise(wide)]
    expected = (16.0 * first[1] - first[0]) / 15.0
    size = np.abs(slopes * parts).sum(axis=1)
    apart = np.abs(slopes @ parts - expected) / np.maximum(size, 1e-300)
    assert columns(0.0) == pytest.approx(table.values, rel=1e-12)
    assert apart[size > 0.0] == pytest.approx(0.0, abs=1e-8)


def test_an_in_line_roller_follows_its_closed_form(tmp_path):
    """tan of the pressure angle is s' / (r_base + r_roller + s): its peak by the base radius."""
    path = tmp_path / "cam.yaml"
    path.write_text(_text("roller").replace("offset: 2 mm", "offset: 0 mm"), encoding="utf-8")
    found = vd.sensitivity(path, "cam(peak(pressure_angle))", ["base_radius", "motion.*"])
    turn = np.linspace(0.0, np.radians(65.0), 400_001)
    u, height = turn / turn[-1], 0.3 * 0.02
    lift = height * (35.0 * u**4 - 84.0 * u**5 + 70.0 * u**6 - 20.0 * u**7)
    rate = height * 140.0 * (u * (1.0 - u)) ** 3 / turn[-1]
    slope = rate / (0.039 + lift)
    at = int(np.argmax(slope))
    by_radius = -rate[at] / (0.039 + lift[at]) ** 2 / (1.0 + slope[at] ** 2)
    assert found["figure_value"].values[0] == pytest.approx(np.arctan(slope[at]), rel=1e-9)
    slopes = dict(zip(found["parameter"].values, found["figure_slope"].values[0], strict=True))
    assert slopes["base_radius"] == pytest.approx(by_radius, rel=1e-5)
    assert slopes["motion.3.over"] == pytest.approx(0.0, abs=1e-9)


def test_jumps_of_the_acceleration_have_no_derivative(tmp_path):
    path = tmp_path / "cam.yaml"
    path.write_text(_text("roller").replace("polynomial_4567", "harmonic"), encoding="utf-8")
    to, kept = ["motion.1.over", "base_radius"], tmp_path / "found.h5"
    with pytest.warns(AccuracyWarning, match="has a corner at 65 deg"):
        found = vd.sensitivity(path, "cam(acceleration, 65 deg)", to, save_to=kept)
    lost = np.isnan(found["figure_slope"].values[0])
    assert lost[0]
    assert "nan" not in SensitivityReport(read_sensitivity(kept)).as_text()


@pytest.mark.parametrize(
    ("of", "to", "match"),
    [
        ("cam(lift)", "*", "write cam"),
        ("cam(max(lift), 3 deg)", "*", "write cam"),
        ("cam(lifd, 3 deg)", "*", "did you mean 'lift'"),
        ("cam(lift, 3 m)", "*", "m"),
        ("cam(lift, 3 deg)", "follower.radios", "did you mean 'follower.radius'"),
    ],
)
def test_names_are_checked(tmp_path, of, to, match):
    path = tmp_path / "cam.yaml"
    path.write_text(_text("roller"), encoding="utf-8")
    with pytest.raises(InputError, match=match):
        vd.sensitivity(path, of, to)


ROLLER = {"kind": "roller", "radius": 0.009, "offset": 0.006}
ROCKER = {"kind": "rocker_roller", "radius": 0.009, "pivot": 0.08, "arm": 0.07, "side": "below"}
FACE = {"kind": "rocker_flat", "pivot": 0.08, "offset": 0.004}
CIRCLE = {"kind": "eccentric_circle", "radius": 0.04, "eccentricity": 0.01, "direction": 0.3}
ARCS = {
    "kind": "arcs",
    "start": [0.001, -0.05],
    "normal": -0.5 * np.pi,
    "arcs": [
        item
        for radius in (0.035, 0.025)
        for item in ({"radius": radius, "turn": np.pi}, {"length": 0.02})
    ],
}
FLANKS = {**ARCS, "arcs": [{"radius": 0.03, "turn": np.pi}, {"length": 0.03}] * 2}
PAIR = {
    "motion": [
        {"kind": "cycloidal", "over": 2.0, "lift": 0.02},
        {"kind": "dwell", "over": 1.0},
        {"kind": "cycloidal", "over": 2.0, "lift": -0.02},
        {"kind": "dwell", "over": 2.0 * np.pi - 5.0},
    ],
    "base_radius": 0.04,
    "conjugate": {"follower": {"kind": "roller", "radius": 0.012}, "distance": 0.13},
}
LOAD = {"speed": 150.0, "mass": 0.2, "stiffness": 4e4, "preload": 250.0, "inertia": 1e-3}
LOAD |= {"turning_stiffness": 30.0, "preload_torque": 5.0}
OUTLINES = {
    "circle, roller": {"outline": CIRCLE, "follower": ROLLER},
    "circle, rocker": {"outline": CIRCLE, "follower": ROCKER},
    "circle, face": {"outline": CIRCLE, "follower": {"kind": "flat", "tilt": 0.05}},
    "circle, rocking face": {"outline": CIRCLE, "follower": FACE},
    "flanks, rocker": {"outline": FLANKS, "follower": ROCKER},
    "flanks, face": {"outline": FLANKS, "follower": {"kind": "flat", "tilt": 0.05}},
    "points, roller": {"outline": "points", "follower": ROLLER},
    "points, rocking face": {"outline": "points", "follower": FACE},
    "pair": {**PAIR, "follower": ROLLER},
}


def _outlined(name, folder):
    """Return the data of a cam, measured points written beside it."""
    data = deepcopy({"title": name, "load": LOAD, **OUTLINES[name]})
    if data.get("outline") == "points":
        angles = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
        rows = [f"{a!r},{0.04 + 0.006 * math.cos(a - 1.0)!r}" for a in angles.tolist()]
        (folder / "points.csv").write_text("\n".join(["a [rad],r [m]", *rows]), encoding="utf-8")
        data["outline"] = {"kind": "points", "file": str(folder / "points.csv")}
    return data


def _set(data, name, change):
    """Change a number of the data of a cam; a law that goes down makes up for one that goes up."""
    *parts, last = name.split(".")
    part = data
    for key in parts:
        part = part[int(key) - 1] if isinstance(part, list) else part[key]
    key = "xyz".index(last) if isinstance(part, list) else last
    part[key] = part.get(key, 0.0) + change if isinstance(part, dict) else part[key] + change
    if parts[:1] == ["motion"]:
        other = data["motion"][-1 if last == "over" else 2]
        other[last] -= change


POINTS = {n: COLUMNS[2:4] for n in OUTLINES if n.startswith("points")}
"""Of points the lowest place is sought at length; these columns do without."""


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=[pytest.mark.long] if n in POINTS else []) for n in OUTLINES]
)
def test_outlines_and_pairs_follow_their_measures(tmp_path, name):
    """All change at once by random parts, written into the cam that is then sought anew."""
    path, angle = tmp_path / "cam.yaml", 0.9
    path.write_text(json.dumps(_outlined(name, tmp_path)), encoding="utf-8")
    columns = ["lift", "pressure_angle", "profile_x", "torque"]
    columns += ["second_profile_y", "second_normal_force"] if name == "pair" else []
    columns += [] if "flanks" in name else ["profile_radius", "acceleration"]
    columns = list(POINTS.get(name, columns))
    table = vd.sensitivity(path, [f"cam({c}, {angle!r} rad)" for c in columns]).report.table
    values, slopes = np.array(table.parameter_values), np.array(table.slopes)
    parts = np.where(values, values, 1e-3)
    parts = parts * np.random.default_rng(6).uniform(-1.0, 1.0, len(values))

    def found(h):
        data = _outlined(name, tmp_path)
        for quantity, part in zip(table.parameters, parts, strict=True):
            _set(data, quantity.name, h * float(part))
        if name in POINTS:
            path.write_text(json.dumps(data), encoding="utf-8")
            geometry = read_cam(path).geometry(np.array([angle]))
            return np.array([geometry.pressure_angle[0], geometry.profile[0, 0]])
        cam = vd.cam(data, angles=[f"{angle!r} rad"])
        return np.array([float(cam[column].values[0]) for column in columns])

    wide = [(found(h) - found(-h)) / (2.0 * h) for h in (4e-3, 2e-3, 1e-3)]
    first = [(4.0 * b - a) / 3.0 for a, b in pairwise(wide)]
    expected = (16.0 * first[1] - first[0]) / 15.0
    size = np.abs(slopes * parts).sum(axis=1)
    assert found(0.0) == pytest.approx(table.values, rel=1e-12)
    assert np.abs(slopes @ parts - expected) == pytest.approx(0.0, abs=1e-8 * size.max())
    apart = np.abs(slopes @ parts - expected)[size > 0.0] / size[size > 0.0]
    assert apart == pytest.approx(0.0, abs=2e-8)


def test_an_eccentric_circle_lifts_a_face_by_its_eccentricity(tmp_path):
    """s = e (1 - cos θ) from where it is lowest, and so its largest lift by e is 2."""
    path = tmp_path / "cam.yaml"
    data = {"title": "A disc", "outline": {**CIRCLE, "direction": -0.5 * np.pi}}
    path.write_text(json.dumps({**data, "follower": {"kind": "flat"}}), encoding="utf-8")
    found = vd.sensitivity(path, ["cam(lift, 40 deg)", "cam(max(lift))"])
    slopes = dict(zip(found["parameter"].values, found["figure_slope"].values.T, strict=True))
    turned = 1.0 - np.cos(np.radians(40.0))
    assert slopes["outline.eccentricity"] == pytest.approx([turned, 2.0], rel=1e-9)
    assert slopes["outline.radius"] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_dwell_at_the_end_of_a_law_has_no_corner(tmp_path):
    """The least lift is that of the dwell, from where the first law begins."""
    path = tmp_path / "cam.yaml"
    path.write_text(_text("roller"), encoding="utf-8")
    found = vd.sensitivity(path, ["cam(min(lift))", "cam(lift, 195 deg)"], ["motion.*", "base_*"])
    assert found["figure_slope"].values == pytest.approx(0.0, abs=1e-20)
    assert not found.notes
