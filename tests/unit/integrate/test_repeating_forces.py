"""Forces that repeat in every step and half step, which act on both alike: the watch sees them."""

import numpy as np
import pytest
from solve_examples import build, symbols

from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.integrate.methods.newmark import Newmark
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.methods.symplectic_euler import SymplecticEuler
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel

STEP, PHASE = 1e-3, 0.3
METHODS = [RungeKutta4, SymplecticEuler, Newmark]
CASES = [
    pytest.param(times, method, marks=() if times in (4, 12) else pytest.mark.long)
    for times in (2, 4, 6, 8, 12, 20, 60, 64)
    for method in METHODS
]


def pushed(times):
    """A mass on a soft spring, pushed by so many periods of a force in a step of 1 ms."""
    import casadi as ca

    t, x, v, size = symbols("t", "x", "v", "size")
    force = size * ca.cos(2.0 * ca.pi * times / STEP * t + PHASE)
    return build(
        f"pushed_{str(times).replace('.', '_')}",
        time=t,
        states=[(x, 0.0), (v, 0.0)],
        rates=[v, force - 100.0 * x - 2.0 * v],
        parameters=[(size, 1e4)],
        outputs=[("x", x), ("v", v)],
    )


def run(times, solver, interval=10e-3):
    equations = pushed(times)
    found = []
    statistics = simulate(
        compile_kernel(equations, backend="compiled"),
        solver,
        start=0.0,
        stop=2.0,
        state=[0.0, 0.0],
        unknowns=[],
        interval=interval,
        sink=lambda t, x, z, y: found.append(y),
    )
    return statistics.accuracy, float(np.abs(np.concatenate(found)[:, 0]).max())


@pytest.mark.parametrize(("times", "method"), CASES)
def test_a_force_that_repeats_in_half_a_step_is_seen(times, method, needs_compiler):
    """Its mean is zero; to steps it is a constant that moves the mass by 165 m."""
    accuracy, largest = run(times, method(step=STEP))
    drift = 1e4 * np.sin(PHASE) / (2.0 * np.pi * times / STEP) / 10.0
    assert (largest > 10.0 * drift) == (accuracy.verdict == "inaccurate")
    if times != 2 or method is not RungeKutta4:  # whose half steps lie half a period apart
        assert accuracy.verdict == "inaccurate"


@pytest.mark.parametrize("times", [4, 12])
def test_the_step_to_take_does_not_repeat_it(times, needs_compiler):
    advised = run(times, RungeKutta4(step=STEP))[0].step
    accuracy, largest = run(times, RungeKutta4(step=advised))
    assert accuracy.verdict == "accurate"
    assert largest < 0.1


def test_a_force_that_steps_follow_raises_no_alarm(needs_compiler):
    accuracy, _ = run(0.02, RungeKutta4(step=STEP))
    assert accuracy.verdict == "accurate"
    assert accuracy.extra_steps < 200


@pytest.mark.parametrize("times", [4, 0.02])
def test_lanes_see_it_as_single_cases_do(times, needs_compiler):
    kernel = compile_kernel(pushed(times), backend="compiled")
    cases = Cases(np.linspace(1e3, 1e4, 6)[:, None], np.zeros((6, 2)), np.zeros((6, 0)))
    span = {"start": 0.0, "stop": 2.0, "interval": 10e-3, "channels": [0, 1]}
    ends = [
        run_batch(make_batch(kernel, lanes=n), RungeKutta4(step=STEP), cases, **span).ends
        for n in (1, 4)
    ]
    assert ends[0] == ends[1]
    verdict = "inaccurate" if times == 4 else "accurate"
    assert {end.accuracy.verdict for end in ends[0]} == {verdict}
