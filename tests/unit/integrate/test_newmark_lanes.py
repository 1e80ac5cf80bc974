"""Implicit steps of many cases side by side give what each case gives alone, bit for bit."""

import casadi as ca
import numpy as np
import pytest
from event_examples import bouncing_ball
from solve_examples import (
    build,
    cases_of,
    decay,
    double_pendulum,
    oscillator,
    slider_crank,
    symbols,
)

from vehicledyn.base.registry import find
from vehicledyn.codegen.toolchain.compiler import CompilationError
from vehicledyn.integrate import batch as batches
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.integrate.lane_run import suited_lanes
from vehicledyn.integrate.simulate import simulate
from vehicledyn.integrate.single_case import SingleCase
from vehicledyn.kernel.make_kernel import compile_kernel

pytestmark = pytest.mark.long
SPAN = {"start": 0.0, "stop": 0.5, "interval": 0.05}


@pytest.fixture
def left(monkeypatch):
    """Return the numbers of the cases that are run by themselves."""
    numbers, run = [], SingleCase.run

    def told(alone, cases, number, room):
        numbers.append(number)
        return run(alone, cases, number, room)

    monkeypatch.setattr(SingleCase, "run", told)
    return numbers


def solver(kind="generalised_alpha", step=0.005, **more):
    return find("solver", kind)(step=step, **more)


def both(kernel, lanes, method, cases, left, **span):
    """Return the results in lanes and alone, and which cases left their lanes."""
    span, channels = {**SPAN, **span}, range(len(kernel.equations.channels))
    abreast = run_batch(
        make_batch(kernel, lanes=lanes), method, cases, channels=channels, **span
    )  # fmt: skip
    by_themselves = list(left)
    alone = run_batch(make_batch(kernel, lanes=1), method, cases, channels=channels, **span)
    return abreast, alone, by_themselves


def same(one, two):
    return np.array_equal(one, two, equal_nan=True)


@pytest.mark.parametrize("kind", ["newmark", "hht", "generalised_alpha"])
@pytest.mark.parametrize("example", [slider_crank, double_pendulum, oscillator])
def test_lanes_change_nothing(lanes, left, example, kind):
    equations = example()
    kernel = compile_kernel(equations, backend="compiled")
    name, value = equations.parameters[-1].name, equations.parameters[-1].value
    cases = cases_of(equations, **{name: value * np.linspace(0.8, 1.2, lanes + 3)})
    abreast, alone, by_themselves = both(kernel, lanes, solver(kind), cases, left)
    assert by_themselves == []
    assert same(abreast.samples, alone.samples)
    assert abreast.ends == alone.ends
    turned = Cases(*[np.ascontiguousarray(item[::-1]) for item in vars(cases).values()])
    back, *_ = both(kernel, lanes, solver(kind), turned, left)
    assert same(back.samples[::-1], alone.samples)


def test_states_of_first_order(lanes, left):
    kernel = compile_kernel(decay(300.0), backend="compiled")
    starts = np.linspace(0.0, 1.0, 2 * lanes)[:, None]
    cases = Cases(np.zeros((len(starts), 0)), starts, np.zeros((len(starts), 0)))
    abreast, alone, by_themselves = both(kernel, lanes, solver(), cases, left)
    assert by_themselves == []
    assert same(abreast.samples, alone.samples)


def hard_stop():
    """Mass that falls on a stop whose force grows with the power 3/2."""
    t, x, v, k = symbols("t", "x", "v", "k")
    depth = ca.fmax(-x, 0.0)
    return build(
        "stop", time=t, states=[(x, 0.05), (v, -1.0)],
        rates=[v, k * depth * ca.sqrt(depth + 1e-12) - 9.81],
        parameters=[(k, 1e6)], outputs=[("x", x), ("v", v)], positions=(0,), velocities=(1,),
    )  # fmt: skip


@pytest.mark.parametrize("more", [{}, {"tolerance": 1e-6}])
def test_steps_are_halved_in_the_lanes_that_ask_for_it(lanes, left, more):
    kernel = compile_kernel(hard_stop(), backend="compiled")
    cases = cases_of(kernel.equations, k=10.0 ** np.linspace(3.0, 9.0, lanes + 4))
    method, counts = solver(step=0.025, **more), []
    for number in range(len(cases)):
        own = kernel.with_parameters(cases.parameters[number])
        start = {"state": cases.states[number], "unknowns": []}
        done = simulate(own, method, sink=lambda *_: None, watched=False, **start, **SPAN)
        counts.append(done.steps)
    assert len(set(counts)) > 2
    abreast, alone, by_themselves = both(kernel, lanes, method, cases, left)
    assert same(abreast.samples, alone.samples)
    assert len(set(range(len(cases))) - set(by_themselves)) > 0
    assert not (more and by_themselves)


@pytest.mark.parametrize("example", [slider_crank, double_pendulum])
def test_lanes_with_a_tolerance_change_nothing(lanes, left, example):
    equations = example()
    kernel = compile_kernel(equations, backend="compiled")
    name, value = equations.parameters[-1].name, equations.parameters[-1].value
    cases = cases_of(equations, **{name: value * np.linspace(0.6, 1.4, lanes + 3)})
    method = solver("hht", 0.05, tolerance=1e-7)
    abreast, alone, by_themselves = both(kernel, lanes, method, cases, left)
    assert by_themselves == []
    assert same(abreast.samples, alone.samples)
    assert abreast.ends == alone.ends


def test_only_cases_with_events_leave_their_lanes(lanes, left):
    """Balls from above 1.23 m do not reach the ground in half a second."""
    equations = bouncing_ball()
    kernel = compile_kernel(equations, backend="compiled")
    cases = cases_of(equations, restitution=np.linspace(0.5, 0.9, 11))
    cases.states[:, 0] = np.linspace(0.5, 2.5, 11)
    abreast, alone, by_themselves = both(kernel, lanes, solver(), cases, left)
    assert by_themselves == [k for k in range(11) if cases.states[k, 0] < 1.23]
    assert same(abreast.samples, alone.samples)
    assert abreast.ends == alone.ends


def ending():
    """A motion whose rate has no real value beyond a time."""
    t, x, v, last = symbols("t", "x", "v", "last")
    return build(
        "ends", time=t, states=[(x, 1.0), (v, 0.0)], rates=[v, ca.sqrt(last - t) - x],
        parameters=[(last, 0.3)], outputs=[("x", x)], positions=(0,), velocities=(1,),
    )  # fmt: skip


def test_a_case_that_cannot_go_on_stops_alone(lanes, left):
    kernel = compile_kernel(ending(), backend="compiled")
    cases = cases_of(kernel.equations, last=[9.0, 0.27, 8.0, 0.13, 7.0])
    abreast, alone, by_themselves = both(kernel, lanes, solver(), cases, left)
    assert by_themselves == [1, 3]
    assert [end.failed for end in abreast.ends] == [False, True, False, True, False]
    assert "Newton's method does not converge" in abreast.ends[1].message
    assert same(abreast.samples, alone.samples)
    assert abreast.ends == alone.ends


def turning(n=5):
    """States that turn each other around, so fast that factors need pivots off the diagonal."""
    x = symbols(*[f"x{k}" for k in range(n)])
    some = 300.0 * np.random.default_rng(5).normal(size=(n, n))
    (speed,) = symbols("speed")
    rates = speed * (ca.DM(some - some.T - 1e4 * np.tri(n, k=-1) * some) @ ca.sin(ca.vertcat(*x)))
    return build(
        "around", time=symbols("t")[0], states=[(item, 0.1 * k) for k, item in enumerate(x)],
        rates=ca.vertsplit(rates), parameters=[(speed, 1.0)], outputs=[("first", x[0])],
    )  # fmt: skip


def test_cases_that_need_pivots_run_by_themselves(lanes, left):
    kernel = compile_kernel(turning(), backend="compiled")
    cases = cases_of(kernel.equations, speed=[1e-3, 1.0, 1e-3])
    short = {"stop": 0.02, "interval": 0.01}
    abreast, alone, by_themselves = both(kernel, lanes, solver(step=1e-3), cases, left, **short)
    assert 1 in by_themselves
    assert same(abreast.samples, alone.samples)


def test_steps_with_multipliers_are_taken_case_by_case(needs_compiler, left):
    method = solver(constraints="index3")
    batch = make_batch(compile_kernel(oscillator(), backend="compiled"))
    assert not batches._runs_in_lanes(batch, method)


def test_without_a_compiler_for_the_steps_in_one_line(lanes, monkeypatch, caplog):
    kernel = compile_kernel(oscillator(), backend="compiled")
    batch = make_batch(kernel, lanes=lanes)

    def fails(_):
        raise CompilationError("no compiler")

    monkeypatch.setattr(batches, "newmark_lanes", fails)
    cases = cases_of(kernel.equations, stiffness=[1.0, 2.0])
    result = run_batch(batch, solver(), cases, channels=[0], **SPAN)
    assert [end.failed for end in result.ends] == [False, False]
    assert "no compiler; cases run one after the other" in caplog.text


def test_lanes_are_judged_by_half_the_step_where_windows_do_not_suffice(lanes, left):
    """What they are found to be is what each case is found to be by itself."""
    kernel = compile_kernel(oscillator(), backend="compiled")
    cases = cases_of(kernel.equations, stiffness=np.linspace(20.0, 30.0, lanes))
    span = {"start": 0.0, "stop": 8.0, "interval": 0.1}
    fine, alone, by_themselves = both(kernel, lanes, solver(step=0.025), cases, left, **span)
    assert by_themselves == []
    assert fine.ends == alone.ends
    assert fine.ends[0].accuracy.extra_steps > 2 * 8.0 / 0.025
    left.clear()
    coarse, alone, by_themselves = both(kernel, lanes, solver("hht", 0.1), cases, left, **span)
    assert by_themselves == list(range(lanes))
    assert {end.accuracy.verdict for end in coarse.ends} == {"inaccurate"}
    assert coarse.ends == alone.ends


@pytest.mark.parametrize(
    ("kind", "settings", "lanes"),
    [
        ("hht", {"step": 1e-2}, 8),
        ("hht", {"step": 1e-2, "tolerance": 1e-5}, 8),
        ("newmark", {"step": 1e-2, "constraints": "index3"}, 1),
        ("dop853", {"relative_tolerance": 1e-6, "absolute_tolerance": 1e-6}, 1),
    ],
)
def test_no_lanes_are_made_for_methods_that_take_none(kind, settings, lanes, caplog):
    """Their code would be compiled for nothing; who asks for them is told."""
    solver = find("solver", kind)(**settings)
    assert suited_lanes(solver, None) == (None if lanes > 1 else 1)
    assert not caplog.messages
    assert suited_lanes(solver, 8) == lanes
    assert bool(caplog.messages) == (lanes == 1)
