"""Driven coordinates whose motion has a kink are reported, smooth ones are not."""

from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.simulation.kinked_drives import kinked_drives
from vehicledyn.files.scenario import load_scenario

SYSTEM = """\
title: A load swings under a trolley
parameters: {speed: 2 m/s}
bodies:
  trolley: {joints: [T1 x]}
  load: {parent: trolley, joints: [R2 swing], mass: 10 kg, com: [0, 0, -1 m]}
drives:
  travel: {coordinate: trolley.x, law: LAW}
"""
SCENARIO = """\
title: It swings
model: crane.yaml
duration: 4 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
SHIPPED = Path(__file__).parents[3] / "scenarios"


def lines(folder, law):
    (folder / "crane.yaml").write_text(SYSTEM.replace("LAW", law))
    path = folder / "swings.yaml"
    path.write_text(SCENARIO)
    return kinked_drives(build_subject(load_scenario(path)), 4.0)


@pytest.mark.parametrize(
    ("law", "told"),
    [
        ("max(0 m, speed * (time - 1.3 s))", "the rate of 'trolley.x' jumps by 2 m/s at t = 1.3 s"),
        ("abs(speed * (time - 0.7 s))", "jumps by 4 m/s at t = 0.7 s"),
        ("where(time < 3.1 s, 0 m, 50 mm)", "'trolley.x' jumps by 0.05 m at t = 3.1 s"),
    ],
)
def test_jumps_are_found_and_named(law, told, tmp_path):
    (line,) = lines(tmp_path, f"{{kind: expression, position: '{law}'}}")
    assert told in line
    assert "give its law a continuous rate" in line


@pytest.mark.parametrize(
    "law",
    [
        "{kind: constant_rate, rate: speed}",
        "{kind: ramp, last: 1 m, begin: 1 s, duration: 20 ms}",
        "{kind: sine, amplitude: 1 m, frequency: 20 Hz}",
        "{kind: expression, position: 'max(0 s, time - 1 s)**2 * 1 m/s^2'}",
    ],
)
def test_smooth_laws_are_not(law, tmp_path):
    assert lines(tmp_path, law) == []


@pytest.mark.parametrize("name", ["systems/curving_wheelset", "systems/quarter_car"])
def test_shipped_motions_are_smooth(name):
    loaded = load_scenario(SHIPPED / f"{name}.yaml")
    assert kinked_drives(build_subject(loaded), loaded.scenario.duration) == []
