"""Derivatives of cams by measures of cam, follower, motion and load."""

from itertools import pairwise

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.analyses.sensitivity.report import SensitivityReport
from vehicledyn.base.errors import AccuracyWarning, InputError
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


def test_outlines_are_refused(tmp_path):
    path = tmp_path / "cam.yaml"
    text = "title: A disc\noutline: {kind: eccentric_circle, radius: 40 mm, eccentricity: 10 mm}\n"
    path.write_text(text + "follower: {kind: flat}\n", encoding="utf-8")
    with pytest.raises(InputError, match="sought point by point"):
        vd.sensitivity(path, "cam(lift, 3 deg)")


def test_a_dwell_at_the_end_of_a_law_has_no_corner(tmp_path):
    """The least lift is that of the dwell, from where the first law begins."""
    path = tmp_path / "cam.yaml"
    path.write_text(_text("roller"), encoding="utf-8")
    found = vd.sensitivity(path, ["cam(min(lift))", "cam(lift, 195 deg)"], ["motion.*", "base_*"])
    assert found["figure_slope"].values == pytest.approx(0.0, abs=1e-20)
    assert not found.notes
