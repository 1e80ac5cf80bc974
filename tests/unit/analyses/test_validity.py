"""Where the model of a road vehicle no longer holds: rolling over ends a run and a case."""

import math
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result
from vehicledyn.results.store.study_reader import open_study
from vehicledyn.studies import load_study
from vehicledyn.studies.sweep import run_study

pytestmark = pytest.mark.long

SYSTEMS = Path(__file__).parents[3] / "scenarios" / "systems"
SMALL_CAR = SYSTEMS / "small_car.yaml"
STEERED = """\
title: The Iltis is steered hard on tyres that hold well
model: iltis
tyres: {kind: linear, nominal_load: 3500 N, longitudinal_stiffness: 60 kN,
  cornering_stiffness: 60 kN/rad, friction: 2}
road: {kind: flat}
wheel_spin: free
speed: 20 m/s
start: steady
manoeuvre: {kind: ramp_steer, rate: 60 mm/s, ramp_time: 0.5 s}
duration: 2 s
solver: {kind: rk4, step: 0.5 ms}
output: {interval: 10 ms}
"""
STUDY = """\
title: The Iltis on tyres that hold more or less well
scenario: steered.yaml
cases: {kind: grid, vary: {tyres.friction: [0.3, 2]}}
output: {channels: [chassis.*]}
"""


KERB = """\
title: The Iltis passes over a kerb in four points
model: iltis
tyres: {kind: magic_formula_1987}
road: {kind: profile, file: kerb.csv}
contact: vertical
wheel_spin: prescribed
speed: 20 km/h
start: static
manoeuvre: {kind: straight}
duration: 1.2 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


@pytest.fixture
def steered(tmp_path):
    path = tmp_path / "steered.yaml"
    path.write_text(STEERED, encoding="utf-8")
    return path


def test_a_vehicle_that_rolls_over_ends_its_run(steered, tmp_path):
    outcome = run_scenario(
        load_scenario(steered),
        output=tmp_path / "steered.h5",
        backend="auto",
        progress=lambda *_: None,
    )
    assert outcome.status == "overturned"
    (ending,) = [text for text in outcome.messages if text.startswith("overturned at t = ")]
    assert "leans by more than 70 deg from the road" in ending
    assert outcome.summary["overturned_body"].value == "chassis"
    with open_result(tmp_path / "steered.h5") as result:
        assert result.status == "overturned" and result.has_ended
        assert result.time[-1] == outcome.summary["overturned_at_time"].value < 2.0
        roll, pitch = (result.channel(f"chassis.{name}").values for name in ("roll", "pitch"))
    lean = np.arccos(np.cos(roll) * np.cos(pitch))
    assert lean[-1] == pytest.approx(math.radians(70.0), abs=1e-6)
    assert np.all(lean[:-1] < math.radians(70.0))
    assert outcome.summary["largest_roll_angle"].value <= math.radians(70.0) + 1e-6


def test_a_kerb_under_the_chassis_does_not_overturn_it(tmp_path):
    """The road's normal turns by 85 deg within 10 mm, the vehicle does not."""
    (tmp_path / "kerb.csv").write_text("x [m],z [m]\n0,0\n5,0\n5.01,0.08\n50,0.08\n")
    (tmp_path / "kerb.yaml").write_text(KERB, encoding="utf-8")
    outcome = run_scenario(
        load_scenario(tmp_path / "kerb.yaml"),
        output=tmp_path / "kerb.h5",
        backend="auto",
        progress=lambda *_: None,
    )
    assert outcome.status == "ok"
    with open_result(tmp_path / "kerb.h5") as result:
        assert result.time[-1] == pytest.approx(1.2)
        assert result.channel("chassis.x").values[-1] > 5.5
        assert np.abs(result.channel("chassis.pitch").values).max() < math.radians(10.0)


def test_a_case_that_rolls_over_says_so(steered, tmp_path):
    (tmp_path / "study.yaml").write_text(STUDY, encoding="utf-8")
    run_study(
        load_study(tmp_path / "study.yaml", ()),
        output=tmp_path / "study.h5",
        workers=1,
        lanes=None,
        resume=False,
        backend="auto",
        progress=lambda *_: None,
    )
    with open_study(tmp_path / "study.h5") as study:
        reasons = [bytes(text).decode() for text in study._file["cases/reason"][()]]
        ends = study._file["cases/end_time"][()]
    over = [reason.startswith("event 'chassis.overturned' at t = ") for reason in reasons]
    assert over[-1] and not over[0]
    assert all((end < 2.0) == told for end, told in zip(ends, over, strict=True))


def test_wheels_that_go_through_the_road_end_the_run(tmp_path):
    """Tyres of a hundredth of their stiffness let the wheels down to their centres."""
    loaded = load_scenario(
        SMALL_CAR, ("parameters.wheel.stiffness=1 kN/m", "start=nominal", "duration=1 s")
    )
    outcome = run_scenario(
        loaded, output=tmp_path / "s.h5", backend="auto", progress=lambda *_: None
    )
    assert outcome.status == "sunk"
    (ending,) = [text for text in outcome.messages if text.startswith("sunk at t = ")]
    assert "the centre of a wheel has gone through the road" in ending
    assert outcome.summary["sunk_body"].value == "chassis"
    with open_result(tmp_path / "s.h5") as result:
        assert result.status == "sunk" and result.has_ended
        assert result.time[-1] == outcome.summary["sunk_at_time"].value < 1.0
        radius = result.equations[1]["wheel.radius"][0]
        names = [name for name in result.channels if name.endswith(".tyre.deflection")]
        deepest = np.max([result.channel(name).values for name in names], axis=0)
    assert deepest[-1] == pytest.approx(radius, abs=1e-6)
    assert np.all(deepest[:-1] < radius)


def test_a_motorcycle_that_falls_over_ends_its_run(tmp_path):
    """Asked for too much lean it fell, and turned somersaults through the road with status ok."""
    loaded = load_scenario(SYSTEMS / "motorcycle.yaml", ("rider.lean=75 deg",))
    outcome = run_scenario(
        loaded, output=tmp_path / "m.h5", backend="auto", progress=lambda *_: None
    )
    assert outcome.status == "overturned"
    (ending,) = [text for text in outcome.messages if text.startswith("overturned at t = ")]
    assert "a wheel leans by more than 80 deg from the road" in ending
    assert outcome.summary["overturned_body"].value == "frame"
    with open_result(tmp_path / "m.h5") as result:
        roll = result.channel("frame.roll").values
    assert np.abs(roll).max() == pytest.approx(math.radians(80.0), abs=2e-2)
