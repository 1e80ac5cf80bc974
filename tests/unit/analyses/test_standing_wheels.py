"""A run tells of wheels on rails that stand, whose creep is not that of rolling."""

from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.files.scenario import load_scenario

ROOT = Path(__file__).parents[3]
SWING = """title: A wheelset on its rails
model: {model}
duration: 2 ms
solver: {{kind: rk4, step: 0.2 ms}}
output: {{interval: 1 ms}}
"""


@pytest.mark.parametrize(("speed", "told"), [("0 m/s", 1), ("20 m/s", 0)])
def test_wheels_that_stand_are_told(tmp_path, speed, told):
    path = tmp_path / "swing.yaml"
    path.write_text(SWING.format(model=ROOT / "systems" / "rail_wheelset.yaml"), encoding="utf-8")
    outcome = run_scenario(
        load_scenario(path, [f"parameters.speed={speed}"]),
        output=tmp_path / "swing.h5",
        backend="interpreted",
        plots=None,
        progress=lambda *_: None,
    )
    standing = [text for text in outcome.messages if "stand at the start: wheels;" in text]
    assert len(standing) == told
