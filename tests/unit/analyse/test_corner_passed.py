"""Branches of limit cycles go on behind corners, where contact begins."""

import math

import numpy as np
import pytest
from cycle_examples import (
    cornered_circles,
    field,
    from_hopf,
    grazing_oscillator,
    sampled_orbit,
)
from scipy.integrate import solve_ivp

from vehicledyn.analyse.periodic import autonomous
from vehicledyn.analyse.periodic.branch import follow_cycles
from vehicledyn.analyse.periodic.cycle_points import Limits

pytestmark = pytest.mark.long


def circles(back):
    model = field(cornered_circles(back, 0.1), "mu")
    start = sampled_orbit(
        math.pi, 0.8,
        lambda s: 0.8 * np.column_stack([np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)]),
        intervals=10,
    )  # fmt: skip
    return follow_cycles(model, start, None, Limits(0.7, 1.5, 0.05, points=60))


@pytest.mark.parametrize("is_compiled", [True, False])
@pytest.mark.parametrize("back", [0.1, 4.0])
def test_both_legs_of_a_corner_are_followed(needs_compiler, monkeypatch, back, is_compiled):
    """μ = r, then μ = 1 - back (r - 1): the way on turns by 120 and by 177 degrees."""
    monkeypatch.setattr(autonomous, "LEAST", 0 if is_compiled else 10**6)
    branch = circles(back)
    (fold,) = branch.special
    assert fold.kind == "fold"
    assert fold.orbit.parameter == pytest.approx(1.0, abs=1e-5)
    radii = np.array([np.hypot(*p.orbit.states.T).mean() for p in branch.points])
    values = np.array([p.orbit.parameter for p in branch.points])
    wanted = np.where(radii < 1.0, radii, 1.0 - back * (radii - 1.0))
    assert values == pytest.approx(wanted, abs=5e-5)
    assert (np.diff(radii) > -3e-5).all() and radii[-1] > 1.02
    assert branch.ending == "range"
    place = [p.kind for p in branch.points].index("fold")
    assert all(p.stable == (k < place) for k, p in enumerate(branch.points) if k != place)


def test_the_branch_of_a_grazing_oscillator(needs_compiler, monkeypatch):
    """It folds where cycles graze the stop; each cycle repeats in an integration of its own."""
    monkeypatch.setattr(autonomous, "LEAST", 0)
    model = field(grazing_oscillator(), "mu")
    _, branch = from_hopf(model, -0.1, 0.04, amplitude=1e-2, points=15)
    (fold,) = branch.special
    assert fold.kind == "fold"
    assert fold.orbit.parameter == pytest.approx(-0.075, rel=5e-3)
    assert fold.orbit.states[:, 0].max() == pytest.approx(1.0, abs=2e-3)
    place = [p.kind for p in branch.points].index("fold")
    assert branch.ending == "range" and len(branch.points) > place + 5
    assert all(p.stable == (k > place) for k, p in enumerate(branch.points) if k != place)
    for point in branch.points[place - 3 :: 4]:
        mu, states = point.orbit.parameter, point.orbit.states
        start = states[np.argmin(states[:, 0])]

        def rates(_, y, mu=mu):
            stop = 4000.0 * max(y[0] - 1.0, 0.0) * (1.0 + 4.0 * y[1])
            return [y[1], -y[0] - stop + (mu + 0.3 * y[0] ** 2) * y[1]]

        ran = solve_ivp(
            rates, [0.0, point.orbit.period], start, "DOP853",
            rtol=1e-10, atol=1e-12, max_step=0.005,
        )  # fmt: skip
        assert ran.y[:, -1] == pytest.approx(start, abs=2e-5)
