"""Forces that jump: runs that go another way are seen, though their extremes are right."""

import numpy as np
import pytest
from solve_examples import build, symbols

from vehicledyn.integrate.accuracy.curves import curves_apart
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.methods.generalised_alpha import GeneralisedAlpha
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.methods.symplectic_euler import SymplecticEuler
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.make_kernel import compile_kernel


def flipped(size):
    """A mass of 1 kg on a force towards the place 1 mm, or on a spring where that has no size."""
    import casadi as ca

    t, x, v, force, stiffness = symbols("t", "x", "v", "force", "stiffness")
    pull = ca.if_else(x > 1e-3, -force, force) - stiffness * x
    return build(
        "flipped" if size else "swung",
        time=t,
        states=[(x, -0.03), (v, 0.1)],
        rates=[v, pull],
        parameters=[(force, size), (stiffness, 0.0 if size else 400.0)],
        outputs=[("x", x), ("v", v)],
    )


def extremes(times, values):
    """Return the only key figures: those of the place."""
    return {
        f"x.{name}": (float(f(values[:, 0])), "m")
        for name, f in (("largest", np.max), ("smallest", np.min))
    }


def run(equations, solver, figures=extremes, stop=2.0):
    found = []
    statistics = simulate(
        compile_kernel(equations, backend="compiled"),
        solver,
        start=0.0,
        stop=stop,
        state=[-0.03, 0.1],
        unknowns=[],
        interval=10e-3,
        sink=lambda t, x, z, y: found.append(y[:, 0]),
        judged=Judged([0, 1], figures),
    )
    return statistics.accuracy, np.concatenate(found)


def exact(times):
    """Return the place of the mass on the force that flips: parabolas from crossing to crossing."""
    speed = np.sqrt(0.1**2 + 20.0 * 0.031)
    quarter, begin = speed / 10.0, 0.1 / 10.0
    phase = (times + begin + quarter) % (4.0 * quarter)
    side = np.where(phase < 2.0 * quarter, -1.0, 1.0)
    return 1e-3 + side * (0.05 * speed**2 - 5.0 * (phase % (2.0 * quarter) - quarter) ** 2)


@pytest.mark.parametrize(
    "solver",
    [
        RungeKutta4(step=5e-3),
        pytest.param(SymplecticEuler(step=5e-3), marks=pytest.mark.long),
        pytest.param(GeneralisedAlpha(step=5e-3), marks=pytest.mark.long),
        pytest.param(SymplecticEuler(step=10e-3), marks=pytest.mark.long),
    ],
    ids=lambda solver: f"{solver.kind}-{solver.step}",
)
def test_a_run_behind_a_jump_that_goes_another_way_is_seen(solver, needs_compiler):
    accuracy, place = run(flipped(10.0), solver)
    assert np.abs(place - exact(np.arange(201) * 10e-3)).max() > 0.1 * np.ptp(place)
    assert accuracy.verdict == "inaccurate"


def test_the_step_to_take_follows_the_motion(needs_compiler):
    accuracy, _ = run(flipped(10.0), RungeKutta4(step=5e-3))
    accuracy, place = run(flipped(10.0), RungeKutta4(step=accuracy.step))
    assert accuracy.verdict == "accurate"
    apart = curves_apart(place[:, None], exact(np.arange(201) * 10e-3)[:, None])
    assert apart[0] < 0.1 * np.ptp(place)


def test_an_oscillation_that_is_a_little_slow_raises_no_alarm(needs_compiler):
    """Behind 31 periods it is 80 degrees late, which is 0.7 % of the time."""
    accuracy, _ = run(flipped(0.0), GeneralisedAlpha(step=10e-3, spectral_radius=1.0), stop=10.0)
    assert accuracy.verdict == "accurate"
    assert accuracy.extra_steps > 1000


def test_curves_that_come_later_are_met_and_others_are_not():
    times = np.linspace(0.0, 10.0, 1001)

    def curves(clock):
        return np.column_stack([np.sin(3.0 * clock), clock > 5.0, np.full(1001, np.nan)])

    late = curves(0.985 * times)
    assert np.all(curves_apart(curves(times), late) < 0.01)
    other = curves(times) + np.array([0.3, 0.0, 0.0])
    assert curves_apart(curves(times), other) == pytest.approx([0.3, 0.0, 0.0], abs=0.01)
    assert curves_apart(curves(times), curves(0.9 * times))[1] == 1.0
