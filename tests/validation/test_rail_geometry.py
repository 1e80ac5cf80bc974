"""Contact geometry and conicity against tables that are not part of the project."""

import csv
from pathlib import Path

import numpy as np
import pytest
from reference_cases.rail_geometry import deviations, jump_distance, table_jumps

from vehicledyn.rail.geometry.conicity import RadiusDifference, equivalent_conicity
from vehicledyn.rail.geometry.contact_geometry import MountedWheel, Pose, place_rail
from vehicledyn.rail.geometry.elastic_geometry import settled
from vehicledyn.rail.geometry.hertz import effective_modulus
from vehicledyn.rail.geometry.wheelset_geometry import WheelsetOnTrack, stand, stand_level
from vehicledyn.rail.profiles.named_profiles import named_profile
from vehicledyn.rail.profiles.open_profile import read_profile

REFERENCE = Path(__file__).parents[3] / "shared" / "reference" / "rail"

pytestmark = pytest.mark.validation
third_party = pytest.mark.skipif(
    not (REFERENCE / "en15302_tan_gamma_e.csv").exists(),
    reason="the reference results of EN 15302 are not part of the project",
)


def wanted(case):
    """Amplitude [m], tan γ_e and its band of a case of EN 15302."""
    with (REFERENCE / "en15302_tan_gamma_e.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["case"] == case]
    keys = ("y_hat_mm", "tan_gamma_e", "tol_lower", "tol_upper")
    columns = np.array([[float(row[key]) for key in keys] for row in rows]).T
    return 1e-3 * columns[0], columns[1], columns[2], columns[3]


def test_table_has_three_jumps():
    assert table_jumps() == [(0.0, 0.25), (4.75, 5.0), (6.25, 6.5)]
    assert jump_distance() == 0.0


def test_deviations_are_the_steps_of_the_table():
    """Half a step in place, and what it makes elsewhere."""
    found = deviations()
    assert max(found["s_right"], found["s_left"]) < 3e-3
    assert max(found["angle_right"], found["angle_left"]) < 1.7e-4


@pytest.mark.parametrize(("rail", "expected"), [("60E1", 0.959), ("60E1_manchester", 0.994)])
def test_radius_difference_at_three_millimetres(rail, expected):
    """Known to a micrometre for both heads of the rail."""
    wheel = MountedWheel(named_profile("S1002", "wheel"), 0.46, 0.75)
    placed = place_rail(named_profile(rail, "rail"), np.arctan(1 / 40), 1.435, 0.014)
    standing = stand(WheelsetOnTrack(wheel, wheel, placed, placed), 0.003)
    left, right = (wheel.table.height(t.place)[0] for t in (standing.left, standing.right))
    assert 1e3 * (left - right) == pytest.approx(expected, abs=1e-3)


@third_party
@pytest.mark.parametrize("case", ["E1", "E3"])
def test_conicity_from_tables_of_the_radius_difference(case):
    data = np.loadtxt(REFERENCE / f"en15302_dr_{case}.csv", delimiter=",", skiprows=1)
    table = RadiusDifference(1e-3 * data[:, 1], 1e-3 * data[:, 2])
    amplitudes, expected, _, _ = wanted(case)
    inside = amplitudes <= 6.8001e-3
    found = equivalent_conicity(table, amplitudes[inside], radius=0.46)
    assert found == pytest.approx(expected[inside], abs=1e-3)
    assert np.isnan(equivalent_conicity(table, amplitudes[~inside], radius=0.46)).all()


EN_15302_GAUGE = 1.435216
"""Gauge that the table of E3 implies, measured here 14 mm below the top of the rail's table [m].

Axes at 750.010 mm. The source's 1435.16 mm is the distance of the points of that table next to
this depth, at 32.4285 mm from the axis; the gauge face itself is at 32.403 mm.
"""


def difference_of(folder, name, gauge, reach):
    """Shifts and rolling radius differences of a reference wheel without roll, each 0.1 mm [m]."""
    wheel = MountedWheel(read_profile(extract(folder, name), "wheel"), 0.46, 0.75)
    rail = place_rail(read_profile(extract(folder, "SUIC519A"), "rail"), 0.0, gauge, 0.014)
    wheelset = WheelsetOnTrack(wheel, wheel, rail, rail)
    shift = 1e-4 * np.arange(reach + 1)
    places = [stand_level(wheelset, y) for y in shift]
    left, right = (
        np.array([wheel.table.height(getattr(p, side).place[:1])[0] for p in places])
        for side in ("left", "right")
    )
    return shift, left - right


@third_party
def test_gauge_that_the_radius_difference_of_e3_implies(tmp_path):
    """Beyond its jump wheel H runs on a cone: Δr moves by 1.7 µm for each 10 µm of the rails.

    The jump, between 2.5 and 2.6 mm, is where it is in the table; its values are rounded to 1 µm.
    """
    data = np.loadtxt(REFERENCE / "en15302_dr_E3.csv", delimiter=",", skiprows=1)
    expected = 1e-3 * data[data[:, 1] > -1e-9, 2]
    _, found = difference_of(tmp_path, "RUIC519H", EN_15302_GAUGE, 67)
    missed = found - expected[:68]
    assert np.abs(missed).max() < 0.02e-3
    assert abs(np.median(missed[30:65])) < 0.5e-6
    _, beside = difference_of(tmp_path, "RUIC519H", EN_15302_GAUGE - 8e-6, 65)
    assert np.median((beside - expected[:66])[30:]) > 0.5e-6


@third_party
@pytest.mark.parametrize(("case", "name"), [("E1", "RUIC519A"), ("E3", "RUIC519H")])
def test_conicity_from_profiles_is_in_the_band(tmp_path, case, name):
    """Without roll, at the gauge that the table of E3 implies."""
    shift, difference = difference_of(tmp_path, name, EN_15302_GAUGE, 78)
    table = RadiusDifference(
        np.concatenate([-shift[:0:-1], shift]), np.concatenate([-difference[:0:-1], difference])
    )
    amplitudes, _, lower, upper = wanted(case)
    found = equivalent_conicity(table, amplitudes, radius=0.46)
    assert ((found >= lower) & (found <= upper)).all()


def extract(folder, name):
    """Write one profile of the collection as a file of its own."""
    lines = (REFERENCE / "en15302_profiles.csv").read_text(encoding="utf-8").splitlines()
    path = folder / f"{name}.csv"
    rows = [line.partition(",")[2] for line in lines if line.startswith(f"{name},")]
    path.write_text("\n".join(["y_mm,z_mm", *rows]), encoding="utf-8")
    return path


@third_party
def test_elastic_contact_of_the_manchester_benchmark():
    """Case A-2.2 by an exact elastic program: contact on the wheel at the same normal force.

    Its y counts to the right and its roll from there: both change sign here.
    """
    steel = effective_modulus(2.0 * 82e9 * 1.28, 0.28, 2.0 * 82e9 * 1.28, 0.28)
    wheel = MountedWheel(named_profile("S1002", "wheel"), 0.46, 0.75)
    rail = place_rail(named_profile("60E1_manchester", "rail"), np.arctan(1 / 40), 1.435, 0.014)
    missed, approaches = [], []
    with (REFERENCE / "manchester_a22_contact.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            value = {key: float(row[key]) for key in row if key not in ("case", "side", "patch")}
            pose = Pose(-1e-3 * value["y_ws"], 0.46, value["roll"], -value["yaw"])
            right = row["side"] == "right"
            load = value["Fn"] * np.cos(value["delt"])
            _, found = settled(wheel, rail, pose.mirrored() if right else pose, load, steel)
            missed.append(1e3 * found[0].place - value["ycp_w"] * (1.0 if right else -1.0))
            approaches.append(1e3 * found[0].approach / value["approach"])
    assert len(missed) == 22
    assert np.abs(missed).max() < 1.5
    assert np.median(np.abs(missed)) < 0.05
    assert approaches == pytest.approx(np.ones(22), abs=0.08)
