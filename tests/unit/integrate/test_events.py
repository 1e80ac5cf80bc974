"""Events: their instants, directions, resets and order, by every method on both backends."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from event_examples import (
    FIXED,
    GRAVITY,
    IMPLICIT,
    Run,
    bounces,
    bouncing_ball,
    crossing_oscillator,
    jumping_crank,
    kicked_oscillator,
    late_by,
    settings_of,
    settling_ball,
    with_events,
)
from solve_examples import build, double_pendulum, exact_slider_crank, symbols

from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import kinds
from vehicledyn.kernel.make_kernel import compile_kernel

pytestmark = pytest.mark.long

METHODS = [kind for kind in kinds("solver") if kind not in ("newmark", "hht")]
"""All but two that share every line with `generalised_alpha` beside their weights."""
EXACT = [kind for kind in METHODS if kind not in ("symplectic_euler", "rkc", *IMPLICIT)]
ADAPTIVE = [kind for kind in METHODS if kind not in FIXED]
FINEST = {"rk23": 1e-8}
"""Finest tolerances of methods that would take ten thousands of steps for finer ones."""
CROSSINGS = np.pi / 4.0 * np.arange(1, 11, 2)


def go(kernel, solver, *, stop, interval, start=0.0, state=None, step=1e-3, tolerance=1e-10):
    tolerance = max(tolerance, FINEST.get(solver, 0.0))
    settings = settings_of(solver, step=step, tolerance=tolerance)
    run = Run(kernel, solver, start=start, stop=stop, interval=interval, state=state, **settings)
    return run.go()


@pytest.mark.parametrize("solver", EXACT)
def test_bouncing_ball(backend, solver):
    """Flights are parabolas, which the methods follow up to rounding or their tolerance.

    An error of a local tolerance of 1e-12 m a step, some hundreds of steps of cvodes long, is
    an error of 1e-9 s at an impact at 1 m/s.
    """
    kernel = compile_kernel(bouncing_ball(), backend=backend)
    run = go(kernel, solver, stop=3.0, interval=0.05, tolerance=1e-12)
    assert {name for name, _ in run.events} == {"impact"}
    expected = bounces(len(run.events))
    assert len(run.events) == 6
    assert bounces(7)[-1] > 3.0
    assert run.times == pytest.approx(expected, abs=1e-9)
    assert run.statistics.events == 6
    assert run.statistics.ended_by is None
    flights = np.searchsorted(expected, run.samples.times)
    energy = GRAVITY * 0.64**flights
    assert run.samples.outputs[:, 0] == pytest.approx(energy, rel=3e-9)
    assert run.samples.times == pytest.approx(0.05 * np.arange(61), abs=1e-14)


def test_bouncing_ball_by_symplectic_euler(backend):
    """The first impact is late by half a step of falling, first order in the step."""
    kernel = compile_kernel(bouncing_ball(), backend=backend)
    errors = []
    for step in (2e-3, 1e-3, 5e-4):
        run = go(kernel, "symplectic_euler", stop=2.0, interval=0.1, step=step)
        errors.append(np.abs(run.times[:3] - bounces(3)).max())
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([1.0, 1.0], abs=0.1)


@pytest.mark.parametrize("solver", METHODS)
@pytest.mark.parametrize(("direction", "which"), [("falling", 0), ("rising", 1), ("either", None)])
def test_direction(solver, direction, which):
    kernel = compile_kernel(crossing_oscillator(direction), backend="interpreted")
    run = go(kernel, solver, stop=8.0, interval=0.1, step=5e-3)
    expected = CROSSINGS if which is None else CROSSINGS[which::2]
    # Symplectic Euler is late by at most half a step and 5e-6 of the time.
    accuracy = {
        "symplectic_euler": 3e-3,
        "rkc": 1e-4,
        **dict.fromkeys(IMPLICIT, 1e-4),
        "rk23": 1e-6,
    }.get(solver, 1e-7)
    assert run.times == pytest.approx(expected, abs=accuracy)


@pytest.mark.parametrize("solver", METHODS)
def test_every_crossing_is_found_between_coarse_samples(solver):
    """Six crossings lie in each sampling interval; only the method's own steps are fine."""
    kernel = compile_kernel(crossing_oscillator(), backend="interpreted")
    run = go(kernel, solver, stop=30.0, interval=10.0, step=1e-2, tolerance=1e-8)
    expected = np.pi / 4.0 * np.arange(1, 39, 2) * (1.0 + late_by(solver, 2.0 * 1e-2))
    assert len(run.events) == len(expected)
    accuracy = {"symplectic_euler": 2e-2, "rkc": 1e-3}.get(solver, 1e-5)
    assert run.times == pytest.approx(expected, abs=accuracy)
    assert run.samples.times.tolist() == [0.0, 10.0, 20.0, 30.0]


@pytest.mark.parametrize("solver", METHODS)
def test_terminal_event_ends_the_run_at_its_time(backend, solver):
    kernel = compile_kernel(crossing_oscillator("rising", terminal=True), backend=backend)
    run = go(kernel, solver, stop=9.0, interval=0.1, tolerance=1e-12)
    assert [name for name, _ in run.events] == ["zero"]
    assert run.statistics.ended_by == "zero"
    times = run.samples.times
    assert times[-1] == run.times[0]
    accuracy = {
        "symplectic_euler": 1e-3,
        "rkc": 1e-6,
        **dict.fromkeys(IMPLICIT, 1e-6),
        "rk23": 1e-6,
    }.get(solver, 1e-8)
    due = 0.75 * np.pi * (1.0 + late_by(solver, 2.0 * 1e-3))
    assert times[-1] == pytest.approx(due, abs=accuracy)
    assert times[:-1] == pytest.approx(0.1 * np.arange(24), abs=1e-14)
    assert run.samples.states[-1] == pytest.approx([0.0, 2.0], abs=2.0 * accuracy)
    assert run.statistics.samples == 25


@pytest.mark.parametrize("solver", METHODS)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_start_beyond_a_limit_of_the_model_ends_the_run_at_once(solver, sign):
    """Advice makes a terminal event a limit; without it the run waits for the event."""
    direction = "rising" if sign > 0.0 else "falling"
    waits = crossing_oscillator(direction, terminal=True)
    ends = replace(waits, events=(replace(waits.events[0], advice="turn back"),))
    for equations, end, samples in ((waits, 0.75 * np.pi, 25), (ends, 0.0, 1)):
        kernel = compile_kernel(equations, backend="interpreted")
        beyond = np.array([sign, 0.0])
        run = go(kernel, solver, stop=9.0, interval=0.1, state=beyond)
        assert run.statistics.ended_by == "zero"
        assert [name for name, _ in run.events] == ["zero"]
        assert run.times == pytest.approx([end], abs=1e-3)
        assert run.statistics.samples == len(run.samples.times) == samples


@pytest.mark.parametrize("solver", [kind for kind in METHODS if kind != "cvodes"])
def test_reset_closes_the_loops_anew(backend, solver):
    """The crank jumps on by 0.5 rad and stops turning back; rod and slider follow."""
    kernel = compile_kernel(jumping_crank(), backend=backend)
    run = go(kernel, solver, stop=1.0, interval=0.01)
    assert len(run.events) == 1
    states, energy = run.samples.states, run.samples.outputs[:, 0]
    exact = [exact_slider_crank(angle) for angle in states[:, 0]]
    assert run.samples.unknowns == pytest.approx(np.array(exact), abs=1e-13)
    after = run.samples.times >= run.times[0]
    assert exact[int(np.argmax(after)) - 1][1] > 2.0
    assert np.diff(states[:, 0])[np.argmax(after) - 1] > 0.5
    # Energy is kept on both sides, to the order of the method.
    accuracy = {"symplectic_euler": 1e-2, "rkc": 1e-5, **dict.fromkeys(IMPLICIT, 1e-5)}.get(
        solver, 1e-7
    )
    for side in (after, ~after):
        assert energy[side] == pytest.approx(energy[side][0], rel=accuracy)
    assert energy[-1] < 0.5 * energy[0]


@pytest.mark.parametrize(
    ("solver", "order"),
    [("rk4", 4), ("symplectic_euler", 1), ("rkc", 2), *((kind, 2) for kind in IMPLICIT)],
)
def test_order_holds_across_events(backend, solver, order):
    kernel = compile_kernel(kicked_oscillator(), backend=backend)
    exact = 0.5 * np.array([np.cos(6.0), -2.0 * np.sin(6.0)])
    errors = []
    for steps in np.array([16, 32, 64, 128]) * (16 if order == 1 else 1):
        run = go(kernel, solver, stop=3.0, interval=1.0, step=1.0 / float(steps))
        errors.append(np.abs(run.samples.states[-1] - exact).max())
        assert len(run.events) == 1
    assert np.log2(np.array(errors[:-1]) / errors[1:]) == pytest.approx([order] * 3, abs=0.4)


@pytest.mark.parametrize("solver", ADAPTIVE)
def test_tolerance_holds_across_events(solver):
    kernel = compile_kernel(kicked_oscillator(), backend="interpreted")
    errors = []
    for tolerance in (1e-5, 1e-8):
        run = go(kernel, solver, stop=6.0, interval=0.25, tolerance=tolerance)
        passes = np.searchsorted(CROSSINGS[::2], run.samples.times)
        exact = 0.5**passes * np.cos(2.0 * run.samples.times)
        errors.append(np.abs(run.samples.states[:, 0] - exact).max())
        assert errors[-1] < 500.0 * tolerance
    assert errors[0] > 30.0 * errors[1]


@pytest.mark.parametrize("solver", [kind for kind in FIXED if kind not in ("newmark", "hht")])
@pytest.mark.parametrize(
    ("make", "stop"),
    [(bouncing_ball, 3.0), (kicked_oscillator, 4.0), (settling_ball, 5.0), (jumping_crank, 6.0)],
)
def test_backends_agree(needs_compiler, solver, make, stop):
    one, two = (
        go(compile_kernel(make(), backend=b), solver, stop=stop, interval=0.1, step=2e-3)
        for b in ("compiled", "interpreted")
    )
    assert len(one.events) == len(two.events) > 1
    assert one.times == pytest.approx(two.times, abs=1e-11)
    assert one.samples.states == pytest.approx(two.samples.states, abs=1e-9)
    assert one.samples.outputs == pytest.approx(two.samples.outputs, abs=1e-9)
    assert one.statistics.steps == two.statistics.steps == round(stop / 2e-3)


def test_chunks_change_nothing(backend, monkeypatch):
    kernel = compile_kernel(bouncing_ball(), backend=backend)
    whole = go(kernel, "rk4", stop=2.0, interval=0.02, step=5e-3)
    monkeypatch.setattr("vehicledyn.integrate.fixed_step._FIRST_CHUNK", 3)
    monkeypatch.setattr("vehicledyn.integrate.fixed_step._GROWTH", 1)
    parts = go(kernel, "rk4", stop=2.0, interval=0.02, step=5e-3)
    assert np.array_equal(whole.times, parts.times)
    assert np.array_equal(whole.samples.states, parts.samples.states)


def clock(*events, states=1):
    """States that count, and events at given times."""
    t = ca.SX.sym("t")
    counters = symbols(*[f"counter_{k}" for k in range(states)])
    equations = build(
        "clock",
        time=t,
        states=[(counter, 0.0) for counter in counters],
        rates=[ca.SX(0.0)] * states,
        parameters=[],
        outputs=[(counter.name(), counter) for counter in counters],
    )
    return with_events(equations, *[make(t, counters) for make in events])


@pytest.mark.parametrize("solver", METHODS)
def test_event_at_the_time_of_a_sample(solver):
    """It happens once; a sample behind it shows the state after the reset."""

    def tick(t, counters):
        return "tick", t - 0.5, "either", False, {0: counters[0] + 1.0}

    kernel = compile_kernel(clock(tick), backend="interpreted")
    run = go(kernel, solver, stop=1.0, interval=0.1, step=0.05)
    assert run.times == pytest.approx([0.5], abs=2e-12)
    counter = run.samples.states[:, 0]
    assert counter[:5].tolist() == [0.0] * 5
    assert counter[6:].tolist() == [1.0] * 5


@pytest.mark.parametrize("solver", METHODS)
def test_several_events_in_one_step(solver):
    """They come in the order of time, whatever their order in the model."""

    def at(name, time):
        def make(t, counters):
            return name, t - time, "rising", False, {0: 2.0 * counters[0] + len(name)}

        return make

    kernel = compile_kernel(clock(at("ccc", 0.43), at("a", 0.41), at("bb", 0.42)), backend="auto")
    run = go(kernel, solver, stop=1.0, interval=0.1, step=0.1)
    assert [name for name, _ in run.events] == ["a", "bb", "ccc"]
    assert run.times == pytest.approx([0.41, 0.42, 0.43], abs=2e-12)
    assert run.samples.states[-1, 0] == 2.0 * (2.0 * 1.0 + 2.0) + 3.0


@pytest.mark.parametrize("solver", METHODS)
def test_simultaneous_events_happen_in_the_order_of_the_model(backend, solver):
    """Rounding puts their zeros apart by less than can be resolved."""

    def double(t, counters):
        return "double", 3.0 * (t - 0.1 - 0.2), "rising", False, {0: 2.0 * counters[0]}

    def add(t, counters):
        return "add", t - 0.3, "rising", False, {0: counters[0] + 1.0}

    for events, expected in (((double, add), 1.0), ((add, double), 2.0)):
        kernel = compile_kernel(clock(*events), backend=backend)
        run = go(kernel, solver, stop=0.5, interval=0.25, step=0.05)
        assert [name for name, _ in run.events] == [make.__name__ for make in events]
        assert run.samples.states[-1, 0] == expected


@pytest.mark.parametrize("solver", METHODS)
def test_resets_of_one_event_take_effect_at_once(solver):
    def swap(t, counters):
        return "swap", t - 0.3, "either", False, {0: counters[1], 1: counters[0]}

    kernel = compile_kernel(clock(swap, states=2), backend="interpreted")
    run = go(kernel, solver, stop=0.5, interval=0.25, state=[1.0, 2.0], step=0.05)
    assert run.samples.states[[0, -1]].tolist() == [[1.0, 2.0], [2.0, 1.0]]


@pytest.mark.parametrize("solver", METHODS)
def test_start_on_an_event_does_not_fire_it(solver):
    """A ball thrown from the ground fires when it comes down, even within the first step."""
    kernel = compile_kernel(bouncing_ball(), backend="auto")
    for speed in (3.0, 0.1):
        run = go(
            kernel, solver, stop=0.07, interval=0.07, state=[0.0, speed], step=0.07, tolerance=1e-12
        )
        flight = 2.0 * speed / GRAVITY
        if solver == "symplectic_euler":
            assert len(run.events) == 0 if speed > 1.0 else run.times[0] < flight
        elif speed > 1.0:
            assert run.events == []
        else:
            expected = flight * np.cumsum(0.8 ** np.arange(len(run.events)))
            assert run.times == pytest.approx(expected, abs=1e-8)
            assert len(run.events) == 5
    at_rest = go(kernel, solver, stop=0.07, interval=0.07, state=[1.0, 0.0], step=0.07)
    assert at_rest.events == []


@pytest.mark.parametrize("solver", METHODS)
def test_accumulating_events_are_an_error(backend, solver):
    """The flights shrink to nothing at 4.0637 s: what was sampled before that is kept."""
    kernel = compile_kernel(bouncing_ball(), backend=backend)
    run = Run(kernel, solver, stop=5.0, interval=0.05, **settings_of(solver))
    with pytest.raises(NumericalError, match="event 'impact' fires for the third time within"):
        run.go()
    end = 0.0 if solver == "symplectic_euler" else 4.0637
    assert run.samples.times[-1] == pytest.approx(4.05 if end else 3.9, abs=0.06)
    assert 20 < len(run.events) < 80
    assert np.all(run.samples.states[:, 0] > -1e-9)
    if end:
        assert run.times[-1] == pytest.approx(end, abs=2e-4)


@pytest.mark.parametrize("solver", METHODS)
def test_a_switch_lets_the_ball_come_to_rest(backend, solver):
    kernel = compile_kernel(settling_ball(), backend=backend)
    run = go(kernel, solver, stop=5.0, interval=0.05)
    assert run.samples.states[-1] == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)
    if solver != "symplectic_euler":
        # The speed falls below 0.02 m/s after as many impacts as the closed form says.
        count = int(np.ceil(np.log(0.02 / np.sqrt(2.0 * GRAVITY)) / np.log(0.8)))
        assert len(run.events) == count
        assert run.times == pytest.approx(bounces(count), abs=1e-6)


def test_many_small_flights_within_a_step(backend):
    """Twelve impacts fall into one step of 0.2 s; free flight is exact for any step."""
    kernel = compile_kernel(bouncing_ball(), backend=backend)
    run = go(kernel, "rk4", stop=4.0, interval=0.4, step=0.2)
    assert run.times == pytest.approx(bounces(len(run.events)), abs=1e-9)
    assert bounces(len(run.events) + 1)[-1] > 4.0
    assert np.sum(run.times > 3.8) >= 6


@pytest.mark.parametrize("solver", ["rk4", "dop853", "idas", "rosenbrock"])
def test_event_of_an_unknown_of_loops(backend, solver):
    """The tip of a double pendulum, found through two blocks, passes below the hinge."""
    equations = double_pendulum()
    tip = equations.algebraic[2]
    kernel = compile_kernel(
        with_events(equations, ("below", tip, "either", True, {})), backend=backend
    )
    run = go(kernel, solver, stop=2.0, interval=0.05)
    assert run.statistics.ended_by == "below"
    state = run.samples.states[-1]
    assert np.sin(state[0]) + 0.8 * np.sin(state[1]) == pytest.approx(0.0, abs=1e-10)
    assert run.samples.unknowns[-1, 2] == pytest.approx(0.0, abs=1e-10)


def test_parameters_move_events(backend):
    kernel = compile_kernel(bouncing_ball(), backend=backend).with_parameters([1.0, 0.5])
    run = go(kernel, "rk4", stop=3.5, interval=0.5)
    first = np.sqrt(2.0)
    assert run.times == pytest.approx([first, 2.0 * first], abs=1e-10)


def test_kernels_with_other_events_are_other_kernels(needs_compiler):
    """The cache holds a kernel for each direction; a terminal event needs none of its own."""
    runs = [
        go(compile_kernel(crossing_oscillator(d), backend="compiled"), "rk4", stop=2.0, interval=1)
        for d in ("falling", "rising")
    ]
    assert [len(run.events) for run in runs] == [1, 0]
    again = compile_kernel(crossing_oscillator("falling", terminal=True), backend="compiled")
    assert again.report.cached
