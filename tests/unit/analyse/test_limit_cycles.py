"""Limit cycles by collocation against closed forms and published periods."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from cycle_examples import (
    circle_beside,
    duffing,
    field,
    from_hopf,
    gap_oscillator,
    looped_normal_form,
    normal_form,
    rossler,
    sampled_orbit,
    van_der_pol,
)
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from solve_examples import build, forced, oscillator, symbols

from vehicledyn.analyse.periodic.branch import follow_cycles
from vehicledyn.analyse.periodic.collocation import Scales, condense
from vehicledyn.analyse.periodic.critical import find_balance, find_hopf, follow_balance
from vehicledyn.analyse.periodic.cycle_points import Branch, Limits
from vehicledyn.analyse.periodic.cycles_at import cycle_beside, points_beside
from vehicledyn.analyse.periodic.orbit_steps import BranchSteps
from vehicledyn.analyses.hunting.critical_values import lowest_stable
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.symbolic.equations import Event

pytestmark = pytest.mark.long


def radius(point):
    return float(np.hypot(*point.orbit.states[:, :2].T).mean())


def test_circles_with_fold_as_in_closed_form():
    """μ = r⁴ - r² from a subcritical Hopf bifurcation, folded at μ = -1/4, r = 1/√2."""
    model = field(normal_form(1.0, -1.0), "mu")
    hopf, branch = from_hopf(model, -1.0, 1.0)
    assert hopf.balance.value == pytest.approx(0.0, abs=1e-12)
    assert hopf.frequency == pytest.approx(2.0, rel=1e-12)
    assert hopf.begins and branch.ending == "range"
    assert branch.points[-1].orbit.parameter == 1.0
    for point in branch.points:
        r, orbit = radius(point), point.orbit
        assert orbit.parameter == pytest.approx(r**4 - r**2, abs=1e-7)
        assert orbit.period == pytest.approx(2.0 * math.pi / (2.0 + 0.3 * r * r), rel=1e-8)
        assert np.abs(orbit.states[:, :2]).max() == pytest.approx(r, rel=1e-2)
        growth = math.exp(orbit.period * (2.0 * r * r - 4.0 * r**4))
        expected = sorted([growth, math.exp(-0.7 * orbit.period)], reverse=True)
        assert point.multipliers.others.real == pytest.approx(expected, rel=1e-5, abs=1e-6)
        assert point.multipliers.trivial == pytest.approx(1.0, abs=1e-8)
        if not point.kind and r > 1e-2:
            assert point.stable == (r * r > 0.5)
    (fold,) = branch.special
    assert fold.kind == "fold"
    assert fold.orbit.parameter == pytest.approx(-0.25, abs=1e-9)
    assert radius(fold) == pytest.approx(math.sqrt(0.5), abs=1e-4)


def test_cycles_of_a_linear_motion_are_no_limit_cycles():
    """Without the cubic and quintic terms circles of every radius stand at mu = 0."""
    _, branch = from_hopf(field(normal_form(0.0, 0.0), "mu"), -1.0, 1.0)
    assert branch.ending == "linear"
    assert "none of them is a limit cycle" in branch.remarks[-1]
    assert radius(branch.points[-1]) < 1e6
    assert lowest_stable([branch], (-1.0, 1.0)) is None


def test_amplitude_grows_as_the_root_and_unknowns_of_blocks_follow():
    """Supercritical: r = √μ, with r² found in a block, and a state that only travels set apart."""
    model = field(looped_normal_form(), "mu")
    assert model.names == ["x", "y"]
    _, branch = from_hopf(model, -0.5, 1.0)
    assert not branch.special
    for point in branch.points[5:]:
        assert point.stable
        assert radius(point) == pytest.approx(math.sqrt(point.orbit.parameter), rel=1e-6)
        assert point.orbit.unknowns == pytest.approx(point.orbit.parameter, rel=1e-5)
        expected = math.exp(-2.0 * point.orbit.parameter * math.pi)
        assert point.multipliers.others[0].real == pytest.approx(expected, rel=1e-6)


@pytest.fixture(scope="module")
def van_der_pol_branch():
    model = field(van_der_pol(), "mu")
    start = sampled_orbit(
        2.0 * math.pi, 0.1,
        lambda s: 2.0 * np.column_stack([np.cos(2 * np.pi * s), -np.sin(2 * np.pi * s)]),
    )  # fmt: skip
    return model, follow_cycles(model, start, None, Limits(0.05, 10.0, 0.4))


def cycles_at(model, branch, value):
    return [cycle_beside(model, near, value) for near in points_beside(branch, value)]


@pytest.mark.parametrize("mu", [1.0, 5.0, 10.0])
def test_van_der_pol_as_by_integration(van_der_pol_branch, mu):
    """Period and amplitude for μ = 1, 5, 10 as an integration to 1e-12 has them."""
    model, branch = van_der_pol_branch
    (cycle,) = cycles_at(model, branch, mu)

    def rates(_, y):
        return [y[1], mu * (1.0 - y[0] ** 2) * y[1] - y[0]]

    def top(_, y):
        return y[1]

    top.direction = -1.0
    ran = solve_ivp(rates, [0.0, 80.0], [2.0, 0.0], "DOP853", events=top, rtol=1e-12, atol=1e-13)
    times = ran.t_events[0]
    assert cycle.orbit.period == pytest.approx(times[-1] - times[-2], rel=1e-6)
    assert cycle.orbit.sample(np.linspace(0, 1, 20001)[:-1])[0][:, 0].max() == pytest.approx(
        ran.y_events[0][-1][0], rel=1e-6
    )
    assert cycle.multipliers.trivial == pytest.approx(1.0, abs=1e-4)
    assert cycle.stable


def test_van_der_pol_period_as_published(van_der_pol_branch):
    """T = 6.66328686 for μ = 1 (perturbation series of Andersen and Geer, 1982)."""
    model, branch = van_der_pol_branch
    (cycle,) = cycles_at(model, branch, 1.0)
    assert cycle.orbit.period == pytest.approx(6.66328686, abs=2e-8)


def test_backbone_of_a_hard_spring():
    """x'' + x + x³: T = 4 K(m)/√(1 + A²), m = A²/(2 + 2 A²), on a branch that stays at d = 0."""
    model = field(duffing(), "d")
    _, branch = from_hopf(model, -0.5, 0.5, amplitude=1e-3)
    points = [p for p in branch.points if 0.1 < np.abs(p.orbit.states[:, 0]).max() < 30.0]
    assert len(points) > 10
    for point in points:
        a2 = point.orbit.sample(np.linspace(0, 1, 4001)[:-1])[0][:, 0].max() ** 2
        exact = 4.0 * ellipk(a2 / (2.0 + 2.0 * a2)) / math.sqrt(1.0 + a2)
        assert point.orbit.parameter == pytest.approx(0.0, abs=1e-8)
        assert point.orbit.period == pytest.approx(exact, rel=1e-5)
    assert not [p for p in points if p.kind]


def run_off_by(rates, middle, orbit, size):
    """How much of a small change of speed at x = 0 is left after one turn."""
    left = []
    start = orbit.sample(np.linspace(0, 1, 40001)[:-1])[0]
    rising = np.flatnonzero((start[:-1, 0] < 0.0) & (start[1:, 0] >= 0.0))[0]
    part = -start[rising, 0] / (start[rising + 1, 0] - start[rising, 0])
    speed = start[rising, 1] + part * (start[rising + 1, 1] - start[rising, 1])
    for change in (size, -size):
        ran = solve_ivp(
            rates, [0.0, 1.5 * orbit.period], [1e-12, speed + change], "DOP853",
            events=middle, rtol=1e-11, atol=1e-12, max_step=0.005,
        )  # fmt: skip
        left.append(next(y[1] for t, y in zip(ran.t_events[0], ran.y_events[0], strict=True)
                         if t > 0.5 * orbit.period))  # fmt: skip
    return (left[0] - left[1]) / (2.0 * size)


def test_stops_that_touch_keep_the_trivial_multiplier():
    """Mesh points lie on the kinks; multipliers and period as a finely stepped simulation."""
    model = field(gap_oscillator(), "mu")
    _, branch = from_hopf(model, -0.2, 0.4, amplitude=1e-2, points=40)
    touching = [p for p in branch.points if np.abs(p.orbit.states[:, 0]).max() > 1.001]
    assert len(touching) > 10
    for point in touching:
        assert point.multipliers.trivial == pytest.approx(1.0, abs=1e-4)
        assert point.orbit.intervals < 120
    last = branch.points[-1].orbit
    mu = last.parameter

    def rates(_, y):
        beyond = max(y[0] - 1.0, 0.0) + min(y[0] + 1.0, 0.0)
        return [y[1], -y[0] - 400.0 * beyond + mu * y[1] - 0.02 * y[1] ** 3]

    def middle(_, y):
        return y[0]

    middle.direction = 1.0
    ran = solve_ivp(
        rates, [0.0, 100.0], [0.5, 1.0], "DOP853",
        events=middle, rtol=1e-11, atol=1e-12, max_step=0.01,
    )  # fmt: skip
    period = np.diff(ran.t_events[0])[-1]
    assert last.period == pytest.approx(period, rel=1e-7)
    near = run_off_by(rates, middle, last, 1e-4)
    decay = branch.points[-1].multipliers.others[0].real
    assert near == pytest.approx(decay, rel=1e-3)


@pytest.mark.parametrize("kind", ["torus", "branch_point"])
def test_what_grows_beside_a_circle(kind):
    """Its multipliers are exp(2π (μ ± 0.3 i)) or exp(2π μ): the circle loses stability at 0."""
    model = field(circle_beside(kind), "mu")
    start = sampled_orbit(
        6.0, -0.5,
        lambda s: np.column_stack(
            [np.cos(2 * np.pi * s), np.sin(2 * np.pi * s), np.zeros((len(s), 2))]
        ),
        intervals=20,
    )  # fmt: skip
    branch = follow_cycles(model, start, None, Limits(-0.6, 0.5, 0.1))
    (found,) = branch.special
    assert found.kind == kind
    assert found.orbit.parameter == pytest.approx(0.0, abs=2e-4)
    turn = 0.3j if kind == "torus" else 0.0
    for point in branch.points:
        expected = np.exp(2.0 * np.pi * (point.orbit.parameter + turn))
        assert np.abs(point.multipliers.others - expected).min() < 1e-6 * (1.0 + abs(expected))
        if not point.kind:
            assert point.stable == (point.orbit.parameter < 0.0)


def test_period_doubling_of_rossler():
    """a = b = 0.2: the first doubling at c = 2.832 (Strogatz 1994 has one between 2.5 and 3.5)."""
    equations = rossler(2.0)
    model = field(equations, "c")

    def rates(_, y):
        return [-y[1] - y[2], y[0] + 0.2 * y[1], 0.2 + y[2] * (y[0] - 2.0)]

    ran = solve_ivp(rates, [0.0, 300.0], [-2.0, 0.0, 0.1], rtol=1e-10, atol=1e-10)
    y0 = ran.y[:, -1]

    def again(_, y):
        return y[1] - y0[1]

    again.direction = float(np.sign(rates(0.0, y0)[1]))
    once = solve_ivp(
        rates, [0.0, 20.0], y0, events=again, dense_output=True, rtol=1e-10, atol=1e-10
    )
    period = next(t for t in once.t_events[0] if t > 1.0)
    start = sampled_orbit(period, 2.0, lambda s: once.sol(s * period).T)
    branch = follow_cycles(model, start, None, Limits(1.5, 4.0, 0.1))
    doubling = next(p for p in branch.special if p.kind == "period_doubling")
    assert min(abs(doubling.multipliers.others + 1.0)) < 1e-4
    before, after = (
        next(p for p in branch.points if not p.kind and abs(p.orbit.parameter - c) < 0.2)
        for c in (2.5, 3.2)
    )
    assert before.stable and not after.stable
    assert 2.5 < doubling.orbit.parameter < 3.5


def test_time_that_makes_no_difference_is_taken_out():
    """Van der Pol seen from two frames that run ahead of each other, against none."""
    t, x, v, m = symbols("t", "x", "v", "mu")
    apart = (3.0 + 30.0 * t + x) - (30.0 * t - 1.0) - 4.0

    def seen(far):
        return build(
            "moving", time=t, states=[(x, 2.0), (v, 0.0)],
            rates=[v, m * (1 - far**2) * v - far], parameters=[(m, 0.5)], outputs=[("x", x)],
        )  # fmt: skip

    state = np.array([[0.7, -1.2]])
    moving, still = field(seen(apart), "mu"), field(seen(x), "mu")
    assert still.evaluate(state, np.zeros((1, 0)), 0.5).rates == pytest.approx(
        moving.evaluate(state, np.zeros((1, 0)), 0.5).rates, abs=1e-13
    )
    with pytest.raises(InputError, match="depends on time"):
        field(seen(apart + 1e-4 * t), "mu")


def test_what_has_no_cycles_is_told():
    with pytest.raises(InputError, match="depends on time"):
        field(forced(), "x")
    with pytest.raises(InputError, match="no parameter named 'sped'"):
        field(van_der_pol(), "sped")
    leap = Event("leap", 0, guesses=((0, 0),))
    with pytest.raises(InputError, match="contact may jump at the event 'leap'"):
        field(replace(van_der_pol(), events=(leap,)), "damping")
    model = field(oscillator(damping=0.3), "stiffness")
    balances = follow_balance(model, [1.0, 2.0, 3.0], np.zeros(2), np.zeros(0))
    assert find_hopf(model, balances) == []
    start = sampled_orbit(
        1.0, 4.0, lambda s: np.column_stack([np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)])
    )
    with pytest.raises(NumericalError):
        follow_cycles(model, start, None, Limits(1.0, 5.0, 0.1))


def test_equilibrium_is_found_again_and_an_interrupt_keeps_the_branch():
    model = field(normal_form(1.0, -1.0), "mu")
    assert find_balance(model, 0.3, np.full(3, 0.05), np.zeros(0)).state == pytest.approx(
        np.zeros(3), abs=1e-12
    )
    kept = Branch()

    def stop(point):
        if len(kept.points) == 5:
            raise KeyboardInterrupt

    balances = follow_balance(model, [-0.5, 0.5], np.zeros(3), np.zeros(0))
    (hopf,) = find_hopf(model, balances)
    first = hopf.orbit(1e-3, 0, intervals=15, degree=4)
    with pytest.raises(KeyboardInterrupt):
        follow_cycles(
            model, first, hopf.growing(first), Limits(-1.0, 1.0, 0.1), branch=kept, report=stop
        )
    assert len(kept.points) == 5


def test_a_fold_that_is_not_located_is_told_with_the_cycles_beside_it(monkeypatch):
    """Where points on a step are not found, the nearest one is told, and that it is."""

    def lost(*_):
        raise NumericalError("not found")

    monkeypatch.setattr(BranchSteps, "between", lost)
    _, branch = from_hopf(field(normal_form(1.0, -1.0), "mu"), -1.0, 1.0)
    (fold,), (remark,) = branch.special, branch.remarks
    assert fold.orbit.parameter == pytest.approx(-0.25, abs=1e-2)
    ends = [float(text) for text in re.findall(r"-0\.2\d+", remark)]
    assert remark.startswith("fold not located: it lies on the branch between the cycles at mu = ")
    assert len(ends) == 2 and fold.orbit.parameter in [pytest.approx(e, abs=1e-7) for e in ends]


def test_factors_of_an_orbit_grow_with_its_intervals_alone():
    """Four times the intervals, four times the entries: full rows do not fill the factors."""
    model = field(rossler(), "c")
    entries = []
    for intervals in (40, 160):
        orbit = sampled_orbit(
            5.8, 3.0,
            lambda s: np.column_stack([np.cos(6.28 * s), np.sin(6.28 * s), 1 + s * (1 - s)]),
            intervals=intervals,
        )  # fmt: skip
        system = condense(model, orbit, orbit, Scales(np.ones(3), 1.0, 1.0))
        row = np.ones((intervals, orbit.basis.degree + 1, 3))
        factors = system.factorised((row, 0.3, 1.0))
        entries.append(factors.factors.L.nnz + factors.factors.U.nnz)
    assert entries[1] < 4.5 * entries[0]
