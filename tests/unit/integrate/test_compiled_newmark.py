"""The compiled loop over implicit steps does, statement by statement, what the other one does.

Both run on the functions of one compiled kernel; the interpreted loop has exact Jacobians, those of
the compiled one are differences, so each iteration leaves something else of what it may leave. Here
that is no part of the local error, but only what it may leave in any case.
"""

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from chain_examples import chain, damped_pendulum
from event_examples import Run, bouncing_ball, crossing_oscillator
from solve_examples import Samples, build, decay, slider_crank, starts, symbols

from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import find
from vehicledyn.integrate.newmark import family
from vehicledyn.integrate.newmark import weights as newmark_weights
from vehicledyn.integrate.newmark.constrained_steps import ConstrainedSteps
from vehicledyn.integrate.newmark.reduced_steps import ReducedForm
from vehicledyn.integrate.newmark.weights import Weights
from vehicledyn.integrate.simulate import make_task, simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

pytestmark = [pytest.mark.long, pytest.mark.usefixtures("needs_compiler")]
WEIGHTS = [
    replace(weights, share=0.0)
    for weights in (Weights.newmark(0.25, 0.5), Weights.hht(0.7), Weights.generalised_alpha(0.6))
]
COUNTS = ("samples", "steps", "evaluations", "newton_iterations", "smallest_step", "largest_step")


@pytest.fixture(scope="module")
def kernel():
    return compile_kernel(slider_crank(), backend="compiled")


@pytest.fixture
def interpreted(monkeypatch):
    """Return what calls a function with the loop over steps interpreted."""

    def call(function):
        with monkeypatch.context() as patch:
            patch.setattr(family, "_compiled_steps", lambda *_: None)
            return function()

    return call


def run(kernel, weights, *, tolerance=None, interval=0.1, stop=3.0):
    samples = Samples()
    state, unknowns = starts(kernel.equations)
    span = {"start": 0.0, "stop": stop, "interval": interval}
    task = make_task(kernel, state=state, unknowns=unknowns, sink=samples, **span)
    return samples, family.run_newmark(task, "", weights, 0.05, tolerance=tolerance)


def assert_same(one, other, precision=1e-12):
    for name in ("times", "states", "unknowns", "outputs"):
        assert getattr(one[0], name) == pytest.approx(getattr(other[0], name), abs=precision), name
    for name in COUNTS:
        assert getattr(one[1], name) == pytest.approx(getattr(other[1], name), rel=1e-12), name


@pytest.mark.parametrize("tolerance", [None, 1e-6])
@pytest.mark.parametrize("weights", WEIGHTS)
def test_loops_with_constraints(kernel, interpreted, weights, tolerance):
    ways = [call(lambda: run(kernel, weights, tolerance=tolerance)) for call in (now, interpreted)]
    assert_same(*ways)
    assert ways[0][1].newton_iterations > ways[0][1].steps


def now(function):
    return function()


def test_first_order_states(interpreted):
    kernel = compile_kernel(decay(3.0), backend="compiled")
    for tolerance in (None, 1e-5):
        assert_same(
            *(
                call(lambda: run(kernel, WEIGHTS[2], tolerance=tolerance))  # noqa: B023
                for call in (now, interpreted)
            )
        )


def turning_around(n=7):
    """States that turn each other around, so fast that factors need pivots off the diagonal."""
    names = [f"x{k}" for k in range(n)]
    x = symbols(*names)
    some = 200.0 * np.random.default_rng(5).normal(size=(n, n))
    rates = ca.DM(some - some.T) @ ca.sin(ca.vertcat(*x))
    return build(
        "around", time=symbols("t")[0], states=[(item, 0.1 * k) for k, item in enumerate(x)],
        rates=ca.vertsplit(rates), parameters=[], outputs=[("first", x[0])],
    )  # fmt: skip


def test_factors_with_pivots(interpreted):
    kernel = compile_kernel(turning_around(), backend="compiled")
    ways = [call(lambda: run(kernel, WEIGHTS[2], stop=0.5)) for call in (now, interpreted)]
    assert_same(*ways)


def test_smooth_steps_take_two_evaluations_from_good_guesses(kernel, monkeypatch):
    """Of many states the error left by Newton's method may be a part of the step's own."""
    monkeypatch.setattr(newmark_weights, "FEW_STATES", 0)
    state, unknowns = starts(kernel.equations)
    given = {"state": state, "unknowns": unknowns, "sink": Samples(), "interval": 0.1}
    span, took = {"start": 0.0, "stop": 1.0}, []
    for step in (1e-2, 1e-3):
        solver = find("solver", "generalised_alpha")(step=step)
        took.append(simulate(kernel, solver, watched=False, **given, **span))
    assert took[0].evaluations < 2.5 * took[0].steps
    assert took[1].newton_iterations < 1.6 * took[1].evaluations


def test_python_is_asked_for_derivatives_where_differences_are_no_numbers(interpreted, monkeypatch):
    """Just beside the first place the rate has no real value; its derivative there has one."""
    t, x, v = symbols("t", "x", "v")
    rates, more = [v, 1e-3 * ca.log(1.0 + 1e-8 - x) - x], {"positions": (0,), "velocities": (1,)}
    equations = build(
        "edge", time=t, states=[(x, 1.0), (v, -1.0)], rates=rates, parameters=[],
        outputs=[("x", x)], **more,
    )  # fmt: skip
    kernel, called = compile_kernel(equations, backend="compiled"), []
    exact = ReducedForm.jacobian
    monkeypatch.setattr(
        ReducedForm, "jacobian", lambda form, at: called.append(at.time) or exact(form, at)
    )
    one = run(kernel, WEIGHTS[2], stop=0.5)
    assert set(called) == {0.0}
    assert_same(one, interpreted(lambda: run(kernel, WEIGHTS[2], stop=0.5)))


def test_chunks_and_little_room_change_nothing(kernel, monkeypatch):
    whole = run(kernel, WEIGHTS[2], tolerance=1e-6)
    monkeypatch.setattr(family, "_FIRST_CHUNK", 3)
    monkeypatch.setattr(family, "_GROWTH", 1)
    monkeypatch.setattr("vehicledyn.integrate.task._MOST_NUMBERS", 1)
    parts = run(kernel, WEIGHTS[2], tolerance=1e-6)
    assert np.array_equal(whole[0].states, parts[0].states)
    assert len(parts[0].times) == 31


@pytest.fixture(scope="module")
def held():
    """A four-bar with constraints, and a pendulum with a state of first order and without any."""
    return [compile_kernel(derive(s), backend="compiled") for s in (chain(1), damped_pendulum())]


def moving(equations):
    """Its start, the uprights of a four-bar turning alike and its coupler not at all."""
    state, unknowns = starts(equations)
    for k, variable in enumerate(equations.states):
        if variable.name.endswith(".angle_rate"):
            state[k] = -2.0 if variable.name.startswith("coupler") else 2.0
    return state, unknowns


@pytest.mark.parametrize("tolerance", [None, 1e-6])
@pytest.mark.parametrize("constraints", ["index3", "stabilised_index2"])
@pytest.mark.parametrize("weights", WEIGHTS[::2])
def test_multipliers(held, interpreted, weights, constraints, tolerance):
    """Residuals are rounded otherwise: Newton's method may stop one iteration earlier or later.

    Steps that follow a tolerance are as long as rounded errors ask for, which is seen ten times.
    """
    close = 1e-12 if tolerance is None else 1e-11
    for kernel in held:

        def go(kernel=kernel):
            samples = Samples()
            state, unknowns = moving(kernel.equations)
            span = {"start": 0.0, "stop": 0.5, "interval": 0.1}
            task = make_task(kernel, state=state, unknowns=unknowns, sink=samples, **span)
            settings = {"constraints": constraints, "tolerance": tolerance}
            return samples, family.run_newmark(task, "", weights, 0.02, **settings)

        one, other = go(), interpreted(go)
        assert one[0].states == pytest.approx(other[0].states, rel=close, abs=close)
        assert np.ptp(one[0].states[:, 0]) > 0.1
        for name in ("samples", "steps", "smallest_step", "largest_step"):
            assert getattr(one[1], name) == pytest.approx(getattr(other[1], name), rel=close), name
        assert one[1].evaluations == pytest.approx(other[1].evaluations, abs=one[1].steps)


def test_python_is_called_for_few_jacobians_of_steps_with_multipliers(held, monkeypatch):
    called = []
    kind = ConstrainedSteps
    partials = kind.factors_for
    monkeypatch.setattr(kind, "factors_for", lambda *a, **k: called.append(1) or partials(*a, **k))
    samples, (state, unknowns) = Samples(), moving(held[0].equations)
    solver = find("solver", "generalised_alpha")(step=1e-3, constraints="index3")
    span = {"start": 0.0, "stop": 1.0, "interval": 0.5, "watched": False}
    took = simulate(held[0], solver, state=state, unknowns=unknowns, sink=samples, **span)
    assert took.steps == 1000
    assert 0 < len(called) < 100


@pytest.mark.parametrize("tolerance", [None, 1e-7])
def test_events(interpreted, tolerance):
    kernel = compile_kernel(bouncing_ball(), backend="compiled")

    def go():
        settings = {"step": 0.05, "tolerance": tolerance}
        return Run(kernel, "generalised_alpha", stop=3.0, interval=0.05, **settings).go()

    one, other = go(), interpreted(go)
    assert one.times == pytest.approx(other.times, abs=1e-12)
    assert one.samples.states == pytest.approx(other.samples.states, abs=1e-11)
    assert (one.statistics.steps, one.statistics.events) == (other.statistics.steps, 6)


def test_a_terminal_event_ends_the_run_with_its_sample(interpreted):
    kernel = compile_kernel(crossing_oscillator("falling", terminal=True), backend="compiled")

    def go():
        return Run(kernel, "newmark", stop=2.0, interval=0.1, step=0.05).go()

    one, other = go(), interpreted(go)
    assert one.statistics.ended_by == other.statistics.ended_by != ""
    assert one.samples.times == pytest.approx(other.samples.times, abs=1e-12)
    assert one.statistics.steps == other.statistics.steps


def ending():
    """A motion whose rate has no real value beyond t = 0.5 s."""
    t, x, v = symbols("t", "x", "v")
    more = {"positions": (0,), "velocities": (1,)}
    return build(
        "ends", time=t, states=[(x, 1.0), (v, 0.0)], rates=[v, ca.sqrt(0.5 - t) - x],
        parameters=[], outputs=[("x", x)], **more,
    )  # fmt: skip


@pytest.mark.parametrize("tolerance", [None, 1e-6])
def test_a_step_that_cannot_be_taken_ends_with_the_same_words(interpreted, tolerance):
    kernel = compile_kernel(ending(), backend="compiled")
    found = []

    def go():
        samples = Samples()
        solver = find("solver", "newmark")(step=0.1, tolerance=tolerance)
        times = {"start": 0.0, "stop": 1.0, "interval": 0.1}
        with pytest.raises(NumericalError) as caught:
            simulate(kernel, solver, state=[1.0, 0.0], unknowns=[], sink=samples, **times)
        found.append((str(caught.value), len(samples.times)))

    go()
    interpreted(go)
    assert found[0] == found[1]
    assert "Newton's method does not converge" in found[0][0]
    assert found[0][1] == 6


def test_order_two_over_many_steps(kernel):
    """Ten thousands of steps in one call, and the slope of their error."""
    ends = []
    for parts in (1, 2, 16):
        samples = Samples()
        state, unknowns = starts(kernel.equations)
        solver = find("solver", "generalised_alpha")(step=2e-3 / parts)
        span = {"start": 0.0, "stop": 2.0, "interval": 1.0}
        simulate(kernel, solver, state=state, unknowns=unknowns, sink=samples, **span)
        ends.append(samples.states[-1])
    coarse, fine = (np.linalg.norm(end - ends[-1]) for end in ends[:2])
    bias = math.log2((1 - 1 / 256) / (1 - 4 / 256))
    assert math.log2(coarse / fine) - bias == pytest.approx(2.0, abs=0.05)


def test_undamped_newmark_keeps_the_energy_of_stiff_four_bars_over_100_000_steps():
    """All uprights turn as one, so the energy is that of a pendulum on a spring."""
    kernel = compile_kernel(
        derive(chain(2, method="partitioning", stiffness=1e4)), backend="compiled"
    )
    samples, (state, unknowns) = Samples(), starts(kernel.equations)
    solver = find("solver", "newmark")(step=1e-3)
    span = {"start": 0.0, "stop": 100.0, "interval": 0.01}
    simulate(
        kernel, solver, state=state, unknowns=unknowns, sink=samples, watched=False, **span
    )  # fmt: skip
    places = [variable.name for variable in kernel.equations.states]
    lean = samples.states[:, places.index("upright_0.angle")] + 0.5 * np.pi
    speed = samples.states[:, places.index("upright_0.angle_rate")]
    inertia, weight, spring = 3.0, 9.81 * 3.5, 5e4
    energy = 0.5 * inertia * speed**2 + 0.5 * spring * lean**2 + weight * (np.cos(lean) - 1.0)
    assert len(energy) == 10_001
    assert energy == pytest.approx(energy[0], rel=1e-9)


@pytest.mark.parametrize("count", [1, 3])
def test_the_energy_of_unlike_four_bars_does_not_drift_over_100_000_steps(count):
    """They swing by 0.57 rad about their lowest place; its mean moves by less than 1 % of its band.

    The part of the local error that Newton's method may leave elsewhere adds up to a twentieth.
    """
    kernel = compile_kernel(
        derive(chain(count, method="partitioning", last=0.8)), backend="compiled"
    )
    samples, (state, unknowns), e = Samples(), starts(kernel.equations), kernel.equations
    for numbers, variables in ((state, e.states), (unknowns, e.unknowns)):
        for k, variable in enumerate(variables):
            if variable.name.endswith(".angle"):
                numbers[k] = 0.5 * np.pi * (1.0 if variable.name.startswith("upright") else -1.0)
    span = {"start": 0.0, "stop": 1000.0, "interval": 0.1, "sink": samples, "watched": False}
    solver = find("solver", "newmark")(step=0.01)
    simulate(kernel, solver, state=state, unknowns=unknowns, **span)
    columns = [k for k, c in enumerate(e.channels) if c.name.startswith("energy.")]
    energy = samples.outputs[:, columns].sum(axis=1)
    means = energy[1:].reshape(10, -1).mean(axis=1)
    assert np.ptp(energy) < 5e-5
    assert abs(np.polyfit(np.arange(10.0), means, 1)[0] * 9.0) < 0.01 * np.ptp(energy)


def test_a_jacobian_that_costs_more_than_a_new_one_is_found_anew(interpreted, monkeypatch):
    """A spring slowly gets stiffer, so that iterations converge ever slower, but fast enough.

    With the Jacobian of the start a step takes three evaluations.
    """
    t, x, v = symbols("t", "x", "v")
    stiffness = 1e6 * (1.0 + 0.02 * t)
    equations = build(
        "stiffer", time=t, states=[(x, 0.0), (v, 1.0)], outputs=[("x", x)],
        rates=[v, -stiffness * (x - ca.sin(t)) - 2e3 * (v - ca.cos(t))],
        parameters=[], positions=(0,), velocities=(1,),
    )  # fmt: skip
    kernel = compile_kernel(equations, backend="compiled")
    monkeypatch.setattr(newmark_weights, "FEW_STATES", 0)
    for call in (now, interpreted):
        took = call(lambda: run(kernel, Weights.generalised_alpha(0.8), interval=0.05, stop=10.0))
        assert took[1].evaluations < 2.2 * took[1].steps
