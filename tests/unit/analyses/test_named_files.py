"""Files that a scenario names are found wherever they are named, and their content counts."""

import shutil
from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.memory.named_files import named_files
from vehicledyn.analyses.preparation.memory.run_cache import key_of_run
from vehicledyn.files.scenario import load_scenario

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def scenario(tmp_path):
    for folder in ("systems", "scenarios/systems"):
        (tmp_path / folder).mkdir(parents=True)
        shutil.copy(ROOT / folder / "slider_crank.yaml", tmp_path / folder)
    return tmp_path / "scenarios/systems/slider_crank.yaml"


def names(loaded):
    return {Path(path).name for path in named_files(loaded)}


def test_files_of_scenario_system_and_further_files(scenario, tmp_path):
    system = tmp_path / "systems/slider_crank.yaml"
    assert names(load_scenario(scenario)) == {"slider_crank.yaml"}
    scenario.with_name("own data.csv").write_text("1")
    system.with_name("layout.yaml").write_text(
        "list:\n  - 'deep one.csv'\nother: deeper.txt # no\n"
    )
    for name in ("deep one.csv", "deeper.txt", "unnamed.csv"):
        system.with_name(name).write_text("1")
    system.write_text(system.read_text() + "\n# layout.yaml\n")
    loaded = load_scenario(scenario, ["title=own data.csv"])
    expected = {"slider_crank.yaml", "own data.csv", "layout.yaml", "deep one.csv", "deeper.txt"}
    assert names(loaded) == expected


def test_changed_content_is_another_run(scenario, needs_compiler):
    data = scenario.with_name("data.csv")
    data.write_text("1.0")
    loaded = load_scenario(scenario, ["title=data.csv"])
    before = key_of_run(loaded)
    assert key_of_run(loaded) == before
    data.write_text("2.0")
    assert key_of_run(loaded) != before


def test_files_that_an_opencrg_file_includes_count(scenario):
    scenario.with_name("road.crg").write_text("$ROAD_CRG_FILE\nbelow.crg\n$!\n$$$$\nafter.crg\n")
    for name in ("below.crg", "after.crg"):
        scenario.with_name(name).write_text("1")
    found = names(load_scenario(scenario, ["title=road.crg"]))
    assert found == {"slider_crank.yaml", "road.crg", "below.crg"}
