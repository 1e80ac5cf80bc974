"""Every listing of the page on system files works, and every example runs."""

import os
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from programs import run
from system_texts import Motion

from vehicledyn.files.building.construct import build_system
from vehicledyn.files.system.read import read_system
from vehicledyn.files.system.sets import SystemFile
from vehicledyn.multibody import derive
from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.long

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "systems.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
LISTINGS = {
    re.match(r"# (\S+)\n", body)[1]: body for kind, body in BLOCK.findall(PAGE) if kind == "yaml"
}
SYSTEMS = [name for name, body in LISTINGS.items() if "model:" not in body]
SCENARIOS = sorted((ROOT / "scenarios" / "systems").glob("*.yaml"))


def test_commands_of_the_page(tmp_path):
    for name, body in LISTINGS.items():
        (tmp_path / name).write_text(body, encoding="utf-8")
    shutil.copytree(ROOT / "systems", tmp_path / "systems")
    commands = [body for kind, body in BLOCK.findall(PAGE) if kind == "sh"]
    assert commands
    for line in "".join(commands).splitlines():
        run(line, tmp_path)
    with open_result(tmp_path / "longer.h5") as result:
        table = result.as_frame()
    tip = np.hypot(table["tip.x"], table["tip.z"])
    assert np.allclose(tip, 1.0, rtol=1e-12)
    assert table["rod.angle_rate"].iloc[0] == 1.0
    assert (tmp_path / "swing_plots" / "coordinates.png").is_file()


@pytest.mark.parametrize("name", SYSTEMS)
def test_system_of_the_page_moves(name, tmp_path):
    for file in SYSTEMS:
        (tmp_path / file).write_text(LISTINGS[file], encoding="utf-8")
    model, problems = read_system(tmp_path / name)
    assert [str(problem) for problem in problems] == []
    seen = Motion(derive(build_system(model))).at(0.1)
    assert all(np.isfinite(value) for value in seen.values())
    assert seen.get("constraints.position_error", 0.0) < 1e-10


def test_page_names_every_section():
    """Kinds have their pages in the reference, which is made from the catalogues."""
    told = set(re.findall(r"`(\w+)`", PAGE))
    written = set(re.findall(r"^(\w+):", "\n".join(LISTINGS.values()), re.MULTILINE))
    assert set(SystemFile.model_fields) - {"title", "description"} - told - written == set()


def test_links_of_the_page_lead_to_files():
    links = re.findall(r"\]\(([^)#:]+)\)", PAGE)
    assert links
    assert [link for link in links if not (ROOT / "docs" / link).exists()] == []


@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda path: path.stem)
def test_example_runs_and_keeps_its_balance_of_energy(scenario, tmp_path):
    kept = Path(os.environ.get("CHECKED_RESULTS", tmp_path)) / "systems" / f"{scenario.stem}.h5"
    if kept.is_file() and keeps_its_balance(kept):  # tests/regression/check.py ran all of it
        return
    result = tmp_path / "result.h5"
    short = ["--set", "duration=0.5 s"]
    run(["vehicledyn", "run", str(scenario), "-o", str(result), "--no-plots", *short], tmp_path)
    assert keeps_its_balance(result)


def keeps_its_balance(path):
    with open_result(path) as found:
        assert found.is_whole
        summary = {name: entry.value for name, entry in found.summary.items()}
    return summary.get("largest_loop_gap", 0.0) < 1e-10 and summary.get("energy_drift", 0.0) < 2e-3


def test_every_example_system_has_a_scenario_or_a_test_or_is_part_of_another():
    texts = {path.stem: path.read_text(encoding="utf-8") for path in ROOT.glob("systems/*.yaml")}
    scenarios = [path.read_text(encoding="utf-8") for path in ROOT.glob("scenarios/**/*.yaml")]
    named = re.compile(r"^ *(?:model|- file|file): (?:.*/)?(\w+)\.yaml$", re.MULTILINE)
    used = {name for text in [*scenarios, *texts.values()] for name in named.findall(text)}
    tests = "".join(path.read_text("utf-8") for path in ROOT.glob("tests/*/**/test_*.py"))
    assert used <= texts.keys()
    named = re.compile(r"[\"'/](\w+)(?:\.yaml)?[\"']")
    assert texts.keys() - used - set(named.findall(tests)) == set()
