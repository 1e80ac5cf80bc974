"""Every command and every listing of docs/sweeps.md works."""

import re
import sys
from pathlib import Path

import pytest
from programs import run
from test_documents import BLOCK, README, blocks

from vehicledyn.results.store.study_reader import open_study

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def folder(tmp_path_factory, needs_compiler):
    place = tmp_path_factory.mktemp("sweeps")
    (scenario,) = blocks(README, "yaml")
    (place / "my_ramp.yaml").write_text(scenario, encoding="utf-8")
    names = iter(["loads.yaml", "roads.yaml", "masses.csv", "masses.yaml"])
    for kind, text in BLOCK.findall(PAGE):
        if kind in ("yaml", "csv"):
            name = next(names)
            assert f"`{name}`" in PAGE
            (place / name).write_text(text, encoding="utf-8")
    for block in blocks(PAGE, "sh"):
        for line in block.splitlines():
            run(line, place)
    return place


def test_studies_run(folder):
    with open_study(folder / "loads.h5") as loads, open_study(folder / "roads.h5") as roads:
        assert loads.counts()["done"] == loads.n_cases == 24
        assert roads.counts()["done"] == 6
        flat, inclined = roads.channel("accelerometer.lateral")[[1, 4], 0]
    assert abs(flat) < 0.1
    assert abs(inclined - flat) > 0.1  # gravity across the road
    with open_study(folder / "loads_and_speeds.h5") as masses:
        assert masses.values()[:, 0] == pytest.approx([1200.0, 1400.0, 1400.0])
        assert not masses.channels
        assert masses.figure("largest_roll_angle").min() > 0.0
    drawn = {path.stem for path in (folder / "loads_plots").glob("*.png")}
    assert drawn == {"distributions", "effects", "channels"}


def test_reading_in_python(folder):
    (listing,) = blocks(PAGE, "python")
    told = run([sys.executable, "-c", listing], folder)
    assert told.startswith("24 cases of 24\n(24, 3) ['speed', ")
    assert told.endswith("(4, 101)\n")


def test_links_lead_to_files():
    links = re.findall(r"\]\(([^)#:]+)\)", PAGE)
    assert links
    assert [link for link in links if not (ROOT / "docs" / link).exists()] == []
