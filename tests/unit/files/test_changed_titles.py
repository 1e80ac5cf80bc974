"""The title of a run says what was changed of its scenario."""

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.files.scenario import load_scenario
from vehicledyn.files.scenario.titles import changed_title
from vehicledyn.library import find_entry


def test_the_title_of_a_changed_run_says_so():
    path = find_entry("iltis_ramp_steer", ("scenario",)).path
    loaded = load_scenario(path, ["speed=10 m/s"])
    assert loaded.title == "Iltis benchmark, ramp steer at 20 m/s, changed: speed = 10 m/s"
    assert load_scenario(path).title == "Iltis benchmark, ramp steer at 20 m/s"


@pytest.mark.parametrize(
    ("changes", "end"),
    [
        (["parameters.chassis.mass=1.5 t"], ", changed: chassis.mass = 1.5 t"),
        (['length="2 m"'], ", changed: length = 2 m"),
        (["speed=1 m/s", "speed=2 m/s"], ", changed: speed = 2 m/s"),
        (["solver.step=1 ms", "duration=3 s", "output.interval=1 s"], ""),
        (["title=Mine", "speed=2 m/s"], ""),
        (["a=1", "b=2", "c=3", "d=4", "e=5"], ", changed: a = 1, b = 2, c = 3, and 2 more"),
    ],
)
def test_what_a_title_says_of_changes(changes, end):
    assert changed_title("Mine", changes) == f"Mine{end}"
