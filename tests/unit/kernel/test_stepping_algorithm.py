"""The fixed steps of the compiled kernel, alone and in lanes, are those of the interpreted one.

Rates and residuals here are single additions and products, which every engine rounds alike, so
that each statement of a step must give the same number to the bit.
"""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from solve_examples import build, symbols

from vehicledyn.integrate.batch import make_batch
from vehicledyn.integrate.lane_run import FixedLaneRun
from vehicledyn.kernel.engine import Count, March, Method, SampleRows, Status
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.symbolic.equations import Block

METHODS = {
    "rk4": Method.RK4,
    "symplectic_euler": Method.SYMPLECTIC_EULER,
    "rkc_2": Method.CHEBYSHEV + 2,
    "rkc_5": Method.CHEBYSHEV + 5,
    "rkc_14": Method.CHEBYSHEV + 14,
}
INTERVAL, PER_INTERVAL, STEPS = 0.3, 3, 12
START, EDGE = 0.7, 2.0**-20


def swinging():
    """A pendulum-like pair with unknowns that follow from both.

    Newton's method takes a step more from a guess that is too large, so the guesses show.
    """
    t, x, v, w, z, y = symbols("t", "position", "velocity", "work", "sum", "difference")
    excess, lack = z - (x + v), y - (x - v)
    return build(
        "swinging",
        time=t,
        states=[(x, 1.1), (v, 0.3), (w, 0.2)],
        rates=[v, -(x * z), t * y],
        parameters=[],
        outputs=[("product", z * y)],
        unknowns=[(z, 1.4), (y, 0.8)],
        residuals=[excess + ca.fmax(excess - EDGE, 0), lack + ca.fmax(lack - EDGE, 0)],
        blocks=(Block("first", 0, 1, 1e-9), Block("second", 1, 2, 1e-9)),
        positions=(0,),
        velocities=(1,),
    )


@pytest.fixture(scope="module")
def kernels(needs_compiler):
    return {name: compile_kernel(swinging(), backend=name) for name in ("compiled", "interpreted")}


def begun(kernel, method):
    state = np.array([1.1, 0.3, 0.2])
    unknowns = kernel.solve_unknowns(START, state, [1.4, 0.8])
    return March(method, START, INTERVAL, PER_INTERVAL, state, unknowns)


def everything(march):
    counts = [march.ledger.counts[item] for item in (Count.EVALUATIONS, Count.ITERATIONS)]
    return np.concatenate([march.state, march.unknowns, march.memory, counts])


def steps(kernel, method):
    """Return all that a run knows after each step, and its samples."""
    march, found, samples = begun(kernel, method), [], []
    while march.step < STEPS:
        rows = SampleRows(np.zeros((2, 3)), np.zeros((2, 2)), np.zeros((2, 1)))
        assert kernel.advance(march, 1, rows) is Status.SOLVED
        found.append(everything(march))
        if march.ledger.counts[Count.SAMPLES]:
            samples.append(np.concatenate([rows.states[0], rows.unknowns[0], rows.outputs[0]]))
    return np.array(found), np.array(samples)


@pytest.mark.parametrize("method", METHODS)
def test_each_step_is_the_same_to_the_bit(kernels, method):
    (one, first), (two, second) = (steps(kernel, METHODS[method]) for kernel in kernels.values())
    assert np.ptp(one[:, 0]) > 0.05
    assert np.array_equal(one, two)
    assert len(first) == STEPS // PER_INTERVAL
    assert np.array_equal(first, second)


@pytest.mark.parametrize("method", METHODS)
def test_a_part_of_a_step_is_the_same_to_the_bit(kernels, method):
    found = []
    for kernel in kernels.values():
        march = begun(kernel, METHODS[method])
        rows = SampleRows(np.zeros((3, 3)), np.zeros((3, 2)), np.zeros((3, 1)))
        kernel.advance(march, 4, rows)
        for part in ((0.0, 0.3), (0.3, 0.8), (0.8, 1.0)):
            copy = replace(march)
            assert kernel.advance_part(copy, part) is Status.SOLVED
            found.append((copy.state, copy.unknowns))
    half = len(found) // 2
    for one, two in zip(found[:half], found[half:], strict=True):
        assert np.array_equal(one[0], two[0])
        assert np.array_equal(one[1], two[1])


@pytest.mark.parametrize("method", METHODS)
def test_each_step_in_lanes_is_the_same_to_the_bit(kernels, method):
    kernel = kernels["compiled"]
    expected, _ = steps(kernels["interpreted"], METHODS[method])
    engine = make_batch(kernel).engine
    run = lanes_begun(engine, kernel, METHODS[method])
    samples = np.zeros((engine.lanes, STEPS, 1))
    assert run.begin(samples)
    for number in range(STEPS):
        assert run.advance(1, samples)
        own = np.concatenate([run.state, run.unknowns, run.memory[:5]])
        assert all(np.array_equal(own[:, lane], expected[number, :10]) for lane in (0, 1))


def lanes_begun(engine, kernel, method):
    """Return a run of equal cases in all lanes."""
    march = begun(kernel, method)
    parameters = engine.spread(kernel.parameters[None, :])
    return FixedLaneRun(
        engine,
        START,
        INTERVAL,
        PER_INTERVAL,
        np.zeros(1, dtype=np.intc),
        engine.prepare(parameters),
        engine.spread(march.state[None, :]),
        engine.spread(march.unknowns[None, :]),
        method=method,
    )
