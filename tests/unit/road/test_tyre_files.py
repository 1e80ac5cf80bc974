"""Tyre property files: units, defaults, ranges, and every problem with its line."""

from dataclasses import astuple

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.road.tyre_files.names import coefficients
from vehicledyn.road.tyre_files.tyre_file import read_tyre_file
from vehicledyn.road.tyres.pac2002 import Pac2002
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.road.tyres.tyre_of_file import TyreOfFile

UNITS = {
    "LENGTH": "meter",
    "FORCE": "newton",
    "ANGLE": "radians",
    "MASS": "kg",
    "TIME": "second",
}
NEEDED = {
    "UNLOADED_RADIUS": 0.3,
    "LONGVL": 16.6,
    "FNOMIN": 4000,
    "PCX1": 1.6,
    "PDX1": 1.1,
    "PKX1": 20,
    "PCY1": 1.3,
    "PDY1": 1.0,
    "PKY1": -20,
    "PKY2": 2,
}


@pytest.fixture
def write(tmp_path):
    def write(units=(), model="FITTYP = 61", **values):
        lines = ["[UNITS]", *(f"{k} = '{v}'" for k, v in {**UNITS, **dict(units)}.items() if v)]
        lines += ["[MODEL]", model, "[VERTICAL]  $ all in one section"]
        lines += [f"{k} = {v}  $ comment" for k, v in {**NEEDED, **values}.items() if v is not None]
        path = tmp_path / "a.tir"
        path.write_text("\n".join(lines), encoding="latin-1")
        return path

    return write


def refused(path):
    with pytest.raises(InputError) as error:
        read_tyre_file(path)
    return str(error.value)


def test_units_become_si(write):
    units = {"LENGTH": "mm", "FORCE": "kN", "ANGLE": "deg", "TIME": "ms"}
    values = {"UNLOADED_RADIUS": 300, "FNOMIN": 4, "LONGVL": 16.6, "ALPMIN": -90, "ALPMAX": 90}
    content = read_tyre_file(write(units, **values, VERTICAL_STIFFNESS=0.2, YAW_STIFFNESS=1))
    found = content.values
    assert found["UNLOADED_RADIUS"] == pytest.approx(0.3)
    assert found["FNOMIN"] == 4000.0 and found["LONGVL"] == pytest.approx(16.6)
    assert found["VERTICAL_STIFFNESS"] == pytest.approx(200e3)
    assert found["YAW_STIFFNESS"] == pytest.approx(57.2957795)
    assert content.ranges["slip_angle"].highest == pytest.approx(1.5707963)


@pytest.mark.parametrize(
    ("units", "radius", "load", "written"),
    [
        ({}, 0.3, 4000, 240e3),
        ({"LENGTH": "mm"}, 300, 4000, 0.24),
        ({"LENGTH": "mm", "FORCE": "kN"}, 300, 4, 0.24e-3),
        ({"LENGTH": "inch", "FORCE": "lbf"}, 11.8, 900, 34.809),
        ({"LENGTH": "mm", "PRESSURE": "bar"}, 300, 4000, 2.4),
        ({"PRESSURE": "kPa"}, 0.3, 4000, 240),
    ],
)
def test_pressures_without_a_unit_are_force_over_length_squared(
    write, units, radius, load, written
):
    speed = 16.6 * {"mm": 1e3, "inch": 1 / 0.0254}.get(units.get("LENGTH"), 1.0)
    given = {"UNLOADED_RADIUS": radius, "FNOMIN": load, "LONGVL": speed}
    values = read_tyre_file(write(units, **given, INFLPRES=written, NOMPRES=written)).values
    assert values["INFLPRES"] == pytest.approx(240e3, rel=1e-4)


@pytest.mark.parametrize(
    ("units", "change", "words"),
    [
        ({}, {"INFLPRES": 2.4}, "INFLPRES: is 2.4 Pa by the file's units; tyres have 5000 Pa to"),
        ({"LENGTH": "mm"}, {"UNLOADED_RADIUS": 300, "LONGVL": 16600, "NOMPRES": 240e3},
         "NOMPRES: is 2.4e+11 Pa by the file's units"),
        ({"LENGTH": "mm"}, {}, "UNLOADED_RADIUS: is 0.0003 m by the file's units"),
        ({}, {"UNLOADED_RADIUS": 300}, "check [UNITS] LENGTH"),
        ({}, {"FNOMIN": 4}, "FNOMIN: is 4 N by the file's units, on a radius of 0.3 m"),
        ({"FORCE": "kN"}, {}, "FNOMIN: is 4e+06 N by the file's units"),
        ({"TIME": "ms"}, {}, "LONGVL: is 1.66e+04 m/s"),
        ({}, {"ALPMIN": -15, "ALPMAX": 15}, "ALPMAX: is 15 rad by the file's units"),
        ({"ANGLE": "deg"}, {"ALPMIN": -1.5, "ALPMAX": 1.5}, "check [UNITS] ANGLE"),
        ({}, {"LMUY": 0}, "LMUY: must be above zero: 0"),
    ],
)  # fmt: skip
def test_sizes_that_no_tyre_has_are_refused_with_the_unit_to_check(write, units, change, words):
    assert words in refused(write(units, **change))


def test_defaults_and_names(write):
    found = read_tyre_file(write(LFZ0=0.9, PHX1="1.5E-003", PHX2="-2d-3", SECRET=1))
    assert found.values["LFZO"] == 0.9 and found.values["LMUX"] == 1.0
    assert found.values["PHX1"] == 1.5e-3 and found.values["PHX2"] == -2e-3
    assert found.values["PKY4"] == 2.0 and found.values["QSX1"] == 0.0
    assert found.unknown == ("SECRET",) and found.version == "6.1" and found.side == "unknown"
    assert all(c.meaning or c.section == "MODEL" for c in coefficients().values())


@pytest.mark.parametrize(
    ("fit", "version"), [(6, "5.2"), (52, "5.2"), (61, "6.1"), (62, "6.2"), (21, "5.2")]
)
def test_versions(write, fit, version):
    assert read_tyre_file(write(model=f"FITTYP = {fit}")).version == version


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"model": "FITTYP = 44"}, "a.tir:8:1: FITTYP: no Magic Formula of version '44'"),
        ({"model": "USE_MODE = 4"}, "FITTYP: missing"),
        ({"model": "FITTYP=61\nTYRESIDE='UP'"}, "TYRESIDE: no side named 'UP'"),
        ({"PKY1": None}, "PKY1: missing: Maximum value of stiffness"),
        ({"pky1": -20}, "PKY1: appears twice; it was given in line 18"),
        ({"units": {"FORCE": "newtn"}}, "a.tir:3:1: [UNITS] FORCE: no unit of force named 'newtn'"),
        ({"units": {"FORCE": ""}}, "[UNITS]: missing: FORCE"),
        ({"FZMIN": 9e3, "FZMAX": 1e3}, "FZMIN: the range is turned round: FZMIN 9000, FZMAX 1000"),
        ({"PDX1": "abc"}, "a.tir:14:1: PDX1: expected a number, found 'abc'"),
        ({"PDX1": "nan"}, "PDX1: expected a number, found 'nan'"),
        ({"FNOMIN": -1}, "FNOMIN: must be above zero"),
        ({"PKY2": 0}, "PKY2: must not be zero"),
        ({"PDX1": -0.9}, "PDX1: must be above zero"),
        ({"PDY1": 0}, "PDY1: must not be zero"),
        ({"PKY1": 21.9}, "PKY1: is positive with PKY2: side forces would push the wheel aside"),
    ],
)
def test_problems_are_named_with_their_line(write, change, words):
    assert words in refused(write(**change))


def test_all_problems_at_once(write):
    assert "4 problems" in refused(write(PDX1="x", PCX1=0, PKX1=None, FNOMIN=0))


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "latin-1"])
def test_marks_of_editors_at_the_ends_of_a_text_have_no_effect(write, encoding):
    path = write()
    plain = read_tyre_file(path).values
    text = path.read_text(encoding="latin-1")
    path.write_bytes(text.encode(encoding) + (b"\x1a" if encoding == "latin-1" else b""))
    assert read_tyre_file(path).values == plain


def test_what_is_no_text(tmp_path):
    path = tmp_path / "a.tir"
    path.write_bytes(b"\x7fELF\0\0\1")
    assert "binary" in refused(path)
    path.write_text("[MODEL]\nhello")
    assert "a.tir:2:1: [MODEL]: expected 'NAME = value'" in refused(path)
    path.write_text("")
    assert "no 'NAME = value' lines" in refused(path)
    path.write_bytes(b"$" * 3_000_000)
    assert "larger than 2 MB" in refused(path)
    assert "no such file" in refused(tmp_path / "none.tir")
    assert "folder" in refused(tmp_path)


def test_a_negative_lateral_friction_means_the_same_formula(write):
    """Files of MF-Tyre 5.0 have one: D and B change sign together."""
    changes = {"PDY2": -0.1, "RVY1": 0.05, "RVY6": 9, "RBY1": 8, "QBZ10": 2, "QDZ6": 0.01}
    usual = TyreOfFile(file=str(write(model="FITTYP = 5", **changes)))
    felt = TyreInput(3e3, 0.05, 0.06, 0.02, 10.0)
    wanted = astuple(usual.forces(felt))
    turned = {n: -changes[n] for n in ("PDY2", "RVY1", "QBZ10")}
    file = write(model="FITTYP = 5", **{**changes, "PDY1": -1.0, **turned})
    found = TyreOfFile(file=str(file))
    assert found.content.turned and abs(wanted[1]) > 1e3
    assert astuple(found.forces(felt)) == pytest.approx(wanted, rel=1e-12)
    chrono = Pac2002(file=str(file), convention="chrono", combined="pacejka")
    assert float(chrono.relaxation_lengths(felt).lateral) == 0.0
