"""Linear analyses from memory: nothing derived, nothing different, nothing taken for another."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.multibody.equations import derivation

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def system(tmp_path, monkeypatch, needs_compiler):
    """Return a copy of a small system, with a memory of its own."""
    monkeypatch.setenv("VEHICLEDYN_CACHE", str(tmp_path / "cache"))
    shutil.copy(ROOT / "systems/double_spring_mass.yaml", tmp_path)
    return tmp_path / "double_spring_mass.yaml"


@pytest.fixture
def derivations(monkeypatch):
    """Count how often equations are derived."""
    calls = []

    def counted(*arguments, **options):
        calls.append(arguments)
        return solve(*arguments, **options)

    solve = derivation.solve_motion
    monkeypatch.setattr(derivation, "solve_motion", counted)
    return calls


def slopes(path, **changes):
    return vd.sensitivity(path, "eigenvalues", **changes)["figure_slope"].values


def test_models_are_derived_once(system, derivations):
    first = slopes(system)
    assert len(derivations) == 1
    np.testing.assert_array_equal(slopes(system), first)
    vd.equilibrium(system)
    vd.modes(system)
    assert len(derivations) == 1
    assert not np.array_equal(slopes(system, set={"parameters.upper.mass": "3 kg"}), first)
    assert len(derivations) == 2
    system.write_text(system.read_text(encoding="utf-8") + "# changed\n", encoding="utf-8")
    slopes(system)
    assert len(derivations) == 3


def test_damaged_entries_and_those_others_may_write_are_not_read(system, tmp_path, derivations):
    first = slopes(system)
    (entry,) = (tmp_path / "cache/equations").glob("*.json")
    whole = entry.read_text(encoding="utf-8")
    for damage in (whole[:-90], whole.replace("eJ", "eK", 1), "{}"):
        count = len(derivations)
        entry.write_text(damage, encoding="utf-8")
        np.testing.assert_array_equal(slopes(system), first)
        assert len(derivations) == count + 1

    entry.chmod(0o666)
    slopes(system)
    assert len(derivations) == count + 2
