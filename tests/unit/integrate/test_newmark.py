"""Newmark's family: published steps digit by digit, spectral radius, order, energy and failure."""

import math

import casadi as ca
import numpy as np
import pytest
from event_examples import Run, bouncing_ball
from solve_examples import Samples, build, decay, oscillator, slider_crank, starts, symbols

from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import find
from vehicledyn.integrate.newmark.family import run_newmark
from vehicledyn.integrate.newmark.weights import Weights
from vehicledyn.integrate.simulate import make_task, simulate
from vehicledyn.kernel.make_kernel import compile_kernel

OMEGA = 2.0 * math.pi
STEPS = [
    ("newmark 1/4 1/2", Weights.newmark(0.25, 0.5), 0.0, -0.372681730248661, 5.83053978401319),
    ("newmark 1/4 1/2", Weights.newmark(0.25, 0.5), 0.05, -0.0270129096756113, 0.325819676323003),
    ("newmark damped", Weights.newmark(0.3025, 0.6), 0.0, -0.0744644536557388, 0.948137096907749),
    ("linear", Weights.newmark(1.0 / 6.0, 0.5), 0.0, 0.549028422502015, 5.16440312217251),
    ("hht -0.05", Weights.hht(0.95 / 1.05), 0.0, -0.539661303868654, 4.75531210792286),
    ("hht -1/3", Weights.hht(0.5), 0.05, -0.051105900204811, 0.0791487965402049),
]
"""Method, damping ratio, position and speed after 100 steps of 0.1 s (period 1 s)."""


def march(kernel, weights, step, count, state):
    samples = Samples()
    unknowns = starts(kernel.equations)[1]
    span = {"start": 0.0, "stop": step * count, "interval": step}
    task = make_task(kernel, state=state, unknowns=unknowns, sink=samples, **span)
    return samples, run_newmark(task, "", weights, step)


@pytest.mark.parametrize(("name", "weights", "damping", "position", "speed"), STEPS)
def test_steps_of_an_oscillator(name, weights, damping, position, speed):
    kernel = compile_kernel(oscillator(OMEGA**2, 2.0 * damping * OMEGA), backend="interpreted")
    samples, _ = march(kernel, weights, 0.1, 100, [1.0, 0.0])
    assert samples.states[-1] == pytest.approx([position, speed], abs=1e-12), name


def settled_step(weights, h, x, v, a):
    """Return a step of x'' = -20 x - 60 x³ - 0.3 x', Newton's method to the last digit."""
    w, new = weights, a
    for _ in range(40):
        place = x + h * v + h * h * ((0.5 - w.beta) * a + w.beta * new)
        rate = v + h * ((1.0 - w.gamma) * a + w.gamma * new)
        force = -20.0 * place - 60.0 * place**3 - 0.3 * rate
        before = -20.0 * x - 60.0 * x**3 - 0.3 * v
        missed = (1.0 - w.alpha_m) * new + w.alpha_m * a
        missed -= (1.0 - w.alpha_f) * force + w.alpha_f * before
        slope = (20.0 + 180.0 * place**2) * w.beta * h * h + 0.3 * w.gamma * h
        new -= missed / (1.0 - w.alpha_m + (1.0 - w.alpha_f) * slope)
    return place, rate, new


@pytest.mark.parametrize(
    "weights",
    [Weights.newmark(1.0 / 6.0, 0.5), Weights.newmark(0.36, 0.55), Weights.hht(0.77),
     Weights.generalised_alpha(0.35)],
)  # fmt: skip
def test_steps_of_a_nonlinear_oscillator(weights):
    """Digit by digit; forces at the ends of a step are averaged, not states."""
    x, v = symbols("x", "v")
    equations = build(
        "stiffening", time=ca.SX.sym("t"), states=[(x, 1.0), (v, 0.5)], parameters=[],
        rates=[v, -20 * x - 60 * x**3 - 0.3 * v], outputs=[("x", x)], positions=(0,),
        velocities=(1,),
    )  # fmt: skip
    samples, _ = march(compile_kernel(equations, backend="interpreted"), weights, 0.1, 40, [1, 0.5])
    own = (1.0, 0.5, -80.15)
    for state in samples.states[1:]:
        own = settled_step(weights, 0.1, *own)
        assert state == pytest.approx(own[:2], abs=1e-10)


@pytest.mark.parametrize("radius", [0.5, 0.8, 1.0])
@pytest.mark.parametrize("make", [Weights.hht, Weights.generalised_alpha])
def test_spectral_radius_at_infinity(make, radius):
    """A step multiplies an oscillation far too fast for it by the radius."""
    w, n = make(radius), 1e10
    left = np.array([[1.0, 0.0, -w.beta], [0.0, 1.0, -w.gamma]])
    left = np.vstack([left, [(1 - w.alpha_f) * n, 0.0, 1 - w.alpha_m]])
    right = np.array([[1.0, 1.0, 0.5 - w.beta], [0.0, 1.0, 1.0 - w.gamma]])
    right = np.vstack([right, [-w.alpha_f * n, 0.0, -w.alpha_m]])
    growth = np.abs(np.linalg.eigvals(np.linalg.solve(left, right))).max()
    assert growth == pytest.approx(radius, abs=1e-3)


@pytest.mark.parametrize("kind", ["hht", "generalised_alpha"])
def test_fast_motion_dies_out_at_the_spectral_radius(kind):
    kernel = compile_kernel(oscillator(1e14), backend="interpreted")
    solver = find("solver", kind)(step=0.1, spectral_radius=0.6)
    samples = Samples()
    times = {"start": 0.0, "stop": 10.0, "interval": 0.1}
    simulate(kernel, solver, state=[1.0, 0.0], unknowns=[], sink=samples, **times)
    size = np.abs(samples.states[:, 0])
    assert (size[100] / size[60]) ** (1 / 40) == pytest.approx(0.6, abs=0.05)


@pytest.mark.parametrize("weights", [Weights.newmark(0.25, 0.5), Weights.generalised_alpha(0.8)])
@pytest.mark.parametrize("make", [slider_crank, lambda: decay(3.0), oscillator])
def test_order_two(weights, make):
    """Slopes of the error against a far finer step, with loops and first-order states too."""
    kernel = compile_kernel(make(), backend="interpreted")
    state = starts(kernel.equations)[0]
    ends = [march(kernel, weights, 1.0 / n, n, state)[0].states[-1] for n in (40, 80, 640)]
    coarse, fine = (np.linalg.norm(end - ends[-1]) for end in ends[:2])
    # Against a finer run instead of the exact motion the slope reads this much more.
    bias = math.log2((1 - (40 / 640) ** 2) / (1 - (80 / 640) ** 2))
    assert math.log2(coarse / fine) - bias == pytest.approx(2.0, abs=0.05)


def test_undamped_newmark_keeps_the_energy():
    kernel = compile_kernel(oscillator(), backend="interpreted")
    samples, _ = march(kernel, Weights.newmark(0.25, 0.5), 0.2, 500, [1.0, 0.0])
    assert samples.outputs[:, 0] == pytest.approx(2.0, rel=1e-9)


def test_one_jacobian_serves_a_linear_run():
    kernel = compile_kernel(oscillator(), backend="interpreted")
    calls = []
    derivatives = find_derivatives(kernel, calls)
    march(kernel, Weights.hht(0.8), 0.1, 200, [1.0, 0.0])
    assert derivatives is not None
    assert len(calls) == 1


def find_derivatives(kernel, calls):
    """Put derivatives into a kernel that note when they are evaluated."""
    from vehicledyn.kernel.derivatives import Derivatives

    derivatives = Derivatives(kernel.equations)
    evaluate = derivatives.total

    def total(*arguments):
        calls.append(arguments[0])
        return evaluate(*arguments)

    derivatives.total = total
    kernel.made["total derivatives"] = derivatives
    return derivatives


def test_a_step_that_cannot_be_taken_names_time_state_and_remedy():
    """Beyond t = 0.5 s the rate has no real value, and all samples before are delivered."""
    t, x, v = symbols("t", "x", "v")
    rates = [v, ca.sqrt(0.5 - t) - x]
    states = [(x, 1.0), (v, 0.0)]
    more = {"positions": (0,), "velocities": (1,)}
    equations = build(
        "ends", time=t, states=states, rates=rates, parameters=[], outputs=[("x", x)], **more
    )
    kernel, samples = compile_kernel(equations, backend="interpreted"), Samples()
    solver = find("solver", "newmark")(step=0.1)
    times = {"start": 0.0, "stop": 1.0, "interval": 0.1}
    with pytest.raises(NumericalError, match=r"t = 0\.\d+ s: Newton.*state 'v'.*shorten the step"):
        simulate(kernel, solver, state=[1.0, 0.0], unknowns=[], sink=samples, **times)
    assert len(samples.times) >= 5


def test_impacts_are_found_inside_steps():
    kernel = compile_kernel(bouncing_ball(), backend="interpreted")
    run = Run(kernel, "generalised_alpha", start=0.0, stop=3.0, interval=0.05, step=0.05).go()
    fine = Run(kernel, "rk4", start=0.0, stop=3.0, interval=0.05, step=0.001).go()
    assert run.times == pytest.approx(fine.times, abs=1e-8)
