"""Runs from memory: nothing derived, nothing different, nothing taken for what it is not."""

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.memory.run_cache import key_of_run, recall
from vehicledyn.analyses.simulation import prepared_run as rerun
from vehicledyn.analyses.simulation.simulation import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.multibody.equations import derivation

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def scenario(tmp_path, monkeypatch, needs_compiler):
    """Return a copy of a scenario, with a memory of its own."""
    monkeypatch.setenv("VEHICLEDYN_CACHE", str(tmp_path / "cache"))
    for folder in ("systems", "scenarios/systems"):
        target = tmp_path / folder
        target.mkdir(parents=True)
        shutil.copy(ROOT / folder / "slider_crank.yaml", target)
    return tmp_path / "scenarios/systems/slider_crank.yaml"


def run(path, output, *changes):
    loaded = load_scenario(path, changes)
    return run_scenario(loaded, output=output, backend="auto", progress=lambda *_: None)


def contents(path):
    found = {}
    with h5py.File(path) as file:
        file.visititems(
            lambda name, item: (
                found.update({name: item[()]}) if isinstance(item, h5py.Dataset) else None
            )
        )
    return found


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


def test_second_run_derives_nothing_and_is_equal(scenario, tmp_path, derivations):
    first = run(scenario, tmp_path / "first.h5")
    assert len(derivations) == 1
    second = run(scenario, tmp_path / "second.h5", "title=Another title")
    assert len(derivations) == 1
    assert second.summary == first.summary
    old, new = contents(tmp_path / "first.h5"), contents(tmp_path / "second.h5")
    assert old.keys() == new.keys()
    numbers = [name for name, value in old.items() if np.asarray(value).dtype.kind == "f"]
    assert len(numbers) > 10
    for name in numbers:
        np.testing.assert_array_equal(new[name], old[name], err_msg=name)
    with h5py.File(tmp_path / "first.h5") as a, h5py.File(tmp_path / "second.h5") as b:
        assert a.attrs["model_hash"] == b.attrs["model_hash"]


def test_anything_that_matters_is_another_run(scenario):
    plain = key_of_run(load_scenario(scenario))
    changed = [("initial.crank.angle=31 deg",), ("parameters.crank.mass=3 kg",)]
    keys = {key_of_run(load_scenario(scenario, change)) for change in changed}
    assert len(keys | {plain}) == 1 + len(changed)
    assert key_of_run(load_scenario(scenario, ("output.interval=20 ms",))) == plain


def test_a_run_of_another_duration_derives_nothing(scenario, tmp_path, derivations):
    run(scenario, tmp_path / "long.h5")
    run(scenario, tmp_path / "short.h5", "duration=100 ms")
    assert len(derivations) == 1
    long, short = contents(tmp_path / "long.h5"), contents(tmp_path / "short.h5")
    assert 2 < short["time"].size < long["time"].size
    angle = next(name for name in short if name.endswith("crank/angle"))
    np.testing.assert_allclose(short[angle], long[angle][: short["time"].size], rtol=1e-10)


def test_changed_system_file_is_another_run(scenario):
    plain = key_of_run(load_scenario(scenario))
    system = scenario.parents[2] / "systems/slider_crank.yaml"
    system.write_text(system.read_text(encoding="utf-8") + "\n# changed\n", encoding="utf-8")
    assert key_of_run(load_scenario(scenario)) != plain


@pytest.mark.parametrize("part", ["tyres.front", "manoeuvre", "manoeuvre.driver", "road"])
def test_parts_of_others_are_not_remembered(needs_compiler, monkeypatch, part):
    """Their code is not among the files that the key follows from."""
    loaded = load_scenario(ROOT / "scenarios/iltis_slalom.yaml")
    assert key_of_run(loaded) is not None
    item = loaded.scenario
    for name in part.split("."):
        item = getattr(item, name)
    monkeypatch.setattr(type(item), "__module__", "others.parts")
    assert key_of_run(loaded) is None


def test_damaged_memory_is_as_good_as_none(scenario, tmp_path, derivations):
    run(scenario, tmp_path / "first.h5")
    key = key_of_run(load_scenario(scenario))
    (entry,) = (tmp_path / "cache/runs").glob("*.json")
    whole = entry.read_text(encoding="utf-8")
    for damage in ("", "{}", "[1]", whole[: len(whole) // 2], whole.replace("0", "1", 1)):
        entry.write_text(damage, encoding="utf-8")
        assert recall(key) is None
    run(scenario, tmp_path / "second.h5")
    assert len(derivations) == 2
    assert recall(key) is not None


def test_memory_without_its_kernel_derives_again(scenario, tmp_path, derivations):
    run(scenario, tmp_path / "first.h5")
    for library in (tmp_path / "cache").glob("*.*"):
        if library.is_file():
            library.unlink()
    run(scenario, tmp_path / "second.h5")
    assert len(derivations) == 2


def test_expressions_are_derived_when_asked_for(scenario, tmp_path, derivations):
    run(scenario, tmp_path / "first.h5")
    loaded = load_scenario(scenario)
    prepared, start = rerun.prepare_run(loaded, backend="auto", progress=lambda *_: None)
    assert len(derivations) == 1
    assert prepared.equations.rate.shape == (start.state.size, 1)
    assert prepared.derivatives is not None
    assert prepared.watch is not None
    assert len(derivations) == 2


def test_folder_that_cannot_be_written_is_no_error(scenario, tmp_path, monkeypatch):
    (tmp_path / "cache").mkdir()
    (tmp_path / "cache/runs").write_text("in the way", encoding="utf-8")
    assert run(scenario, tmp_path / "first.h5").status == "ok"
