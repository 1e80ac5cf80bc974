"""Forces that come and go within a step, which steps pass without seeing them, raise an alarm."""

import numpy as np
import pytest
from event_examples import with_events
from solve_examples import build, symbols

from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.methods.newmark import Newmark
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.methods.symplectic_euler import SymplecticEuler
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel

PUSHES = {
    "time": (0.0, 0.1234, 0.1264),
    "place": (1.0, 0.1002, 0.1012),
}
"""Speed at the start, and when, or where, a force of 100 N begins and ends."""


def pushed(by, start):
    """A mass of 1 kg that a force of 100 N pushes for a while, or along a stretch of its way."""
    import casadi as ca

    t, x, v, begin, end = symbols("t", "x", "v", "begin", "end")
    at = t if by == "time" else x
    force = ca.if_else(at > begin, ca.if_else(at < end, 100.0, 0.0), 0.0)
    _, first, last = PUSHES[by]
    return build(
        f"pushed_at_{by}",
        time=t,
        states=[(x, 0.0), (v, start)],
        rates=[v, force],
        parameters=[(begin, first), (end, last)],
        outputs=[("x", x), ("v", v)],
    )


def run(by, solver):
    start = PUSHES[by][0]
    found = []
    statistics = simulate(
        compile_kernel(pushed(by, start), backend="compiled"),
        solver,
        start=0.0,
        stop=0.5,
        state=[0.0, start],
        unknowns=[],
        interval=10e-3,
        sink=lambda t, x, z, y: found.append(y[:, 1]),
        judged=Judged(
            [0, 1],
            lambda times, values: {"v.largest": (float(values[:, 1].max()), "m/s")},
            closely=True,
        ),
    )
    return statistics.accuracy, float(np.concatenate(found).max())


@pytest.mark.parametrize("by", PUSHES)
@pytest.mark.parametrize(
    ("method", "step"),
    [
        (Newmark, 10e-3),
        pytest.param(RungeKutta4, 10e-3, marks=pytest.mark.long),
        pytest.param(SymplecticEuler, 10e-3, marks=pytest.mark.long),
    ],
)
def test_a_push_within_a_step_is_seen(by, method, step, needs_compiler):
    accuracy, largest = run(by, method(step=step))
    exact = 0.3 if by == "time" else np.sqrt(1.0 + 200.0 * 1e-3)
    assert abs(largest - exact) > 0.05 * exact
    assert accuracy.verdict == "inaccurate"


@pytest.mark.parametrize("by", PUSHES)
def test_a_push_that_steps_resolve_raises_no_alarm(by, needs_compiler):
    accuracy, largest = run(by, RungeKutta4(step=0.0625e-3))
    assert largest == pytest.approx(0.3 if by == "time" else np.sqrt(1.2), rel=0.03)
    assert accuracy.verdict == "accurate"
    assert accuracy.error < 0.01


@pytest.mark.parametrize("backend", ["compiled", "interpreted"])
def test_a_force_that_begins_at_an_event_acts_from_there_on(backend):
    """Without the instant behind the event the step to the next sample has half of the force."""
    import casadi as ca

    t, x, v, begin = symbols("t", "x", "v", "begin")
    equations = build(
        "pushed_from_an_event_on",
        time=t,
        states=[(x, 0.0), (v, 0.0)],
        rates=[v, ca.if_else(t > begin, 10.0, 0.0)],
        parameters=[(begin, 0.1234)],
        outputs=[("x", x), ("v", v)],
    )
    equations = with_events(equations, ("begins", t - begin, "rising", False, {}))
    found = []
    simulate(
        compile_kernel(equations, backend=backend),
        Newmark(step=10e-3),
        start=0.0,
        stop=0.5,
        state=[0.0, 0.0],
        unknowns=[],
        interval=10e-3,
        sink=lambda t, x, z, y: found.append(y[:, 1]),
    )
    assert np.concatenate(found)[-1] == pytest.approx(10.0 * (0.5 - 0.1234), rel=1e-9)
