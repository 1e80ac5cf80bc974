"""A wheel that leaves its rail ends the run with time and place."""

import re
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result

ROOT = Path(__file__).parents[3]
JUMP = """title: A wheelset jumps over its left rail
model: {model}
initial: {{wheelset.lateral: 5 mm, wheelset.vertical: 30 mm, wheelset.lateral_rate: 2 m/s}}
duration: 1 s
solver: {{kind: rk4, step: 0.2 ms}}
output: {{interval: 1 ms}}
"""


def test_run_ends_where_the_flange_is_over_the_rail(tmp_path):
    path = tmp_path / "jump.yaml"
    path.write_text(JUMP.format(model=ROOT / "systems" / "rail_wheelset.yaml"), encoding="utf-8")
    outcome = run_scenario(
        load_scenario(path),
        output=tmp_path / "jump.h5",
        backend="interpreted",
        progress=lambda *_: None,
    )
    (ending,) = [text for text in outcome.messages if "derailed" in text]
    assert ending.startswith("derailed at t = 0.0114")
    assert "s, 0.2291 m along the track: the left wheel of 'wheels' has left its rail" in ending
    assert outcome.status == "derailed"
    assert outcome.summary["derailed_wheel"].value == "wheels.left"
    assert outcome.summary["derailed_at_place"].value == pytest.approx(0.2291, abs=5e-5)
    with open_result(tmp_path / "jump.h5") as result:
        assert result.status == "derailed" and result.has_ended
        assert ending == result.status_message == result.state_of_run
        assert result.time[-1] == outcome.summary["derailed_at_time"].value
        lateral = result.channel("wheelset.lateral").values
    # The tip of the flange, 55 mm inside the tape circle, is 5 mm outside the gauge face.
    assert 0.75 - 0.0550 + lateral[-1] == pytest.approx(0.7177 + 0.005, abs=2e-4)
    assert np.isfinite(lateral).all()


def started_at(tmp_path, lateral):
    path = tmp_path / "start.yaml"
    text = JUMP.format(model=ROOT / "systems" / "rail_wheelset.yaml").replace("1 s", "10 ms")
    initial = f"initial: {{wheelset.lateral: {lateral}}}\n"
    path.write_text(re.sub("initial: .*\n", initial, text), encoding="utf-8")
    return run_scenario(
        load_scenario(path),
        output=tmp_path / "start.h5",
        backend="interpreted",
        progress=lambda *_: None,
    )


@pytest.mark.parametrize("lateral", ["22 mm", "-12 mm"])
def test_start_with_a_flange_in_the_rail_is_refused_by_wheel_and_place(tmp_path, lateral):
    """It was told that its step is too long."""
    side = "right" if lateral.startswith("-") else "left"
    with pytest.raises(InputError) as told:
        started_at(tmp_path, lateral)
    words = rf"beside the rails: the {side} wheel of 'wheels' is [\d.]+ mm deep in its rail, "
    shift = lateral.strip("-")
    assert re.search(
        rf"{words}shifted to the {side} by {shift}; give start values", str(told.value)
    )
    assert not (tmp_path / "start.h5").exists()


@pytest.mark.parametrize(("lateral", "status"), [("6 mm", "ok"), ("45 mm", "derailed")])
def test_starts_at_the_flange_run_and_those_off_the_rails_end_at_once(tmp_path, lateral, status):
    outcome = started_at(tmp_path, lateral)
    assert outcome.status == status
    if status == "derailed":
        assert outcome.summary["derailed_at_time"].value == 0.0
