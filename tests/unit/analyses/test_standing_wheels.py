"""A run reports wheels that stand, and locked wheels with relaxation stand still."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.analyses.simulation.standing_wheels import CreepingWheels
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result

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
        progress=lambda *_: None,
    )
    standing = [text for text in outcome.messages if "stand at the start: wheels;" in text]
    assert len(standing) == told


PARKED = """title: A small car stands on a slope with locked wheels
model: {model}
tyres: {{kind: magic_formula_1987}}
road: {{kind: plane, slope_x: 0.1, slope_y: 0.05}}
wheel_spin: prescribed
speed: 0 m/s
start: static
manoeuvre: {{kind: straight}}
duration: 6 s
solver: {{kind: rk4, step: 1 ms}}
output: {{interval: 20 ms}}
"""
RELAXATION = "relaxation: {kind: first_order, longitudinal: 0.2 m, lateral: 0.4 m}\n"


def parked(folder, text):
    path = folder / "parked.yaml"
    path.write_text(text, encoding="utf-8")
    outcome = run_scenario(
        load_scenario(path),
        output=folder / "parked.h5",
        backend="auto",
        progress=lambda *_: None,
    )
    notes = [text for text in outcome.messages if text.startswith("wheels stand at the start")]
    with open_result(folder / "parked.h5") as result:
        assert result.solver["accuracy"] == "accurate"
        place = [result.channel(f"chassis.{axis}").values for axis in "xy"]
        half = len(result.time) // 2
        creep = [(p[-1] - p[half]) / (result.time[-1] - result.time[half]) for p in place]
    return notes, float(np.hypot(*creep))


@pytest.mark.long
def test_locked_wheels_stand_with_relaxation_and_are_reported_without(tmp_path, needs_compiler):
    """With RK4 at 1 ms: less than a micrometre a second; without it, millimetres and a note."""
    text = PARKED.format(model=ROOT / "systems" / "small_car.yaml")
    notes, creep = parked(tmp_path, text + RELAXATION)
    assert notes == []
    assert creep < 1e-6
    (note,), creep = parked(tmp_path, text)
    assert "give 'relaxation' for a vehicle that is to stand" in note
    assert creep > 1e-3


def watched(speed, spin, load=4e3):
    """Return what a watch says of a wheel that moves along for a second at constant rates."""
    times = np.linspace(0.0, 1.0, 101)
    outputs = np.stack([speed * times, 0 * times, spin + 0 * times, load + 0 * times], axis=1)
    wheels = CreepingWheels(["left"], np.arange(4)[None])
    for k in range(0, 101, 25):  # in blocks, as samples come
        wheels.take(times[k : k + 25], outputs[k : k + 25])
    return wheels.remarks()


def test_locked_wheels_that_creep_at_the_end_are_reported():
    (note,) = watched(-0.026, 0.002)
    assert note.startswith("warning: locked wheels creep at 26 mm/s at the end: left;")


@pytest.mark.parametrize(
    ("speed", "spin", "load"),
    [(1e-6, 0.0, 4e3), (-0.026, 0.076, 4e3), (3.0, 0.0, 4e3), (0.026, 0.0, 0.0)],
    ids=["stands", "rolls", "slides to its stop", "in the air"],
)
def test_other_wheels_at_the_end_are_not(speed, spin, load):
    assert watched(speed, spin, load) == []
