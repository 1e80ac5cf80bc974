"""Runs that change their dependent coordinates go on from their last samples, to the last bit."""

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result

pytestmark = pytest.mark.validation

# None of its three bars can turn round: 0.3 + 1.35 > 0.9 + 0.7, so each comes to dead points.
FOUR_BAR = """\
title: A four-bar linkage of three rockers
constraint_method: {method}
bodies:
  crank:
    joints: [R2 angle]
    mass: 1 kg
    com: [0.15 m, 0, 0]
    inertia: [0, 0.0075 kg*m^2, 0.0075 kg*m^2]
  coupler:
    parent: crank
    at: [0.3 m, 0, 0]
    joints: [R2 angle]
    mass: 2 kg
    com: [0.45 m, 0, 0]
    inertia: [0, 0.135 kg*m^2, 0.135 kg*m^2]
  rocker:
    at: [1.35 m, 0, 0]
    joints: [{{kind: R2, name: angle, role: independent}}]
    mass: 1.5 kg
    com: [0.35 m, 0, 0]
    inertia: [0, 0.06125 kg*m^2, 0.06125 kg*m^2]
cuts:
  pin:
    kind: ball
    a: {{body: coupler, point: [0.9 m, 0, 0]}}
    b: {{body: rocker, point: [0.7 m, 0, 0]}}
initial:
  crank.angle: -90 deg
  crank.angle_rate: 8 rad/s
  coupler.angle: 75 deg
  rocker.angle: -150 deg
"""
SCENARIO = """\
title: Bars swing through dead points
model: bars.yaml
duration: 1.5 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""
CHANGED, LEFT = "partition.changed", "constraint_method.changed"


def run(folder, output, *overrides, restart=None):
    outcome = run_scenario(
        load_scenario(folder / "scenario.yaml", overrides),
        output=folder / output,
        backend="interpreted",
        progress=lambda *_: None,
        restart=None if restart is None else folder / restart,
    )
    assert outcome.status == "ok", outcome.messages
    return outcome


def write(folder, method, scenario=SCENARIO):
    (folder / "bars.yaml").write_text(FOUR_BAR.format(method=method), encoding="utf-8")
    (folder / "scenario.yaml").write_text(scenario, encoding="utf-8")


def times_of(result, name):
    return [event.time for event in result.events if event.name == name]


def assert_same(one, two):
    assert np.array_equal(one.time, two.time)
    assert np.array_equal(one.states.values, two.states.values, equal_nan=True)
    for name in one.channels:
        assert np.array_equal(one.channel(name).values, two.channel(name).values, equal_nan=True)
    assert one.events == two.events
    assert one.solver["accuracy"] == two.solver["accuracy"]


@pytest.mark.parametrize("method", ["partitioning", "auto"])
def test_a_linkage_of_rockers_goes_on_behind_its_dead_points(tmp_path, method):
    """Each piece goes on from the last one's: what is noted is carried from file to file."""
    write(tmp_path, method)
    run(tmp_path, "whole.h5")
    run(tmp_path, "piece.h5", "duration=0.45 s")
    for stop in (0.45, 0.72, 1.2):
        with open_result(tmp_path / "piece.h5") as piece:
            changes = times_of(piece, CHANGED)
            assert len(changes) >= 3
            assert bool(times_of(piece, LEFT)) == (method == "auto" and stop == 1.2)
            noted = piece.history(float(piece.time[-1])).time
            # Samples are held back near a dead point only, and a piece with multipliers is 0.16 s.
            assert stop - noted < 0.2
        ahead = {0.45: 0.72, 0.72: 1.2, 1.2: 1.5}[stop]
        outcome = run(tmp_path, "piece.h5", f"duration={ahead} s", restart="piece.h5")
        assert f"went on from t = {noted:.9g} s of " in " ".join(outcome.messages)
    with open_result(tmp_path / "whole.h5") as whole, open_result(tmp_path / "piece.h5") as piece:
        assert len(times_of(whole, CHANGED)) >= 6
        assert_same(whole, piece)
