"""Tangents along paths that compiled code has found, against the implicit method and its laws."""

from dataclasses import replace

import numpy as np
import pytest
from cycle_examples import field, from_hopf, gap_oscillator, normal_form

from vehicledyn.analyse.periodic import autonomous, monodromy
from vehicledyn.analyse.periodic.monodromy import durations_of, passages, passages_along
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel import path_tangents

pytestmark = pytest.mark.long


def orbit_of(monkeypatch, make, span):
    """A field with compiled code and the last orbit of its branch."""
    monkeypatch.setattr(autonomous, "LEAST", 0)
    model = field(make(), "mu")
    _, branch = from_hopf(model, *span)
    return model, branch.points[-1].orbit


def path_of(model, orbit, error):
    return model.followed(
        orbit.states[0], orbit.parameter, durations_of(orbit), scales=orbit.scales(),
        tolerance=error, trials=20_000,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("make", "span", "bound"),
    [(lambda: normal_form(1.0, -1.0), (-1.0, 1.0), 2e-6), (gap_oscillator, (-0.1, 0.5), 3e-4)],
)
def test_passages_along_a_path_are_those_of_the_implicit_method(
    needs_compiler, monkeypatch, make, span, bound
):
    """Steps of a path and Radau's method lead to the same maps, across kinks up to 1e-4 of 7."""
    model, orbit = orbit_of(monkeypatch, make, span)
    path = path_of(model, orbit, 1e-10)
    orbit = replace(orbit, states=np.concatenate([path.nodes[:1], path.places[:-1]]))
    quick = passages_along(model, orbit, path, orbit.scales(), tolerances=[1e-6])
    monkeypatch.setattr(monodromy, "_MOST_EXPLICIT", 1)
    slow = passages(model, orbit, tolerance=1e-9)
    for name in ("ends", "by_state", "by_parameter", "first", "last"):
        assert getattr(quick, name) == pytest.approx(getattr(slow, name), abs=bound), name
    assert 0.0 < quick.error <= bound


def test_steps_across_kinks_are_made_smaller(needs_compiler, monkeypatch):
    """On a coarse path with four kinks the trivial multiplier comes to 1 with the tolerance."""
    model, orbit = orbit_of(monkeypatch, gap_oscillator, (-0.1, 0.5))
    path = path_of(model, orbit, 1e-5)
    found = [
        passages_along(model, orbit, path, orbit.scales(), tolerances=[tolerance])
        for tolerance in (np.inf, 1e-2, 1e-4)
    ]
    missed = [abs(p.trivial - 1.0) for p in found]
    assert missed[0] > 3.0 * missed[2] and missed[2] < 2e-3
    assert found[0].error > 1e-2 >= found[1].error > 1e-4 >= found[2].error


def test_a_path_is_told_by_its_steps(needs_compiler, monkeypatch):
    """Steps fill the durations, rates are those of the nodes; too few trials lead nowhere."""
    model, orbit = orbit_of(monkeypatch, lambda: normal_form(1.0, -1.0), (-1.0, 1.0))
    path, durations = path_of(model, orbit, 1e-8), durations_of(orbit)
    filled = np.add.reduceat(path.sizes, path.begins)
    assert filled == pytest.approx(durations, rel=1e-12)
    empty = np.zeros((len(path.nodes), 0))
    rates = model.evaluate(path.nodes, empty, orbit.parameter).rates
    assert path.rates == pytest.approx(rates, abs=1e-12)
    assert path.times + path.sizes == pytest.approx(np.cumsum(path.sizes))
    few = model.followed(
        orbit.states[0], orbit.parameter, durations, scales=orbit.scales(), tolerance=1e-8, trials=9
    )
    assert few is None


def test_derivatives_that_are_kept_are_bounded(needs_compiler, monkeypatch):
    """A path of too many steps is refused; beyond that kinks are not looked at more closely."""
    model, orbit = orbit_of(monkeypatch, gap_oscillator, (-0.1, 0.5))
    path = path_of(model, orbit, 1e-5)
    count = len(path.sizes)
    monkeypatch.setattr(path_tangents, "_MOST_KEPT", 6 * (2 * count + 10))  # two by x, v, μ
    rough = passages_along(model, orbit, path, orbit.scales(), tolerances=[1e-9])
    assert rough.error > 1e-4
    monkeypatch.setattr(path_tangents, "_MOST_KEPT", count)
    with pytest.raises(NumericalError, match=f"takes {count} steps, too many"):
        passages_along(model, orbit, path, orbit.scales(), tolerances=[1e-9])
