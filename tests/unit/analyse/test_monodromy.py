"""Tangents along orbits against closed forms, plain integration and the laws they obey."""

import math
from dataclasses import replace

import numpy as np
import pytest
from cycle_examples import field, from_hopf, gap_oscillator, normal_form, sampled_orbit, van_der_pol
from scipy.integrate import solve_ivp
from solve_examples import build, symbols

from vehicledyn.analyse.periodic.branch import follow_cycles
from vehicledyn.analyse.periodic.collocation import Scales, condense
from vehicledyn.analyse.periodic.cycle_points import Limits
from vehicledyn.analyse.periodic.floquet import multipliers_of
from vehicledyn.analyse.periodic.monodromy import passages
from vehicledyn.analyse.periodic.multiple_shooting import SHIFTED, closed, direction_of
from vehicledyn.analyse.periodic.radau import NODES, ParameterPoint, radau_steps


@pytest.fixture(scope="module")
def touching():
    """A cycle between stiff stops, and the rates by hand."""
    model = field(gap_oscillator(), "mu")
    _, branch = from_hopf(model, -0.2, 0.4, amplitude=1e-2, points=40)
    orbit = next(p.orbit for p in branch.points if p.orbit.states[:, 0].max() > 1.2)
    mu = orbit.parameter

    def rates(_, y):
        beyond = max(y[0] - 1.0, 0.0) + min(y[0] + 1.0, 0.0)
        return np.array([y[1], -y[0] - 400.0 * beyond + mu * y[1] - 0.02 * y[1] ** 3])

    return model, orbit, rates


@pytest.mark.long
def test_monodromy_as_by_differences_of_simulations(touching):
    """Both columns of the tangent after a turn with four kinks, by central differences."""
    model, orbit, rates = touching
    exact = closed(model, orbit).passages
    start, size = exact.orbit.states[0], 1e-5
    ends = []
    for change in (size, -size):
        for k in (0, 1):
            y0 = start + change * np.eye(2)[k] * exact.scales
            ran = solve_ivp(
                rates, [0.0, exact.orbit.period], y0, "DOP853",
                rtol=1e-12, atol=1e-13, max_step=0.002,
            )  # fmt: skip
            ends.append(ran.y[:, -1] / exact.scales)
    ends = np.array(ends).reshape(2, 2, 2)
    wanted = ((ends[0] - ends[1]) / (2.0 * size)).T
    assert exact.monodromy == pytest.approx(wanted, rel=1e-4, abs=2e-4)


def test_product_of_multipliers_as_liouville_has_it(touching):
    """Π μ = exp ∫ tr A dt, with tr A = μ - 0.06 v²."""
    model, orbit, _ = touching
    found = closed(model, orbit)
    places = (np.arange(40000) + 0.5) / 40000
    speed = found.orbit.sample(places)[0][:, 1]
    period, mu = found.orbit.period, found.orbit.parameter
    growth = period * float((mu - 0.06 * speed**2).mean())
    product = np.prod(multipliers_of(found.passages).all).real
    assert math.log(product) == pytest.approx(growth, abs=2e-4)


def test_a_coarse_guess_is_closed(touching):
    """One percent off, eight intervals, no mesh point on a kink: shooting finds the same cycle."""
    model, orbit, _ = touching
    rough = orbit.moved(np.linspace(0.0, 1.0, 9))
    rough = replace(rough, states=1.01 * rough.states, period=1.003 * rough.period)
    found = closed(model, rough)
    assert np.abs(passages(model, rough).gaps).max() > 1e-3
    assert np.abs(found.passages.gaps).max() < 1e-5
    assert found.orbit.period == pytest.approx(closed(model, orbit).orbit.period, rel=1e-5)
    assert found.passages.trivial == pytest.approx(1.0, abs=SHIFTED)
    assert multipliers_of(found.passages).others == pytest.approx(
        multipliers_of(closed(model, orbit).passages).others, abs=1e-4
    )


def test_multipliers_of_collocation_on_a_smooth_cycle():
    """The condensed equations of collocation, a second formulation, have the same multipliers."""
    model = field(van_der_pol(), "mu")
    start = sampled_orbit(
        2.0 * math.pi, 0.1,
        lambda s: 2.0 * np.column_stack([np.cos(2 * np.pi * s), -np.sin(2 * np.pi * s)]),
    )  # fmt: skip
    branch = follow_cycles(model, start, None, Limits(0.05, 1.0, 0.4))
    point = branch.points[-1]
    scales = Scales(point.orbit.scales(), point.orbit.period, 1.0)
    product = np.eye(2)
    for solved in condense(model, point.orbit, point.orbit, scales).solved:
        product = -solved[-2:, :2] @ product  # the map from mesh point to mesh point
    wanted = np.sort(np.linalg.eigvals(product).real)
    assert np.sort(point.multipliers.all.real) == pytest.approx(wanted, abs=1e-6)


def test_the_branch_goes_on_through_its_fold_by_shooting_alone():
    """μ = r⁴ - r²: steps along the direction of the branch, tangent as collocation has it."""
    model = field(normal_form(1.0, -1.0), "mu")
    _, branch = from_hopf(model, -1.0, 1.0)
    base = next(p for p in branch.points if p.orbit.parameter < -0.2)
    found, along = closed(model, base.orbit, parameter_scale=0.4), base.tangent
    radii, senses = [], set()
    for _ in range(12):
        along, sense = direction_of(found, 0.4, along)
        senses.add(sense)
        orbit = found.orbit
        guess = replace(
            orbit,
            states=orbit.states + 0.05 * along.states,
            period=orbit.period + 0.05 * along.period,
            parameter=orbit.parameter + 0.05 * along.parameter,
        )
        found = closed(model, guess, parameter_scale=0.4, along=along)
        r = float(np.hypot(*found.passages.orbit.states[:, :2].T).mean())
        radii.append(r)
        assert found.orbit.parameter == pytest.approx(r**4 - r**2, abs=1e-7)
        assert found.passages.trivial == pytest.approx(1.0, abs=1e-6)
    assert radii == sorted(radii) and radii[0] < math.sqrt(0.5) < radii[-1]
    assert senses in ({1.0}, {-1.0})


def test_steps_have_their_order_and_damp_what_is_stiff():
    """x' = λ x: the error of one step falls with h⁸, and e^-∞ is zero for the method too."""
    t, x, rate = symbols("t", "x", "rate")
    equations = build(
        "decay", time=t, states=[(x, 1.0)], rates=[rate * x], parameters=[(rate, -1.0)],
        outputs=[("x", x)],
    )  # fmt: skip
    place = ParameterPoint(field(equations, "rate"), np.ones(1), -1.0)

    def step(size, value=-1.0):
        guess = np.ones((1, len(NODES), 1))
        own = ParameterPoint(place.field, place.scales, value)
        return radau_steps(own, np.ones((1, 1)), guess, np.zeros((1, 4, 0)), np.array([size]))

    errors = [abs(step(h).ends[0, 0] - math.exp(-h)) for h in (0.4, 0.2)]
    assert math.log2(errors[0] / errors[1]) == pytest.approx(8.0, abs=0.4)
    stiff = step(1.0, -1e7)
    assert abs(stiff.by_state[0, 0, 0]) < 1e-6
    assert step(0.4).by_parameter[0, 0] == pytest.approx(0.4 * math.exp(-0.4), rel=1e-7)
