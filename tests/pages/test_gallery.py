"""The gallery shows every scenario, with a small picture."""

import importlib.util
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SCENARIOS = [
    *sorted((ROOT / "scenarios").glob("*.yaml")),
    *sorted((ROOT / "scenarios" / "systems").glob("*.yaml")),
]
LARGEST_SIZE = 60_000


@pytest.fixture
def gallery(monkeypatch):
    specification = importlib.util.spec_from_file_location("gallery", ROOT / "reports/gallery.py")
    module = importlib.util.module_from_spec(specification)
    monkeypatch.setitem(sys.modules, "gallery", module)  # dataclasses look there
    specification.loader.exec_module(module)
    return module


def test_page_is_that_of_the_scenarios(gallery):
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    assert page == gallery.page(), "run python reports/gallery.py"


@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda path: path.stem)
def test_picture_is_there_and_small(scenario):
    picture = ROOT / "docs" / "figures" / f"{scenario.stem}.png"
    assert picture.is_file(), f"run python reports/gallery.py {scenario.stem}"
    assert picture.stat().st_size < LARGEST_SIZE


def test_every_scenario_has_its_place(gallery):
    assert gallery.scenarios() == SCENARIOS
    page = gallery.page()
    assert all(f"figures/{path.stem}.png" in page for path in SCENARIOS)


def test_pictures_belong_to_scenarios(gallery):
    assert set(gallery.PICTURES) <= {path.stem for path in SCENARIOS}
