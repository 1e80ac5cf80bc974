"""Curves of tyre files, and fits that find the coefficients the data were made with."""

import csv
import math

import h5py
import numpy as np
import pytest

from vehicledyn.analyses.tyres.curves import force_function, view_tyre
from vehicledyn.analyses.tyres.fit import fit_tyre
from vehicledyn.base.errors import InputError
from vehicledyn.road.tyre_files.tyre_file import read_tyre_file
from vehicledyn.road.tyres.tyre_of_file import TyreOfFile
from vehicledyn.symbolic import ops

MF61, PAC = "passenger_R0394_mf61.tir", "passenger_235_60R16_pac2002.tir"


def test_table_and_key_figures(tmp_path):
    table = tmp_path / "t.h5"
    report = view_tyre(MF61, other=PAC, loads=[4000.0], output=table)
    first = report.facts[0]["loads"][0]
    assert first["lateral_peak"] == pytest.approx(4326.2, abs=20.0)
    assert first["relaxation_alpha"] == pytest.approx(0.4328, rel=0.1)
    assert "version 6.1, side right" in report.as_text()
    with h5py.File(table) as file:
        lateral = file["tyre_1/lateral"]
        row = np.argmin(np.abs(lateral["slip_angle"][:] - math.radians(4.0)))
        assert lateral["lateral_force"][row] == pytest.approx(-3858.21376, abs=1e-3)
        assert lateral["lateral_force"].attrs["units"] == "N"
        assert set(file) == {"tyre_1", "tyre_2"}
    view_tyre(PAC, output=tmp_path / "t.csv")
    with (tmp_path / "t.csv").open() as stream:
        head = next(csv.reader(stream))
    assert head[:4] == ["tyre", "sweep", "load [N]", "longitudinal_slip [1]"]


def test_curves_outside_the_ranges_of_the_file_are_reported():
    text = view_tyre(MF61, loads=[4e6]).as_text()
    assert "outside its range: load 4e+06 to 4e+06 N of the curves, of " in text
    assert "load" not in view_tyre(MF61, loads=[4e3]).as_text().partition("outside")[2]


def test_figures(tmp_path):
    view_tyre(PAC, loads=[2e3, 4e3], plots=tmp_path)
    names = {p.name for p in tmp_path.glob("*.png")}
    wanted = ("pure_slip", "combined_slip", "friction_ellipse", "moment_method")
    assert names == {f"{name}.png" for name in wanted}


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Forces of the library's tyre with 10 N of noise, equally distributed over slips."""
    rng = np.random.default_rng(7)
    felt = rng.uniform([1e3, 0, -0.2, 0], [8e3, 0, 0.2, 0], size=(400, 4))
    force = force_function(TyreOfFile(file=MF61), 16.7)(felt)[:, 1] + rng.normal(0, 10, 400)
    path = tmp_path_factory.mktemp("fit") / "data.csv"
    rows = [
        f"{f[0]:.9g},{math.degrees(f[2]):.9g},{y:.9g}" for f, y in zip(felt, force, strict=True)
    ]
    path.write_text("load [N],slip_angle [deg],lateral_force [N]\n" + "\n".join(rows))
    return path


def test_fit_finds_the_coefficients_again(measured, tmp_path):
    truth = read_tyre_file(TyreOfFile(file=MF61).path)
    start = tmp_path / "start.tir"
    text = truth.path.read_text().replace("PDY1 = 1.0085", "PDY1 = 0.8")
    start.write_text(text.replace("PKY1 = -28.3155", "PKY1 = -20"))
    names = ("PDY1", "PDY2", "PKY1", "PCY1", "PEY1")
    found = fit_tyre(start, measured, names=names, output=tmp_path / "new.tir", plots=tmp_path)
    for item in found.fitted:
        assert abs(item.value - truth.values[item.name]) < 2.0 * item.half_width
        assert 0.0 < item.half_width < 0.1 * abs(item.value) + 0.1
    before, after, largest = found.residuals["lateral_force"]
    assert before > 500.0 and after == pytest.approx(10.0, rel=0.1) and largest < 60.0
    written = read_tyre_file(tmp_path / "new.tir").values
    assert written["PDY1"] == pytest.approx(found.fitted[0].value, rel=1e-9)
    assert (tmp_path / "fit_lateral_force.png").exists()


def test_a_fit_evaluates_all_rows_at_once(measured, monkeypatch):
    """A call for each row took minutes for the tables that test rigs write."""
    calls, numeric = [], ops.numeric

    def counting(*expressions):
        function = numeric(*expressions)
        return lambda *values: calls.append(1) or function(*values)

    monkeypatch.setattr(ops, "numeric", counting)
    fit_tyre(MF61, measured, names=["PDY1"])
    force_function(TyreOfFile(file=MF61), 16.7)(np.full((500, 4), 0.01))
    assert len(calls) < 100


def test_fits_that_cannot_be(measured, tmp_path):
    with pytest.raises(InputError, match="PDX1: without effect on these data"):
        fit_tyre(MF61, measured, names=["PDX1"])
    with pytest.raises(InputError, match="no coefficient named 'PDY9'; did you mean"):
        fit_tyre(MF61, measured, names=["PDY9"])
    few = tmp_path / "few.csv"
    few.write_text("load [N],slip_angle [deg],lateral_force [N]\n4000,1,-1500\n")
    with pytest.raises(InputError, match="1 values for 8 coefficients"):
        fit_tyre(MF61, few)
    with pytest.raises(InputError, match=r"end its name in \.tir"):
        fit_tyre(MF61, measured, names=["PDY1"], output=tmp_path / "a.csv")
    few.write_text("load [N],slip_angle [deg]\n4000,1\n")
    with pytest.raises(InputError, match="no forces"):
        fit_tyre(MF61, few)
