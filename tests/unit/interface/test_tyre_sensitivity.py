"""Derivatives of the forces of tyre property files by their coefficients."""

import sys
from itertools import pairwise

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError
from vehicledyn.cli import main
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.road.tyres.tyre_of_file import TyreOfFile

FILES = {"mf61": "passenger_R0394_mf61.tir", "pac2002": "passenger_235_60R16_pac2002.tir"}
FELT = {"longitudinal_slip": 0.03, "slip_angle": 0.05, "camber": 0.02}
ASKED = "4200 N, longitudinal_slip=0.03, slip_angle=0.05 rad, camber=0.02 rad"
FORCES = "longitudinal_force", "lateral_force", "aligning_moment", "rolling_resistance"


@pytest.mark.parametrize("file", FILES.values(), ids=FILES)
def test_no_coefficient_is_left_out(file):
    """All change at once by random parts, as numbers in the law."""
    found = vd.sensitivity(file, [f"tyre({name}, {ASKED})" for name in FORCES])
    names, values = found["parameter"].values, found["parameter_value"].values
    parts = values * np.random.default_rng(3).uniform(-1.0, 1.0, len(values))
    tyre = TyreOfFile(file=file, mirror="never")

    def forces(part):
        moved = dict(zip(names, map(float, values + part * parts), strict=True))
        p = tyre.coefficients().changed(**moved)
        given = tyre.acting_forces(p, TyreInput(4200.0, *FELT.values(), 16.7))
        return np.array([float(getattr(given, name)) for name in FORCES])

    slopes = [(forces(h) - forces(-h)) / (2.0 * h) for h in (4e-3, 2e-3, 1e-3)]
    first = [(4.0 * b - a) / 3.0 for a, b in pairwise(slopes)]
    expected = (16.0 * first[1] - first[0]) / 15.0
    along = found["figure_slope"].values @ parts
    size = np.abs(found["figure_slope"].values * parts).sum(axis=1)
    assert np.abs(along - expected) / size == pytest.approx(0.0, abs=1e-9)
    assert forces(0.0) == pytest.approx(found["figure_value"].values, rel=1e-12)


def test_cornering_stiffness_is_that_of_the_formula():
    """K = PKY1 Fz0 sin(2 arctan(Fz / (PKY2 Fz0))) where horizontal shifts are small, of PAC2002."""
    found = vd.sensitivity(FILES["pac2002"], "tyre(cornering_stiffness, 3 kN:5 kN:2)", "PKY?")
    slopes, stiffness = found["figure_slope"].values, found["figure_value"].values
    first, second = found["parameter_value"].values[:2]
    place = np.array([3e3, 4e3, 5e3]) / (second * read_nominal_load(FILES["pac2002"]))
    twice = 2.0 * np.arctan(place)
    assert slopes[:, 0] * first == pytest.approx(stiffness, rel=0.01)
    by_second = -stiffness * 2.0 / np.tan(twice) * place / (1.0 + place**2)
    assert slopes[:, 1] * second == pytest.approx(by_second, rel=0.01)


def test_what_leaves_the_ranges_of_the_file_is_told():
    """Once for each range, with the figure that is farthest; a peak by its place."""
    of = ["tyre(lateral_force, 4 kN:40 kN:2, slip_angle=60 deg)", "tyre(cornering_stiffness, 4 kN)"]
    with pytest.warns(vd.AccuracyWarning, match="outside"):
        notes = vd.sensitivity(FILES["mf61"], of, "PDY1").notes
    assert len(notes) == 2
    assert "4e+04 N" in notes[0]
    assert "and 1 more: the load of 4e+04 N is outside" in notes[0]
    assert "and 2 more: the slip angle of 1.047 rad is outside" in notes[1]
    assert not vd.sensitivity(FILES["mf61"], of[1], "PDY1").notes


def test_a_peak_is_that_of_the_friction():
    """D = μ Fz and S_V: the peak grows with λ_μy, by PDY1 and PVY1 as the load, by no stiffness."""
    names = ["LMUY", "PDY1", "PVY1", "PKY1"]
    found = vd.sensitivity(FILES["pac2002"], "tyre(peak_lateral_force, 4 kN)", names)
    value = found["figure_value"].values[0]
    expected = [value, 4000.0, 4000.0, 0.0]
    assert found["figure_slope"].values[0] == pytest.approx(expected, rel=1e-7, abs=1e-5)
    drawn = vd.tyre(FILES["pac2002"], loads=["4 kN"])["tyre_1.lateral.lateral_force"].values
    assert value == pytest.approx(np.abs(drawn).max(), rel=1e-3)


def read_nominal_load(file):
    return TyreOfFile(file=file, mirror="never").content.values["FNOMIN"]


@pytest.mark.parametrize(
    ("source", "of", "to", "match"),
    [
        (FILES["mf61"], "tyre(lateral_force)", "*", "write tyre"),
        (FILES["mf61"], "tyre(lateral_forse, 4 kN)", "*", "did you mean 'lateral_force'"),
        (FILES["mf61"], "tyre(lateral_force, 4 kg)", "*", "kg"),
        (FILES["mf61"], "tyre(lateral_force, 0 N)", "*", "above zero"),
        (FILES["mf61"], "tyre(lateral_force, 4 kN, slip_angel=1 deg)", "*", "slip_angle"),
        (FILES["mf61"], "tyre(lateral_force, 4 kN)", "PDY9", "did you mean 'PDY"),
        ("nothing.tir", "tyre(lateral_force, 4 kN)", "*", "nothing.tir"),
    ],
)
def test_names_are_checked(source, of, to, match):
    with pytest.raises(InputError, match=match):
        vd.sensitivity(source, of, to)


def test_nothing_is_set_in_a_file():
    with pytest.raises(InputError, match="nothing is set"):
        vd.sensitivity(FILES["mf61"], "tyre(lateral_force, 4 kN)", set={"PDY1": 1.0})


def test_nothing_is_set_in_a_file_on_the_command_line(capsys, monkeypatch):
    of = ["--of", "tyre(lateral_force, 4 kN)", "--set", "PDY1=2"]
    monkeypatch.setattr(sys, "argv", ["vehicledyn", "sensitivity", FILES["mf61"], *of])
    with pytest.raises(SystemExit):
        main()
    assert "nothing is set" in capsys.readouterr().err
