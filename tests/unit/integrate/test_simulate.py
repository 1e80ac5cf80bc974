"""Integration: order of every method, sampling, agreement of backends, and failures."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from solve_examples import (
    Samples,
    build,
    decay,
    double_pendulum,
    exact_slider_crank,
    forced,
    oscillator,
    slider_crank,
    starts,
    symbols,
)

import vehicledyn.integrate
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.registry import find, kinds
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.symbolic.equations import Block

pytestmark = pytest.mark.long

ADAPTIVE = [kind for kind in kinds("solver") if "step" not in find("solver", kind).model_fields]


def run(kernel, solver, *, stop, interval, start=0.0, sink=None, **settings):
    state, unknowns = starts(kernel.equations)
    sink = sink or Samples()
    statistics = simulate(
        kernel,
        find("solver", solver)(**settings),
        start=start,
        stop=stop,
        state=state,
        unknowns=unknowns,
        interval=interval,
        sink=sink,
    )
    return sink, statistics


def steps_of(solver, step):
    return {"step": step} | ({"stages": 4} if solver == "rkc" else {})


def tolerances(value):
    return {"relative_tolerance": value, "absolute_tolerance": value}


def test_catalogue():
    assert vehicledyn.integrate.__doc__
    assert {"rk4", "symplectic_euler", "dop853", "rosenbrock", "idas"} <= set(kinds("solver"))


@pytest.mark.parametrize(
    ("solver", "order", "settings"),
    [
        ("rk4", 4, {}),
        ("symplectic_euler", 1, {}),
        ("rkc", 2, {"stages": 5}),
        ("newmark", 2, {}),
        ("hht", 2, {}),
        ("generalised_alpha", 2, {}),
    ],
)
@pytest.mark.parametrize("make", [oscillator, forced, slider_crank, double_pendulum])
def test_order_of_fixed_steps(backend, solver, order, settings, make):
    """Halving the step divides the error by 2 to the order."""
    kernel = compile_kernel(make(), backend=backend)
    ends = [
        run(kernel, solver, stop=1.0, interval=1.0, step=1.0 / steps, **settings)[0].states[-1]
        for steps in (32, 64, 128, 1024)
    ]
    errors = [np.abs(end - ends[-1]).max() for end in ends[:3]]
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert slopes == pytest.approx([order, order], abs=0.35)


@pytest.mark.parametrize("stages", [2, 5, 12])
def test_stabilised_method_bears_rates_that_decay_fast(backend, stages):
    """Near 0.65 s²/h a decaying rate stays put, and a little beyond the known limit it grows.

    The stability function is P(z) = 1 - b T_s(w0) + b T_s(w0 + w1 z).
    """
    w0 = 1.0 + 2.0 / 13.0 / stages**2
    polynomial = np.polynomial.Chebyshev.basis(stages)
    slope, bend = polynomial.deriv()(w0), polynomial.deriv(2)(w0)
    z = np.linspace(0.0, 0.8 * stages**2, 20_000)
    growth = 1.0 + bend / slope**2 * (polynomial(w0 - slope / bend * z) - polynomial(w0))
    limit = z[np.flatnonzero(np.abs(growth) > 1.0 + 1e-9)[0]]
    assert limit == pytest.approx(2.0 / 3.0 * (stages**2 - 1) * (1 - 4.0 / 195.0), rel=0.08)
    settings = {"stop": 2.0, "interval": 0.1, "step": 0.01, "stages": stages}
    inside, outside = (
        compile_kernel(decay(part * limit / 0.01), backend=backend) for part in (0.98, 1.05)
    )
    sink, _ = run(inside, "rkc", **settings)
    assert abs(sink.states[-1, 0] - np.sin(2.0)) < 0.02
    with pytest.raises(NumericalError, match="the integration diverge"):
        run(outside, "rkc", **settings)


@pytest.mark.parametrize("solver", ADAPTIVE)
def test_adaptive_methods_follow_their_tolerance(backend, solver):
    kernel = compile_kernel(oscillator(damping=0.3), backend=backend)
    omega, decay = np.sqrt(4.0 - 0.15**2), 0.15
    errors = []
    for tolerance in (1e-4, 1e-7, 1e-10):
        sink, statistics = run(kernel, solver, stop=3.0, interval=0.1, **tolerances(tolerance))
        t = sink.times
        exact = np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
        errors.append(np.abs(sink.states[:, 0] - exact).max())
        assert errors[-1] < 500 * tolerance
        assert statistics.steps > 0
        assert statistics.evaluations > statistics.steps
    assert errors[0] > 30 * errors[1] > 900 * errors[2]


@pytest.mark.parametrize(
    ("solver", "order", "band"),
    [
        ("dop853", 8, 0.3),
        ("rk45", 5, 0.3),
        ("tsit5", 5, 0.3),
        ("rk23", 3, 0.3),
        ("rosenbrock", 5, 0.3),
        # Of variable order up to five, changed along the way: only the trend is sure.
        ("cvodes", 5, 1.0),
        ("idas", 5, 1.0),
    ],
)
def test_order_of_adaptive_methods(solver, order, band):
    """The error falls with the number of steps to the power of the order."""
    kernel = compile_kernel(oscillator(), backend="auto")
    exact = np.array([np.cos(80.0), -2.0 * np.sin(80.0)])
    work = []
    finest = 11.0 if order > 3 else 8.0
    for tolerance in 10.0 ** -np.arange(finest - 6.0, finest):
        sink, statistics = run(kernel, solver, stop=40.0, interval=40.0, **tolerances(tolerance))
        work.append((statistics.steps, np.abs(sink.states[-1] - exact).max()))
    steps, errors = np.log(np.array(work)).T
    assert -np.polyfit(steps, errors, 1)[0] == pytest.approx(order, abs=band)


@pytest.mark.parametrize("solver", ADAPTIVE)
def test_sampling_is_dense(solver):
    """Samples many a step, few a step and less than one a step lie on the same motion."""
    kernel = compile_kernel(oscillator(), backend="auto")
    for interval in (0.0037, 0.11, 1.7):
        sink, statistics = run(kernel, solver, stop=5.1, interval=interval, **tolerances(1e-8))
        assert len(sink.times) == 1 + int(5.1 / interval + 1e-9)
        assert sink.states[:, 0] == pytest.approx(np.cos(2.0 * sink.times), abs=5e-6)
        if interval < 0.01 and solver in ("dop853", "rk45"):
            assert statistics.steps < 0.5 * len(sink.times)


@pytest.mark.parametrize("solver", [kind for kind in ADAPTIVE if kind != "cvodes"])
def test_adaptive_methods_close_the_loops(backend, solver):
    kernel = compile_kernel(slider_crank(), backend=backend)
    sink, statistics = run(kernel, solver, stop=2.0, interval=0.05, **tolerances(1e-9))
    exact = [exact_slider_crank(angle) for angle in sink.states[:, 0]]
    assert sink.unknowns == pytest.approx(np.array(exact), abs=1e-13)
    assert sink.outputs[:, 0] == pytest.approx(sink.outputs[0, 0], rel=1e-6)
    assert statistics.largest_residual < 1e-14


def test_cvodes_refuses_loops():
    kernel = compile_kernel(slider_crank(), backend="interpreted")
    with pytest.raises(InputError, match="'rosenbrock' or 'idas'"):
        run(kernel, "cvodes", stop=1.0, interval=0.1, **tolerances(1e-6))


@pytest.mark.parametrize("make", [oscillator, slider_crank, double_pendulum])
def test_backends_agree_after_a_long_run(needs_compiler, make):
    results = [
        run(compile_kernel(make(), backend=b), "rk4", stop=5.0, interval=0.05, step=2e-3)[0]
        for b in ("compiled", "interpreted")
    ]
    for part in ("states", "unknowns", "outputs"):
        one, two = (getattr(result, part) for result in results)
        assert np.abs(one - two).max(initial=0.0) <= 1e-9 * np.abs(one).max(initial=0.0)


def test_loops_and_energy_in_fixed_steps(backend):
    kernel = compile_kernel(slider_crank(), backend=backend)
    sink, statistics = run(kernel, "rk4", stop=2.0, interval=0.02, step=1e-3)
    exact = [exact_slider_crank(angle) for angle in sink.states[:, 0]]
    assert sink.unknowns == pytest.approx(np.array(exact), abs=1e-14)
    assert sink.outputs[:, 0] == pytest.approx(sink.outputs[0, 0], rel=1e-10)
    assert statistics.steps == 2000
    assert statistics.evaluations == 8000
    assert 8000 <= statistics.newton_iterations < 16000
    assert statistics.largest_residual < 1e-14
    assert statistics.smallest_step == statistics.largest_step == 1e-3


@pytest.mark.parametrize("chunk", [1, 3, 7, 1000])
def test_chunks_change_nothing(backend, monkeypatch, chunk):
    kernel = compile_kernel(double_pendulum(), backend=backend)
    whole, _ = run(kernel, "rk4", stop=0.6, interval=0.02, step=5e-3)
    monkeypatch.setattr("vehicledyn.integrate.fixed_step._FIRST_CHUNK", chunk)
    monkeypatch.setattr("vehicledyn.integrate.fixed_step._GROWTH", 1)
    monkeypatch.setattr("vehicledyn.integrate.fixed_step._CHUNK_SECONDS", 1e9)
    parts, _ = run(kernel, "rk4", stop=0.6, interval=0.02, step=5e-3)
    assert np.array_equal(whole.states, parts.states)
    assert np.array_equal(whole.outputs, parts.outputs)
    assert np.array_equal(whole.times, parts.times)


@pytest.mark.parametrize("solver", kinds("solver"))
def test_samples_come_at_exact_times(solver):
    kernel = compile_kernel(oscillator(), backend="interpreted")
    settings = steps_of(solver, 0.05) if solver not in ADAPTIVE else tolerances(1e-6)
    sink, statistics = run(kernel, solver, start=1.0, stop=8.3, interval=0.1, **settings)
    assert np.array_equal(sink.times, 1.0 + 0.1 * np.arange(74))
    assert statistics.samples == 74
    assert sink.states[0] == pytest.approx([1.0, 0.0])


@pytest.mark.parametrize("solver", kinds("solver"))
def test_no_time_gives_one_sample(solver):
    kernel = compile_kernel(oscillator(), backend="interpreted")
    settings = steps_of(solver, 0.1) if solver not in ADAPTIVE else tolerances(1e-6)
    sink, _ = run(kernel, solver, stop=0.0, interval=0.1, **settings)
    assert sink.times.tolist() == [0.0]


def test_step_must_divide_the_interval():
    kernel = compile_kernel(oscillator(), backend="interpreted")
    with pytest.raises(InputError, match=r"nearest step that does is 0\.00333333333 s"):
        run(kernel, "rk4", stop=1.0, interval=0.01, step=0.003)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"interval": 0.0}, "must be positive"),
        ({"stop": -1.0}, "before its start"),
        ({"stop": float("nan")}, "finite time"),
    ],
)
def test_times_that_make_no_sense(change, message):
    kernel = compile_kernel(oscillator(), backend="interpreted")
    with pytest.raises(InputError, match=message):
        run(kernel, "rk4", **({"stop": 1.0, "interval": 0.1, "step": 0.1} | change))


def blow_up():
    """x = 1/(1 - t): infinite at t = 1."""
    t, x, y = symbols("t", "growth", "bystander")
    return build(
        "blow_up",
        time=t,
        states=[(y, 0.0), (x, 1.0)],
        rates=[-y, x * x],
        parameters=[],
        outputs=[("growth", x)],
    )


@pytest.mark.parametrize("solver", kinds("solver"))
def test_blow_up_names_time_and_state(backend, solver):
    kernel = compile_kernel(blow_up(), backend=backend)
    settings = steps_of(solver, 1e-3) if solver not in ADAPTIVE else tolerances(1e-6)
    sink = Samples()
    with pytest.raises(NumericalError, match="growth") as caught:
        run(kernel, solver, stop=2.0, interval=0.05, sink=sink, **settings)
    assert "t = " in str(caught.value)
    good = sink.times < 0.9
    assert good.sum() == 18
    assert np.isfinite(sink.states).all()
    assert sink.states[good, 1] == pytest.approx(1.0 / (1.0 - sink.times[good]), rel=0.03)


def stuck_crank():
    """Crank of 1 m turned at 1 rad/s with a rod of 0.5 m: cannot turn beyond 30 degrees."""
    t, angle, rod_angle, slider = symbols("t", "crank.angle", "rod.angle", "slider.position")
    return build(
        "stuck_crank",
        time=t,
        states=[(angle, 0.3)],
        rates=[ca.SX(1.0)],
        parameters=[],
        unknowns=[(rod_angle, 0.6), (slider, 1.3)],
        residuals=[
            ca.cos(angle) + 0.5 * ca.cos(rod_angle) - slider,
            ca.sin(angle) - 0.5 * ca.sin(rod_angle),
        ],
        outputs=[("slider.position", slider)],
        blocks=(Block("crank loop", 0, 2, 1e-10),),
    )


@pytest.mark.parametrize("solver", ["rk4", "symplectic_euler", "dop853", "rosenbrock"])
def test_loop_that_cannot_close_is_named(backend, solver):
    kernel = compile_kernel(stuck_crank(), backend=backend)
    settings = steps_of(solver, 1e-3) if solver not in ADAPTIVE else tolerances(1e-6)
    sink, message = Samples(), "crank loop" if solver != "rosenbrock" else "integration stopped"
    with pytest.raises(NumericalError, match=message) as caught:
        run(kernel, solver, stop=5.0, interval=0.01, sink=sink, **settings)
    assert "t = " in str(caught.value)
    assert 15 <= len(sink.times) <= 23
    assert np.sin(sink.states[-1, 0]) == pytest.approx(0.5, abs=0.08)


def test_start_that_cannot_close_names_block_time_and_residual(backend):
    kernel = compile_kernel(stuck_crank(), backend=backend)
    with pytest.raises(NumericalError, match=r"block 'crank loop' at t = 0\.25 s: .*residual .* m"):
        kernel.solve_unknowns(0.25, [1.2], [0.15, 2.9])


def test_parameters(backend):
    kernel = compile_kernel(oscillator(), backend=backend)
    other = kernel.with_parameters([9.0, 0.0, 3.0])
    assert other.rates(0.0, [1.0, 0.0], []) == pytest.approx([0.0, -3.0])
    assert kernel.rates(0.0, [1.0, 0.0], []) == pytest.approx([0.0, -4.0])
    assert kernel.parameters.tolist() == [4.0, 0.0, 1.0]
    for values, message in (([1.0], "3 parameters"), ([1.0, np.nan, 1.0], "'damping'")):
        with pytest.raises(InputError, match=message):
            kernel.set_parameters(values)
    with pytest.raises(InputError, match="2 states"):
        kernel.rates(0.0, [1.0], [])


def test_equations_with_nothing_in_them(backend):
    """A mechanism without states is legal: only its loop is solved."""
    t, z = symbols("t", "z")
    equations = build(
        "cam",
        time=t,
        states=[],
        rates=[],
        parameters=[],
        unknowns=[(z, 1.0)],
        residuals=[z**3 - 1.0 - ca.sin(t)],
        outputs=[("z", z)],
        blocks=(Block("cam", 0, 1, 1e-12),),
    )
    sink, _ = run(compile_kernel(equations, backend=backend), "rk4", stop=1, interval=0.1, step=0.1)
    assert sink.outputs[:, 0] == pytest.approx(np.cbrt(1.0 + np.sin(sink.times)), rel=1e-13)


LONG_RUN = """
import sys, time
sys.path.insert(0, sys.argv[1])
from solve_examples import double_pendulum, starts
import vehicledyn.integrate
from vehicledyn.base.registry import find
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.integrate.simulate import simulate

count = 0
def sink(times, *parts):
    global count
    count += len(times)
    print("sampled", flush=True)

kernel = compile_kernel(double_pendulum(), backend=sys.argv[2])
state, unknowns = starts(kernel.equations)
solver = find("solver", "rk4")(step=1e-3 if sys.argv[2] == "interpreted" else 1e-6)
try:
    simulate(kernel, solver, start=0.0, stop=1e6, state=state, unknowns=unknowns,
             interval=1e-3, sink=sink)
except KeyboardInterrupt:
    print("interrupted", count, flush=True)
"""


def test_interrupt_is_honoured_quickly(backend):
    command = [sys.executable, "-c", LONG_RUN, str(Path(__file__).parents[1]), backend]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    for _ in range(3):
        assert process.stdout.readline().strip() == "sampled"
    process.send_signal(signal.SIGINT)
    sent = time.perf_counter()
    while (line := process.stdout.readline().strip()) == "sampled":
        pass
    waited = time.perf_counter() - sent
    out, err = process.communicate(timeout=30)
    assert line.startswith("interrupted"), (line, out, err)
    assert waited < 0.5
    assert int(line.split()[1]) >= 3


def test_reading_settings_loads_nothing_heavy():
    code = (
        "import sys, vehicledyn.integrate; "
        "heavy = {'casadi', 'numpy', 'scipy', 'matplotlib', 'pandas', 'h5py'} & set(sys.modules); "
        "sys.exit(', '.join(sorted(heavy)) or 0)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
