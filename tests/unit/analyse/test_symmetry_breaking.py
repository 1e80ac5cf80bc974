"""Cycles that branch off where others lose their mirror symmetry."""

import math

import numpy as np
import pytest
from cycle_examples import field, sampled_orbit
from solve_examples import build, symbols

from vehicledyn.analyse.periodic import autonomous
from vehicledyn.analyse.periodic.branch import follow_cycles
from vehicledyn.analyse.periodic.cycle_points import Limits
from vehicledyn.analyse.periodic.symmetry_breaking import OwnImages, leading_off


def leaning(growth, is_alike=True):
    """The circle r = 1 in 2π; beside it u = x + w, w' = w (growth(μ) - w²), and z = 1.

    In the mirror -x, -y, -u, z; cycles with w = ±√growth, each the image of the other, branch off
    where the growth begins. Without ``is_alike`` w stands alone, and keeps its sign in the mirror.
    """
    t, x, y, u, z, m = symbols("t", "x", "y", "u", "z", "mu")
    r2, w = x * x + y * y, u - x if is_alike else u
    turn = x * (1 - r2) - y
    beside = (turn if is_alike else 0.0) + w * (growth(m) - w * w)
    return build(
        "leaning", time=t, states=[(x, 1.0), (y, 0.0), (u, 1.0), (z, 1.0)],
        rates=[turn, y * (1 - r2) + x, beside, 1.0 - z**3 + 0.1 * w * x],
        parameters=[(m, -0.5)], outputs=[("x", x)],
    )  # fmt: skip


@pytest.fixture(params=["compiled", "interpreted"])
def either(request, monkeypatch):
    """Orbits are closed by simple shooting, or by collocation."""
    if request.param == "compiled":
        request.getfixturevalue("needs_compiler")
        monkeypatch.setattr(autonomous, "LEAST", 0)


def symmetric_branch(equations, low, high, step, beside=1.0):
    def circle(s):
        x, y = np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)
        return np.column_stack([x, y, beside * x, np.ones_like(x)])

    model = field(equations, "mu")
    start = sampled_orbit(2.0 * math.pi, low, circle, intervals=12)
    limits = Limits(low, high, step)
    return model, limits, follow_cycles(model, start, None, limits)


def lean(orbit):
    """w along an orbit, which is constant on the exact one."""
    return orbit.states[:, 2] - orbit.states[:, 0]


@pytest.mark.usefixtures("either")
def test_a_branch_leads_off_as_the_square_root():
    """w = √(2 μ) with the multiplier exp(-2π 2 w²)."""
    model, limits, branch = symmetric_branch(leaning(lambda m: 2.0 * m), -0.2, 0.3, 0.1)
    (point,) = branch.special
    way = leading_off(model, point, (limits.low, limits.high))
    assert np.ptp(lean(way.start(0.03))) == pytest.approx(0.0, abs=1e-5)
    found = follow_cycles(model, way.start(0.03), way.along, limits)
    values = np.array([p.orbit.parameter for p in found.points])
    assert found.ending == "range" and len(values) > 5
    assert (np.diff(values) > 0.0).all() and 0.0 < values[0] < 2e-3
    sign = np.sign(lean(found.points[0].orbit).mean())
    images = OwnImages(way)
    for point in found.points:
        w = math.sqrt(2.0 * point.orbit.parameter)
        assert lean(point.orbit) == pytest.approx(sign * w, abs=2e-4)
        assert point.stable
        nearest = np.abs(point.multipliers.others - math.exp(-4.0 * math.pi * w * w)).min()
        assert nearest < 2e-3
        missed = images.distances(point.orbit) * way.orbit.scales()
        assert np.abs(missed[:, 2]).max() == pytest.approx(2.0 * w, abs=5e-4)


@pytest.mark.usefixtures("either")
def test_it_is_told_where_the_branch_comes_back():
    """w² = μ (1 - μ): from 0 to 1, and beyond with the other sign."""
    model, limits, branch = symmetric_branch(leaning(lambda m: m * (1.0 - m)), -0.3, 1.3, 0.15)
    points = branch.special
    assert [p.orbit.parameter for p in points] == pytest.approx([0.0, 1.0], abs=1e-4)
    way = leading_off(model, points[0], (limits.low, limits.high))
    images, met = OwnImages(way), []

    class MetError(Exception):
        pass

    def told(point):
        met.append(point)
        if images.are_met(met):
            raise MetError

    with pytest.raises(MetError):
        follow_cycles(model, way.start(0.03), way.along, limits, report=told)
    value, period, reach = images.place(met)
    assert value == pytest.approx(1.0, abs=0.03) and abs(value - 1.0) < reach < 0.2
    assert period == pytest.approx(2.0 * math.pi, rel=1e-4)
    assert len({np.sign(lean(p.orbit).mean()) for p in met[:-1]}) == 1


def test_a_branch_point_that_keeps_the_mirror_has_no_such_way():
    equations = leaning(lambda m: m, is_alike=False)
    model, limits, branch = symmetric_branch(equations, -0.2, 0.2, 0.1, beside=0.0)
    (point,) = branch.special
    assert leading_off(model, point, (limits.low, limits.high)) is None
