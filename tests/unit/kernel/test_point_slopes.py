"""Compiled fields of limit cycles give what CasADi gives, whatever the number of points."""

import numpy as np
import pytest
from cycle_examples import (
    field,
    from_hopf,
    gap_oscillator,
    looped_normal_form,
    normal_form,
    sampled_orbit,
)
from solve_examples import build, symbols
from table_examples import height, quintic, rider

from vehicledyn.analyse.periodic import autonomous, monodromy
from vehicledyn.analyse.periodic.monodromy import passages
from vehicledyn.analyse.periodic.nonsmooth_points import Kinks

pytestmark = pytest.mark.long


@pytest.mark.parametrize(
    ("make", "parameter"),
    [
        (looped_normal_form, "mu"),
        (lambda: rider(height(), quintic()), "k"),
        (lambda: rider(height(3), quintic(0.2)), "m"),
    ],
)
def test_values_and_slopes_are_those_of_casadi(needs_compiler, monkeypatch, make, parameter):
    rng = np.random.default_rng(8)
    interpreted = field(make(), parameter)
    assert interpreted._compiled is None
    monkeypatch.setattr(autonomous, "LEAST", 0)
    compiled = field(make(), parameter)
    assert compiled._compiled is not None
    for count in (1, 3, 17):
        states = rng.uniform(-1.0, 1.5, (count, compiled.size))
        unknowns = rng.uniform(0.0, 0.3, (count, compiled.n_unknowns))
        value = rng.uniform(0.5, 1.5)
        wanted = interpreted.evaluate(states, unknowns, value)
        found = compiled.evaluate(states, unknowns, value)
        for name, right in vars(wanted).items():
            here = getattr(found, name)
            assert here.shape == right.shape
            assert here == pytest.approx(right, rel=1e-11, abs=1e-12), name


def test_branch_of_cycles_is_the_same(needs_compiler, monkeypatch):
    monkeypatch.setattr(autonomous, "LEAST", 0)
    _, branch = from_hopf(field(normal_form(1.0, -1.0), "mu"), -1.0, 1.0)
    (fold,) = branch.special
    # Found by following the motion, with steps that err by 3e-8.
    assert fold.orbit.parameter == pytest.approx(-0.25, abs=1e-8)


def test_small_fields_and_those_without_a_compiler_are_interpreted(monkeypatch):
    assert field(normal_form(1.0), "mu")._compiled is None
    monkeypatch.setattr(autonomous, "LEAST", 0)
    monkeypatch.setenv("VEHICLEDYN_CC", "none")
    alone = field(normal_form(1.0), "mu")
    assert alone._compiled is None
    assert np.isfinite(alone.evaluate(np.ones((2, alone.size)), np.zeros((2, 0)), 0.3).rates).all()


def test_kinks_are_those_of_casadi(needs_compiler, monkeypatch):
    model = field(gap_oscillator(), "mu")
    _, branch = from_hopf(model, -0.1, 0.5)
    orbit = branch.points[-1].orbit
    interpreted = Kinks(model)
    wanted = interpreted.along(orbit)
    assert wanted.size and interpreted._deciding.compiled is None
    monkeypatch.setattr(autonomous, "LEAST", 0)
    compiled = Kinks(model)
    assert compiled._deciding.compiled is not None
    assert compiled.along(orbit) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize(
    ("make", "span"), [(lambda: normal_form(1.0, -1.0), (-1.0, 1.0)), (gap_oscillator, (-0.1, 0.5))]
)
def test_compiled_motions_are_those_of_the_implicit_method(needs_compiler, monkeypatch, make, span):
    """Explicit steps in lanes and Radau's method carry pieces and tangents to the same places."""
    monkeypatch.setattr(autonomous, "LEAST", 0)
    model = field(make(), "mu")
    assert model._compiled.carries_motion
    _, branch = from_hopf(model, *span)
    orbit = branch.points[-1].orbit
    quick = passages(model, orbit, tolerance=1e-8)
    monkeypatch.setattr(monodromy, "_MOST_EXPLICIT", 1)
    slow = passages(model, orbit, tolerance=1e-9)
    for name in ("ends", "by_state", "by_parameter", "first", "last"):
        assert getattr(quick, name) == pytest.approx(getattr(slow, name), abs=1e-6), name
    assert not np.array_equal(quick.ends, slow.ends)
    assert 0.0 < quick.error <= 1e-8


def test_long_steps_stay_stable_where_motions_decay_fast(needs_compiler, monkeypatch):
    """Beside the circle r = 1 a state decays at 3000/s: what is left of it is nothing."""
    monkeypatch.setattr(autonomous, "LEAST", 0)
    t, x, y, w, m = symbols("t", "x", "y", "w", "mu")
    r2 = x * x + y * y
    equations = build(
        "stiff", time=t, states=[(x, 1.0), (y, 0.0), (w, 0.0)],
        rates=[x * (m - r2) - y, y * (m - r2) + x, -3000.0 * (w - x)],
        parameters=[(m, 1.0)], outputs=[("x", x)],
    )  # fmt: skip
    orbit = sampled_orbit(
        2.0 * np.pi, 1.0,
        lambda s: np.column_stack([f(2 * np.pi * s) for f in (np.cos, np.sin, np.cos)]),
    )  # fmt: skip
    model = field(equations, "mu")
    found = passages(model, orbit, tolerance=1e-4)
    assert model._compiled.carries_motion
    assert np.abs(found.by_state[:, 2, 2]).max() < 0.02
    assert np.sort(np.abs(np.linalg.eigvals(found.monodromy))) == pytest.approx(
        [0.0, np.exp(-4.0 * np.pi), 1.0], abs=1e-3
    )
