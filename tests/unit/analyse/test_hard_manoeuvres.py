"""Quickest motions that are hard to find: approached from slow ones, and of stiff models."""

from dataclasses import replace

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401 - registers models
from vehicledyn.analyse.optimal_control.shortened import solve_by_shortening
from vehicledyn.analyse.optimal_control.simulated import relative_errors
from vehicledyn.analyse.optimal_control.solve import Settings
from vehicledyn.analyse.optimal_control.transcription import PointModel
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.studies.manoeuvre_optimisation import run
from vehicledyn.studies.manoeuvre_optimisation.file import load_manoeuvre
from vehicledyn.studies.manoeuvre_optimisation.guess import first_guess, state_scales
from vehicledyn.studies.manoeuvre_optimisation.model import prepare_manoeuvre

CART = """\
title: A mass on a line
bodies:
  cart: {joints: [{kind: T1, name: place}], mass: 2 kg}
"""
PUSH = """\
title: From rest to rest
model: cart.yaml
controls:
  push: {input: force:cart.place, from: -4 N, to: 4 N}
minimise: time
duration: {from: 0.5 s, to: 10 s, guess: 2 s}
end: {cart.place: 1 m, cart.place_rate: 0}
intervals: 10
refinements: 0
"""
QUICKEST = 2.0 * np.sqrt(1.0 * 2.0 / 4.0)
"""2 (d m / F)^½ from rest to rest [s]."""


@pytest.fixture
def manoeuvre(tmp_path):
    """The quickest push, ready to be solved."""
    (tmp_path / "cart.yaml").write_text(CART, encoding="utf-8")
    (tmp_path / "push.yaml").write_text(PUSH, encoding="utf-8")
    return prepare_manoeuvre(load_manoeuvre(tmp_path / "push.yaml"), lambda *_: None)


def test_shortening_ends_at_the_quickest_motion(manoeuvre):
    """The same as the direct search, which is the closed form."""
    guess, _ = first_guess(manoeuvre)
    durations = []

    def watch(_number, _objective, _violation, at):
        durations.append(at().duration)

    settings = Settings(state_scales(guess), 1e-8, 100, watch)
    found = solve_by_shortening(PointModel(manoeuvre.problem), guess, guess, settings)
    assert not found.failure
    assert found.trajectory.duration == pytest.approx(QUICKEST, rel=1e-6)
    assert found.iterations == pytest.approx(len(durations), abs=20)
    assert max(durations[1:]) > 1.9


def test_a_search_that_fails_goes_on_by_shortening(manoeuvre, monkeypatch):
    """The report says so."""
    first, solve = [], run.solve_on_mesh

    def failing(*given):
        found = solve(*given)
        first.append(found)
        return replace(found, failure="it got lost")

    monkeypatch.setattr(run, "solve_on_mesh", failing)
    report = run.run_manoeuvre(manoeuvre.study, kept=KeptWork(), progress=lambda *_: None)
    assert len(first) == 1
    assert report.table.status == "ok"
    assert report.table.duration == pytest.approx(QUICKEST, rel=1e-6)
    assert any("shortening it little by little" in note for note in report.messages)


def test_rates_that_hardly_change_are_measured_by_their_size():
    """A wheel at 50 rad/s: what it differs by, over a thousandth of that."""
    states = np.array([[50.0, 1e-7], [50.0 + 1e-6, 0.0], [50.0, 0.0]])
    others = states + np.array([5e-5, 0.0])
    assert relative_errors(states, others, ["rad/s", "rad/s"])[0] == pytest.approx(1e-3, rel=1e-4)


DRAGGED = """\
title: A mass that drags others by stiff springs
bodies:
  front: {joints: [{kind: T1, name: x}], mass: 10 kg}
  middle: {joints: [{kind: T1, name: x}], mass: 10 g}
  rear: {joints: [{kind: T1, name: x}], mass: 1 kg}
forces:
  front:
    coordinate: front.x
    force: 10 MN/m * (middle.x - front.x) + 1 N*s/m * (middle.x_rate - front.x_rate)
  middle:
    coordinate: middle.x
    force: >-
      10 MN/m * (front.x + rear.x - 2 * middle.x)
      + 1 N*s/m * (front.x_rate + rear.x_rate - 2 * middle.x_rate)
  rear:
    coordinate: rear.x
    force: 10 MN/m * (middle.x - rear.x) + 1 N*s/m * (middle.x_rate - rear.x_rate)
"""
DRAG = """\
title: Drag masses from rest to rest
model: dragged.yaml
controls:
  pull: {input: force:front.x, from: -20 N, to: 20 N, rate: 100 N/s}
minimise: {time: 1, smoothness: 0.01}
duration: {from: 0.2 s, to: 9 s, guess: 2 s}
end: {front.x: 1 m, front.x_rate: 0, rear.x: 1 m, rear.x_rate: 0}
intervals: 12
refinements: 0
tolerance: 1e-6
most_iterations: 60
"""


def test_stiff_springs_do_not_stop_the_search(tmp_path):
    """Least pivots of a millionth miscount signs of eigenvalues: 11 iterations become over 60."""
    (tmp_path / "dragged.yaml").write_text(DRAGGED, encoding="utf-8")
    (tmp_path / "drag.yaml").write_text(DRAG, encoding="utf-8")
    study = load_manoeuvre(tmp_path / "drag.yaml")
    found = run.run_manoeuvre(study, kept=KeptWork(), progress=lambda *_: None).as_dict()
    assert found["status"] == "ok"
    assert found["iterations"] < 30
