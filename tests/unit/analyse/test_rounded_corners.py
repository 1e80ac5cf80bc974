"""Corners of laws are rounded on the way to an optimum, and the best that was found is kept."""

from dataclasses import replace

import casadi
import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401 - registers elements
from vehicledyn.analyse.optimal_control.rounded import has_least_or_most, rounded
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.studies.manoeuvre_optimisation import run
from vehicledyn.studies.manoeuvre_optimisation.file import load_manoeuvre

WHEEL = """\
title: A flywheel with dry friction
bodies:
  wheel: {joints: [{kind: R3, name: turn}], mass: 1 kg, inertia: [0, 0, 2 kg*m^2]}
elements:
  brake:
    kind: friction_coupling
    coordinate: wheel.turn
    limit: 1 N*m
    stiffness: 1000 N*m/rad
    damping: 1 N*m*s/rad
"""
FREE, _, _ = WHEEL.partition("elements:")
TURN = """\
title: Turn a flywheel against dry friction
model: wheel.yaml
controls:
  motor: {input: force:wheel.turn, from: -4 N*m, to: 4 N*m}
minimise: time
duration: {from: 0.5 s, to: 10 s, guess: 3 s}
end: {wheel.turn: 1 rad, wheel.turn_rate: 0}
intervals: 12
refinements: 0
tolerance: 1e-6
most_iterations: 100
"""
QUICKEST = np.sqrt(2.0 * (2.0 / (4.0 - 1.0) + 2.0 / (4.0 + 1.0)))
"""(2 φ (1/a + 1/b))^½ from rest to rest, a and b with friction against and for it [s]."""


def found(folder, wheel=WHEEL, refinements=0):
    """Return the report of the quickest turn."""
    text = TURN.replace("refinements: 0", f"refinements: {refinements}\naccuracy: 0")
    (folder / "wheel.yaml").write_text(wheel, encoding="utf-8")
    (folder / "turn.yaml").write_text(text, encoding="utf-8")
    study = load_manoeuvre(folder / "turn.yaml")
    return run.run_manoeuvre(study, kept=KeptWork(), progress=lambda *_: None)


def test_only_what_meets_is_rounded():
    """At a corner by half the width of what meets there; far from it, and at zero, hardly."""
    a, b = casadi.SX.sym("a"), casadi.SX.sym("b")
    both = casadi.vertcat(casadi.fmax(a, b), casadi.fmin(a, b), casadi.fmax(a, 0))
    values = casadi.Function("f", [a, b], [rounded(both, [a, b], 0.2)])
    assert values(3.0, 3.0).full().ravel() == pytest.approx([3.3, 2.7, 3.0])
    assert values(-2.0, 1e6).full().ravel() == pytest.approx([1e6, -2.0, 0.0], rel=1e-5)
    assert has_least_or_most(both, [a, b])
    assert not has_least_or_most(a * b, [a, b])


@pytest.mark.long
def test_the_quickest_turn_against_dry_friction_is_found_by_rounding_its_corners(tmp_path):
    """The direct search goes to and fro between sticking and sliding until it is ended."""
    report = found(tmp_path)
    assert report.table.status == "ok"
    assert any("corners were rounded" in note for note in report.messages)
    assert report.table.duration == pytest.approx(QUICKEST, rel=2e-3)


def test_the_best_motion_of_a_failed_search_is_kept_and_checked(tmp_path, monkeypatch):
    """Iterates that keep all conditions were seen before; the search ended elsewhere."""
    solve = run.solve_on_mesh

    def lost(model, guess, settings):
        easy = solve(model.within((2.0, 3.0)), guess, settings)
        assert not easy.failure
        return replace(easy, trajectory=guess, violation=1.0, failure="it got lost")

    monkeypatch.setattr(run._Search, "_solved", lambda _, *given: lost(*given))
    table = found(tmp_path, FREE).table
    assert (table.status, table.message) == ("failed", "it got lost")
    assert table.duration == pytest.approx(2.0, rel=1e-3)
    assert table.is_checked
    assert table.violation < 1e-6


def test_the_optimum_of_a_mesh_is_kept_where_the_next_one_fails(tmp_path, monkeypatch):
    solve, calls = run.solve_on_mesh, []

    def lost(model, guess, settings):
        calls.append(guess.n_intervals)
        easy = solve(model.within((2.0, 3.0)), guess, settings)
        return easy if len(calls) == 1 else replace(easy, failure="it got lost")

    monkeypatch.setattr(run._Search, "_solved", lambda _, *given: lost(*given))
    report = found(tmp_path, FREE, refinements=1)
    assert len(calls) == 2
    assert (report.table.status, report.table.n_intervals) == ("ok", 12)
    assert any("it got lost" in note and "on 12 intervals" in note for note in report.messages)
