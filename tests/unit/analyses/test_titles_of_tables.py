"""What an analysis computes of a changed model says so, whatever kind of table it is."""

from pathlib import Path

import pytest

import vehicledyn as vd

ROOT = Path(__file__).parents[3]
CHANGES = {"parameters.mass": "1.2 kg"}
SAID = ", changed: mass = 1.2 kg"


@pytest.mark.parametrize(
    "analysis",
    [
        lambda: vd.equilibrium("double_pendulum", set=CHANGES, backend="interpreted"),
        lambda: vd.modes("double_pendulum", set=CHANGES, backend="interpreted"),
        lambda: vd.kinematics("double_pendulum", {"upper.angle": "0 deg:10 deg:1"}, set=CHANGES),
    ],
    ids=["equilibrium", "modes", "kinematics"],
)
def test_the_title_of_a_table_holds_what_was_changed(analysis):
    assert SAID in analysis().title


def test_a_scenario_keeps_its_title_and_says_what_was_changed():
    loaded = vd.load(ROOT / "scenarios" / "systems" / "double_pendulum.yaml", set=CHANGES)
    assert loaded.title.endswith(", changed: mass = 1.2 kg")


def test_undamped_modes_are_counted_and_not_called_stable():
    text = vd.modes("double_pendulum", backend="interpreted").report.as_text()
    assert text.startswith("double_pendulum: 0 zeros, 2 undamped\n")
