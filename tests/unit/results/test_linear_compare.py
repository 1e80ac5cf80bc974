"""Comparing files of hunting studies, modes and responses."""

import sys
from dataclasses import replace

import h5py
import numpy as np
import pytest

from vehicledyn.cli import main
from vehicledyn.results.compare.table_compare import _numbers, compare_tables
from vehicledyn.results.compare.tolerances import Tolerances
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.hunt_table import CycleRow, HuntTable, SimulatedRow, write_hunt
from vehicledyn.results.tables.response_table import ResponseTable, write_response
from vehicledyn.results.tables.uncertainty_table import UncertaintyTable, write_uncertainty

SPEED, SHIFT = Quantity("speed", "m/s", "Speed"), Quantity("y", "m", "Lateral shift")


def cycle(value, size):
    motion = size * np.sin(np.linspace(0.0, 2.0 * np.pi, 11))[:, None]
    return CycleRow(
        1, value, 0.16, True, "", 1.0, np.array([1.0, 0.5 + 0.1j]), np.array([-size]),
        np.array([size]), motion,
    )  # fmt: skip


def study(**changes):
    table = HuntTable(
        "A wheelset", "wheelset", SPEED, (SHIFT,), np.array([50.0, 60.0]),
        np.array([[-1.0 + 39j, -1.0 - 39j], [0.2 + 39.5j, 0.2 - 39.5j]]),
        (cycle(55.0, 0.006), cycle(60.0, 0.008)), (SimulatedRow(60.0, 0.008, 0.16),),
        {"linear_critical": 59.2, "nonlinear_critical": 54.1}, "ok", "",
    )  # fmt: skip
    return replace(table, **changes)


@pytest.fixture
def reference(tmp_path):
    write_hunt(tmp_path / "reference.h5", study())
    return tmp_path / "reference.h5"


def compared(path, reference, table, relative=1e-6, **more):
    write_hunt(path, table)
    return compare_tables(path, reference, tolerances=Tolerances(relative), **more)


def test_equal_studies(reference, tmp_path):
    found = compared(tmp_path / "hunt.h5", reference, study(), relative=0.0)
    assert found.verdict == "equal" and len(found.channels) > 8


def test_changes_that_a_title_names_are_reported(reference, tmp_path):
    found = compared(tmp_path / "hunt.h5", reference, study(title="A wheelset, changed: k = 1 N/m"))
    assert found.verdict == "equal"
    assert found.notes == (
        "title is 'A wheelset, changed: k = 1 N/m', in the reference 'A wheelset'",
    )


def test_how_results_came_about_is_told_and_no_difference(tmp_path):
    """A study that went on after a kill knows runs from before; its numbers are the same."""
    mass, roll = Quantity("mass", "kg", "Mass"), Quantity("roll", "rad", "Roll")
    one, paths = np.ones(1), [tmp_path / "gone_on.h5", tmp_path / "whole.h5"]
    for path, notes in zip(paths, (("3 runs were known",), ("slow",)), strict=True):
        table = UncertaintyTable(
            "Scatter", "sobol", 1, (mass,), (roll,), one, one, one, one, one[None], one[None],
            one[None], one[None], (), notes,
        )  # fmt: skip
        write_uncertainty(path, table)
    found = compare_tables(*paths, tolerances=Tolerances(0.0))
    assert found.verdict == "equal"
    assert "note: only the result notes: 3 runs were known" in found.as_text()
    assert "note: only the reference notes: slow" in found.as_text()


def test_infinite_parts_of_complex_numbers_stay_apart(tmp_path):
    """Multiplied by 1j an infinite part would make the other one no number, with a warning."""
    with h5py.File(tmp_path / "modes.h5", "w") as file:
        file["eigenvalue_real"], file["eigenvalue_imag"] = [0.5, 1.0], [np.inf, 2.0]
        ((name, (_, values)),) = _numbers(file)
    assert name == "eigenvalue"
    assert values.real.tolist() == [0.5, 1.0] and values.imag.tolist() == [np.inf, 2.0]


def test_each_number_counts(reference, tmp_path):
    path = tmp_path / "hunt.h5"
    figures = {"linear_critical": 59.3, "nonlinear_critical": 54.1}
    found = compared(path, reference, study(figures=figures))
    assert [c.name for c in found.failed] == ["figures.linear_critical"]
    assert compared(path, reference, study(figures=figures), relative=2e-3).verdict == "equal"
    moved = np.array(study().eigenvalues)
    moved[1, 0] += 1e-3j
    found = compared(path, reference, study(eigenvalues=moved))
    assert [c.name for c in found.failed] == ["eigenvalue"]
    assert found.failed[0].difference == pytest.approx(1e-3)


def test_other_numbers_of_cycles_and_other_endings(reference, tmp_path):
    path = tmp_path / "hunt.h5"
    found = compared(path, reference, study(cycles=study().cycles[:1]))
    assert found.verdict == "different" and "holds 1 numbers, in the reference 2" in found.as_text()
    found = compared(path, reference, study(status="partial"))
    assert found.verdict == "different" and "partial, the reference is ok" in found.as_text()
    found = compared(path, reference, study(status="running"))
    assert found.verdict == "unusable" and "resume" in found.as_text()


def test_only_what_is_chosen(reference, tmp_path):
    path = tmp_path / "hunt.h5"
    other = study(cycles=study().cycles[:1])
    assert compared(path, reference, other, channels=["figures.*"]).verdict == "equal"
    assert compared(path, reference, other, channels=["nothing"]).verdict == "unusable"


@pytest.fixture
def verb(tmp_path, monkeypatch, capsys):
    """Return a function that compares two files of the folder: exit code and output."""

    def compare(*names):
        paths = [str(tmp_path / name) for name in names]
        monkeypatch.setattr(sys, "argv", ["vehicledyn", "compare", *paths])
        with pytest.raises(SystemExit) as ended:
            main()
        return ended.value.code or 0, capsys.readouterr().out

    return compare


def test_the_verb_compares_every_kind(reference, tmp_path, make_result, verb):
    response = ResponseTable(
        "A car", "car", 20.0, np.array([1.0, 2.0]), (SPEED,), (SHIFT,),
        np.array([[[1.0 + 1j]], [[np.nan]]]), np.array([[1.0]]),
    )  # fmt: skip
    write_response(tmp_path / "response.h5", response)
    changed = replace(response, response=response.response * 1.01)
    write_response(tmp_path / "changed.h5", changed)
    assert verb("reference.h5", "reference.h5")[0] == 0
    assert verb("response.h5", "response.h5")[0] == 0
    assert verb("changed.h5", "response.h5")[0] == 1
    make_result("run.h5")
    for name, kind in (("response.h5", "frequency responses"), ("run.h5", "a run")):
        code, told = verb(name, "reference.h5")
        assert code == 2 and f"holds {kind}, the reference a hunting study" in told
