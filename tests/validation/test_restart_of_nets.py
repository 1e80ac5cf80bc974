"""Runs of nets go on from their results, also behind a switch from partitioning to multipliers."""

import numpy as np
import pytest
from nets import net_text

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.validation

SCENARIO = """\
title: A net hangs by a corner
model: net.yaml
duration: 1.25 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


def run(folder, output, *overrides, restart=None):
    (folder / "net.yaml").write_text(net_text(3, 2, pinned=((0, 0),)), encoding="utf-8")
    path = folder / "scenario.yaml"
    path.write_text(SCENARIO, encoding="utf-8")
    outcome = run_scenario(
        load_scenario(path, overrides),
        output=folder / output,
        backend="interpreted",
        progress=lambda *_: None,
        restart=None if restart is None else folder / restart,
    )
    assert outcome.status == "ok", outcome.messages
    return open_result(folder / output)


def energy(result):
    return sum(result.channel(f"energy.{kind}").values for kind in ("kinetic", "gravity"))


@pytest.mark.parametrize("first", ["0.35 s", "1.15 s"])
def test_a_net_goes_on_from_its_result(tmp_path, first):
    """Before and behind the switch, from its last samples; the two pieces are one to the bit."""
    with run(tmp_path, "whole.h5") as whole:
        names = [event.name for event in whole.events]
        assert names.count("constraint_method.changed") == 1
        switched = next(e.time for e in whole.events if e.name == "constraint_method.changed")
        assert 0.35 < switched < 1.15
        with run(tmp_path, "first.h5", f"duration={first}") as piece:
            assert ("constraint_method.changed" in [e.name for e in piece.events]) == (
                first == "1.15 s"
            )
            stop = float(piece.time[-1])
            begin = piece.history(stop).time
            assert stop - begin < 0.2 and (begin >= switched) == (first == "1.15 s")
        with run(tmp_path, "second.h5", restart="first.h5") as second:
            assert second.status == "ok"
            assert second.time == pytest.approx(np.array(whole.time), abs=1e-12)
            spread = np.ptp(energy(whole)) + 1e-6
            assert np.ptp(energy(second)) < 2.0 * spread
            for name in whole.channels:
                one, two = (found.channel(name).values for found in (whole, second))
                assert np.array_equal(one, two, equal_nan=True), name
            assert [e.name for e in second.events] == names
