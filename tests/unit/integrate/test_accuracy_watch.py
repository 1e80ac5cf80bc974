"""The watch of accuracy: verdicts on motions with known errors, and runs it must not touch."""

from dataclasses import replace
from itertools import count

import numpy as np
import pytest
from event_examples import with_events
from solve_examples import build, decay, oscillator, symbols

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy.monitor import AccuracyMonitor
from vehicledyn.integrate.accuracy.proposed_step import (
    dividing_step,
    eigenvalues,
    longest_step,
    proposed_step,
)
from vehicledyn.integrate.accuracy.windows import WindowEnds, window_places
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.integrate.estimated_accuracy import Accuracy, worst_of
from vehicledyn.integrate.judged_quantities import EnergyBalance, Judged
from vehicledyn.integrate.methods.generalised_alpha import GeneralisedAlpha
from vehicledyn.integrate.methods.newmark import Newmark
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.methods.rkc import RungeKuttaChebyshev
from vehicledyn.integrate.methods.symplectic_euler import SymplecticEuler
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.engine import Method
from vehicledyn.kernel.make_kernel import compile_kernel

BACKENDS = ["compiled", "interpreted"]


def watched(equations, solver, *, stop, interval, backend="compiled", judged=None):
    """Run equations; return the statistics and all samples."""
    kernel = compile_kernel(equations, backend=backend)
    found = []
    statistics = simulate(
        kernel,
        solver,
        start=0.0,
        stop=stop,
        state=[s.start for s in equations.states],
        unknowns=[u.start for u in equations.unknowns],
        interval=interval,
        sink=lambda t, x, z, y: found.append((t, x, y)),
        judged=judged,
    )
    return statistics, [np.concatenate(parts) for parts in zip(*found, strict=True)]


def swinging(stiffness=400.0):
    """An oscillator whose position is a channel: 20 rad/s."""
    e = oscillator(stiffness)
    x, v = e.state[0], e.state[1]
    import casadi as ca

    from vehicledyn.symbolic.equations import Channel

    channels = (*e.channels, Channel("place", "m", "place"), Channel("speed", "m/s", "speed"))
    return replace(e, output=ca.vertcat(e.output, x, v), channels=channels)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("solver", "verdict"),
    [
        (RungeKutta4(step=0.002), "accurate"),
        (RungeKutta4(step=0.1), "inaccurate"),
        (SymplecticEuler(step=0.001), "accurate"),
        (SymplecticEuler(step=0.05), "inaccurate"),
        (RungeKuttaChebyshev(step=0.001, stages=3), "accurate"),
        (RungeKuttaChebyshev(step=0.025, stages=3), "inaccurate"),
        (GeneralisedAlpha(step=0.005, spectral_radius=0.9), "accurate"),
        (GeneralisedAlpha(step=0.02, spectral_radius=0.5), "inaccurate"),
        (Newmark(step=0.002, gamma=0.501, beta=0.2505), "accurate"),
        (Newmark(step=0.02, gamma=0.6, beta=0.3025), "inaccurate"),
    ],
    ids=lambda item: item if isinstance(item, str) else f"{item.kind}-{item.step}",
)
def test_verdicts_on_an_oscillator(solver, verdict, backend):
    """x = cos 20 t and its energy over 10 s, whose extremes and means are known."""
    statistics, (_, _, outputs) = watched(
        swinging(), solver, stop=10.0, interval=0.1, backend=backend
    )
    energy = outputs[:, 0] / outputs[0, 0]
    assert (np.abs(energy - 1.0).max() > 0.05) == (verdict == "inaccurate")
    assert statistics.accuracy.verdict == verdict


@pytest.mark.parametrize(
    "solver",
    [
        RungeKutta4(step=0.1),
        SymplecticEuler(step=0.05),
        GeneralisedAlpha(step=0.02, spectral_radius=0.5),
    ],
)
def test_the_recommended_step_is_accurate(solver):
    first = watched(swinging(), solver, stop=10.0, interval=0.1)[0].accuracy
    assert first.step < solver.step
    again = solver.model_copy(update={"step": first.step})
    second = watched(swinging(), again, stop=10.0, interval=0.1)[0].accuracy
    assert second.verdict == "accurate", second


def set_off(decay_rate, *, leaves=0.5):
    """A slip that fades at once and what it leaves, beside an oscillator of 1 rad/s."""
    t, slip, left, x, v, rate = symbols("t", "slip", "left", "x", "v", "rate")
    return build(
        "set_off",
        time=t,
        states=[(slip, 1.0), (left, 0.0), (x, 1.0), (v, 0.0)],
        rates=[-rate * slip, 2.0 * leaves * rate * slip**2, v, -x],
        parameters=[(rate, decay_rate)],
        outputs=[("slip", slip), ("left", left), ("x", x)],
    )


@pytest.mark.parametrize(("decay_rate", "verdict"), [(100.0, "accurate"), (500.0, "inaccurate")])
def test_what_a_start_sets_off_costs_a_look_at_the_start(decay_rate, verdict):
    """Only the window at the start finds errors; all of the run was taken again for that."""
    solver = RungeKutta4(step=0.005)
    statistics, (_, _, outputs) = watched(set_off(decay_rate), solver, stop=20.0, interval=0.05)
    accuracy = statistics.accuracy
    assert (abs(2.0 * outputs[-1, 1] - 1.0) > 0.05) == (verdict == "inaccurate")
    assert accuracy.verdict == verdict
    assert (accuracy.extra_steps < 0.25 * statistics.steps) == (verdict == "accurate")


def test_a_start_that_leaves_nothing_is_looked_at_no_further():
    """The slip is off by 1 % of its range when the window ends, and gone at the first sample."""
    solver, equations = RungeKutta4(step=0.005), set_off(300.0, leaves=0.0)
    statistics = watched(equations, solver, stop=20.0, interval=0.05)[0]
    assert statistics.accuracy.verdict == "accurate"
    assert statistics.accuracy.extra_steps < 0.25 * statistics.steps


@pytest.mark.parametrize(("stuck", "looks_again"), [({64}, False), ({64, 80}, True)])
def test_a_window_that_gets_stuck_is_replaced_by_one_half_way(stuck, looks_again, monkeypatch):
    """One in a singular configuration that the run passes in another way; they are 32 apart."""
    end = WindowEnds.end

    def taken(self, place, pieces):
        found = end(self, place, pieces)
        return np.full_like(found, np.inf) if place.index in stuck else found

    monkeypatch.setattr(WindowEnds, "end", taken)
    accuracy = watched(swinging(), RungeKutta4(step=0.002), stop=20.0, interval=0.1)[0].accuracy
    assert accuracy.verdict == "accurate"
    assert (accuracy.extra_steps > 1000) == looks_again


def test_steps_that_follow_a_tolerance_are_not_judged():
    solver = GeneralisedAlpha(step=0.02, spectral_radius=0.5, tolerance=1e-6)
    assert watched(swinging(), solver, stop=2.0, interval=0.1)[0].accuracy is None


def test_an_early_end_that_only_a_long_step_brings_is_found():
    """Damped steps lose height: the event at a fall below 0.9 m would never come."""
    e = swinging()
    equations = with_events(e, ("low", e.output[0] / 200.0 - 0.9, "falling", True, {}))
    solver = GeneralisedAlpha(step=0.02, spectral_radius=0.5)
    with pytest.raises(NumericalError, match="the run ends early only because its step is too"):
        watched(equations, solver, stop=10.0, interval=0.1)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_run_that_diverges_fails_with_the_step_to_take(backend):
    """|λ h| = 3 with RK4: the state grows by half in every step."""
    with pytest.raises(NumericalError, match=r"diverges with a step of 150 ms; take a step of"):
        watched(swinging(), RungeKutta4(step=0.15), stop=90.0, interval=0.15, backend=backend)


def test_slow_divergence_is_found_at_the_end():
    """A run that ends at 1e5 times its start, far from what no vehicle reaches."""
    with pytest.raises(NumericalError, match="the integration diverged: the step is too long"):
        watched(swinging(), RungeKutta4(step=0.1435), stop=28.7, interval=0.1435)


def test_what_grows_by_itself_does_not_diverge():
    """An unstable motion followed well is no matter of the step: x = cosh t to 1e10."""
    x, v, t, k = symbols("x", "v", "t", "k")
    growing = build(
        "growing",
        time=t,
        states=[(x, 1.0), (v, 0.0)],
        rates=[v, k * x],
        parameters=[(k, 1.0)],
        outputs=[("place", x)],
        positions=(0,),
        velocities=(1,),
    )
    statistics, _ = watched(growing, RungeKutta4(step=0.01), stop=24.0, interval=0.1)
    assert statistics.accuracy.verdict == "accurate"


@pytest.mark.parametrize("backend", BACKENDS)
def test_the_watch_changes_no_bit_of_the_run(backend, monkeypatch):
    solver = RungeKutta4(step=0.1)
    seen = watched(swinging(), solver, stop=10.0, interval=0.1, backend=backend)[1]
    monkeypatch.setattr("vehicledyn.integrate.fixed_step.watch_of", lambda *_: None)
    blind = watched(swinging(), solver, stop=10.0, interval=0.1, backend=backend)[1]
    for one, other in zip(seen, blind, strict=True):
        assert np.array_equal(one, other)


def test_the_verdict_is_the_same_in_every_run():
    found = [watched(swinging(), RungeKutta4(step=0.05), stop=10.0, interval=0.1) for _ in "ab"]
    assert found[0][0].accuracy == found[1][0].accuracy


@pytest.mark.parametrize(
    ("step", "expected"),
    [
        (0.002, ("accurate", "accurate")),
        (0.02, ("accurate", "inaccurate")),
        (0.1, ("inaccurate", "diverged")),
    ],
)
def test_lanes_judge_as_single_cases_do(step, expected):
    equations = swinging()
    kernel = compile_kernel(equations, backend="compiled")
    start = [s.start for s in equations.states]
    values = np.tile([p.value for p in equations.parameters], (6, 1))
    values[:, 0] = np.linspace(100.0, 900.0, 6)
    cases = Cases(values, np.tile(start, (6, 1)), np.zeros((6, 0)))
    span = {"start": 0.0, "stop": 10.0, "interval": 0.1, "channels": [0, 1, 2]}
    ends = [
        run_batch(make_batch(kernel, lanes=n), RungeKutta4(step=step), cases, **span).ends
        for n in (1, 4)
    ]
    assert ends[0] == ends[1]
    judged = [end.accuracy.verdict if end.accuracy else "diverged" for end in ends[0]]
    assert (judged[0], judged[-1]) == expected


def test_lanes_judge_the_energy_as_single_cases_do():
    """The position alone is accurate by the windows; the balance of the energy asks for a look."""
    equations = swinging()
    kernel = compile_kernel(equations, backend="compiled")
    given = ([item.value for item in equations.parameters], [1.0, 0.0], [])
    cases = Cases(*[np.tile(row, (4, 1)) for row in given])

    def balance(times, samples, *, rough):
        """Return a loss of energy that the steps cause, a third less in a run of half the step."""
        lost = abs(samples[-1, 0] - np.cos(20.0 * times[-1]))
        return EnergyBalance(1.0 + 1e6 * lost, 1.0)

    def judged(_):
        channels = [equations.channels.index(c) for c in equations.channels if c.name == "place"]
        figures = lambda times, samples: {"last": (float(samples[-1, 0]), "m")}  # noqa: E731
        return Judged(channels, figures, by_itself=False, balance=balance)

    span = {"start": 0.0, "stop": 10.0, "interval": 0.1, "channels": [0, 1, 2], "judged": judged}
    method = RungeKutta4(step=0.002)
    alone, abreast = (
        run_batch(make_batch(kernel, lanes=n), method, cases, **span).ends for n in (1, 4)
    )
    assert alone == abreast
    assert {end.accuracy.verdict for end in alone} == {"inaccurate"}


def test_a_figure_is_what_counts():
    """The place is off by more than the figure made of it, which is what the run is judged by."""

    def figures(times, values):
        return {"count": (float(len(times)), "1")}

    channels = [1]
    solver = RungeKutta4(step=0.1)
    bare, judged = (
        watched(swinging(), solver, stop=10.0, interval=0.1, judged=Judged(channels, make))[
            0
        ].accuracy
        for make in (None, figures)
    )
    assert bare.verdict == "inaccurate"
    assert (judged.verdict, judged.worst) == ("accurate", "'count'")


@pytest.mark.parametrize(("size", "verdict"), [(4e-7, "accurate"), (4e-2, "inaccurate")])
def test_what_symmetry_makes_zero_is_no_error(size, verdict):
    """Noise of 4e-7 m/s² beside 400 m/s² counts for nothing, that of 4e-2 m/s² does."""
    import casadi as ca

    from vehicledyn.symbolic.equations import Channel

    e = swinging()
    x = e.state[0]
    lateral, vertical = size * ca.sin(1e7 * x), 400.0 * x
    noisy = replace(
        e,
        output=ca.vertcat(e.output, lateral, vertical),
        channels=(
            *e.channels,
            Channel("lateral", "m/s^2", "zero by symmetry"),
            Channel("vertical", "m/s^2", "alike"),
        ),
    )

    def figures(times, values):
        return {"largest_lateral": (float(np.abs(values).max()), "m/s^2")}

    number = [c.name for c in noisy.channels].index("lateral")
    for make in (None, figures):
        judged = Judged([number], make)
        found = watched(noisy, RungeKutta4(step=2e-3), stop=1.0, interval=0.1, judged=judged)
        if make is None or verdict == "accurate":
            assert found[0].accuracy.verdict == verdict


def test_an_impact_that_no_step_settles_is_called_so():
    """The figure is another one in every run, whatever the step."""
    runs = count()

    def figures(times, values):
        return {"chance": (1.0 + next(runs) % 2, "1")}

    found = watched(
        swinging(), RungeKutta4(step=0.05), stop=10.0, interval=0.1, judged=Judged([1], figures)
    )[0].accuracy
    assert found.verdict == "inaccurate"
    assert found.step is None and found.finest < 0.01
    assert "'chance' is off by" in found.warning
    assert "do not settle it" in found.warning and "take a step" not in found.warning


def test_stiff_decay_that_is_stable_raises_no_alarm():
    """λ h = -2: RK4 follows the slow part within 1e-4, as the fast one has gone."""
    statistics, (times, states, _) = watched(
        decay(200.0), RungeKutta4(step=0.01), stop=10.0, interval=0.05
    )
    assert np.abs(states[:, 0] - np.sin(times))[20:].max() < 1e-3
    assert statistics.accuracy.verdict == "accurate"


def test_windows_are_spread_over_the_run_and_end_with_it():
    for n in (1, 3, 15, 16, 17, 1000):
        places = window_places(n, 16)
        assert places[0] == 0
        assert places[-1] == n
        assert len(places) <= 17
        gaps = np.diff(places[:-1])
        assert np.all(gaps == gaps[:1])


def test_places_do_not_depend_on_chunks():
    equations = swinging()
    kernel = compile_kernel(equations, backend="compiled")
    from vehicledyn.integrate.accuracy.windows import StepGrid

    grid = StepGrid(Method.RK4, 0.0, 0.1, 10, 100)
    rows = np.random.default_rng(1).normal(size=(101, 5))
    found = []
    for sizes in ([101], [1, 7, 50, 43], [1] * 101):
        watch = AccuracyMonitor(equations, grid, Judged.usual(equations), None)
        begin = 0
        for size in sizes:
            part = rows[begin : begin + size]
            times = 0.1 * np.arange(begin, begin + size)
            watch.take(kernel, times, part[:, :2], part[:, :0], part[:, 2:])
            begin += size
        kept = watch.places, watch.latest, watch.spares
        found.append([[place.index for place in places] for places in kept])
    assert found[0] == found[1] == found[2]
    assert found[0][0] == window_places(100, 8)[:-1] == list(range(0, 101, 16))
    assert found[0][2] == list(range(8, 101, 16))


def test_eigenvalues_and_proposed_step():
    kernel = compile_kernel(swinging(), backend="compiled")
    point = (0.0, np.array([1.0, 0.0]), np.zeros(0))
    values = eigenvalues(kernel, *point)
    assert sorted(values.imag) == pytest.approx([-20.0, 20.0], abs=1e-6)
    assert longest_step(values, Method.RK4) == pytest.approx(0.025)
    assert proposed_step(kernel, Method.RK4, point, 0.1) == pytest.approx(0.025)
    assert longest_step(np.array([-1000.0 + 0j]), Method.CHEBYSHEV + 10) == pytest.approx(0.04)
    assert longest_step(np.zeros(3, dtype=complex), Method.RK4) == np.inf


@pytest.mark.parametrize(
    ("longest", "interval", "step"),
    [(1.0, 0.01, 0.01), (0.0035, 0.01, 0.0025), (0.0011, 0.01, 0.001), (0.0009, 0.01, 0.0005)],
)
def test_steps_divide_the_interval_into_round_numbers(longest, interval, step):
    assert dividing_step(longest, interval) == pytest.approx(step)


def test_pieces_are_judged_by_the_worst():
    good, bad = Accuracy("accurate", 0.9, "a"), Accuracy("inaccurate", 0.1, "b", 0.01, 5)
    assert worst_of([None, good, bad]) == bad
    assert worst_of([None]) is None


def test_a_run_that_fails_with_half_its_step_says_so():
    found = Accuracy("inaccurate", np.inf, "'a'", failure="the loop cannot close here")
    assert "with half of it the run fails, the loop cannot close here" in found.warning
