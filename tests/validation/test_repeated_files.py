"""Two runs of a scenario give result files that are equal channel by channel."""

import numpy as np
import pytest
from reference_cases.motions import SCENARIOS, quiet

from vehicledyn.analyses import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.validation


def run(place):
    loaded = load_scenario(SCENARIOS / "iltis_slalom.yaml", ("duration=3 s",))
    outcome = run_scenario(loaded, output=place, backend="auto", progress=quiet)
    assert outcome.status == "ok"
    return place


def test_equal_channel_by_channel(tmp_path):
    with (
        open_result(run(tmp_path / "first.h5")) as first,
        open_result(run(tmp_path / "second.h5")) as second,
    ):
        assert len(first.time) == 301
        assert first.channels == second.channels
        for name in first.channels:
            np.testing.assert_array_equal(first.channel(name).values, second.channel(name).values)
        np.testing.assert_array_equal(first.states.values, second.states.values)
        assert first.summary == second.summary
        assert np.ptp(first.channel("chassis.y").values) > 0.1
