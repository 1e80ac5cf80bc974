"""Every scenario has a small reference of its own text; check.py compares the values."""

import re
from pathlib import Path

import pytest

from vehicledyn.results.store.reader import open_result

FOLDER = Path(__file__).parent / "references"
SCENARIOS = Path(__file__).parents[2] / "scenarios"
VEHICLES = sorted(SCENARIOS.glob("*.yaml"))
SYSTEMS = sorted((SCENARIOS / "systems").glob("*.yaml"))
OF_SEVERAL_FILES = (  # whose results keep the texts of all files
    "all_wheel_drive_sedan",
    "assembled_car",
    "automatic_sedan",
    "car_and_caravan",
    "car_of_parts",
    "coach_flexible_body",
    "coach_of_two_bogies",
    "manual_sedan",
    "off_road_truck_rough",
    "off_road_truck_sand",
    "off_road_truck_slope",
    "sedan",
    "tractor_semitrailer",
)
OF_SYSTEM = re.compile(r"^model: .*\.yaml$", re.MULTILINE)  # as update.sh tells them


@pytest.mark.parametrize(
    ("scenarios", "folder"), [(VEHICLES, FOLDER), (SYSTEMS, FOLDER / "systems")]
)
def test_no_reference_without_scenario(scenarios, folder):
    assert scenarios
    names = {path.stem for path in folder.glob("*.h5")}
    assert names == {path.stem for path in scenarios}, "run tests/regression/update.sh"


@pytest.mark.parametrize("scenario", [*VEHICLES, *SYSTEMS], ids=lambda path: path.stem)
def test_reference_belongs_to_the_scenario(scenario):
    is_small = scenario in SYSTEMS and scenario.stem not in OF_SEVERAL_FILES
    largest_size = 100_000 if is_small else 160_000
    fewest_channels = 3 if OF_SYSTEM.search(scenario.read_text()) else 10
    file = FOLDER / scenario.relative_to(SCENARIOS).with_suffix(".h5")
    assert file.stat().st_size < largest_size
    with open_result(file) as reference:
        assert reference.is_whole
        assert reference.scenario_text == scenario.read_text(), "run tests/regression/update.sh"
        assert len(reference.channels) >= fewest_channels
