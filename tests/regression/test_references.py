"""Every scenario has a small reference of its own text; check.sh compares the values."""

from pathlib import Path

import pytest

from vehicledyn.results.reader import open_result

FOLDER = Path(__file__).parent / "references"
SCENARIOS = sorted((Path(__file__).parents[2] / "scenarios").glob("*.yaml"))
LARGEST_SIZE = 100_000


def test_no_reference_without_scenario():
    assert SCENARIOS
    names = {path.stem for path in FOLDER.glob("*.h5")}
    assert names == {path.stem for path in SCENARIOS}, "run tests/regression/update.sh"


@pytest.mark.parametrize("scenario", SCENARIOS, ids=lambda path: path.stem)
def test_reference_belongs_to_the_scenario(scenario):
    file = FOLDER / f"{scenario.stem}.h5"
    assert file.stat().st_size < LARGEST_SIZE
    with open_result(file) as reference:
        assert reference.is_whole
        assert reference.scenario_text == scenario.read_text(), "run tests/regression/update.sh"
        assert len(reference.channels) >= 10
