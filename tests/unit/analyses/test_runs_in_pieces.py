"""A run that changes its partition is judged as a whole, and counts the steps of all its pieces."""

import pytest

from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy.monitor import AccuracyMonitor
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.methods.rk4 import RungeKutta4
from vehicledyn.integrate.methods.symplectic_euler import SymplecticEuler
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, BallCut, Body, Joint, ParameterTable, System, derive

STOP = 0.6


def bar(name, parent, at, angle, length, rate=0.0, role="auto"):
    return Body(
        name,
        parent,
        (*at, 0.0),
        (Joint("R3", f"{name}.angle", angle, role, rate),),
        mass=1.0,
        com=(0.5 * length, 0.0, 0.0),
        inertia=(0.02, 0.02, 0.02),
    )


def double_loop():
    """Two four-bars one on the other, the second on the coupler of the first."""
    bodies = (
        bar("crank", GROUND, (0.0, 0.0), 1.2, 0.3, 9.0, "independent"),
        bar("coupler", "crank", (0.3, 0.0), -0.9, 0.9),
        bar("rocker", GROUND, (0.8, 0.0), 1.3, 0.7),
        bar("lever", "coupler", (0.5, 0.1), 0.9, 0.5),
        bar("stay", GROUND, (-0.3, 0.7), 0.3, 1.2),
    )
    cuts = (
        BallCut("first", "coupler", (0.9, 0.0, 0.0), "rocker", (0.7, 0.0, 0.0)),
        BallCut("second", "lever", (0.5, 0.0, 0.0), "stay", (1.2, 0.0, 0.0)),
    )
    return System("double loop", ParameterTable(), bodies, cuts, gravity=(0.0, -9.81, 0.0))


@pytest.fixture(scope="module")
def known():
    system = double_loop()
    equations = derive(system)
    return system, compile_kernel(equations)


def run(known, solver, judged=None, interval=0.01):
    system, kernel = known
    changes, times = [], []
    statistics = simulate_monitored(
        system,
        kernel,
        solver,
        start=0.0,
        stop=STOP,
        state=[s.start for s in kernel.equations.states],
        unknowns=[u.start for u in kernel.equations.unknowns],
        interval=interval,
        sink=lambda t, x, z, y: times.extend(t),
        progress=lambda what, part: None,
        happened=lambda name, time: changes.append((name, time)),
        judged=judged,
    )
    return statistics, changes, times


def test_the_steps_of_all_pieces_are_counted(known, needs_compiler):
    statistics, changes, times = run(known, RungeKutta4(step=5e-4))
    assert len(changes) >= 2 and changes[-1][1] < STOP
    assert statistics.samples == len(times) == 61
    assert 1200 <= statistics.steps < 1800
    assert statistics.evaluations >= 4 * statistics.steps
    assert statistics.smallest_step == pytest.approx(5e-4)
    assert statistics.largest_step == pytest.approx(5e-4)


def test_windows_lie_in_all_pieces(known, needs_compiler, monkeypatch):
    seen = []
    conclude = AccuracyMonitor.conclude

    def told(self, **how):
        seen.extend(self.places)
        return conclude(self, **how)

    monkeypatch.setattr(AccuracyMonitor, "conclude", told)
    statistics, changes, _ = run(known, RungeKutta4(step=5e-4))
    assert statistics.accuracy.verdict == "accurate"
    assert seen[0].time == 0.0 and seen[-1].time > changes[-1][1]
    assert len({id(place.kernel) for place in seen}) >= 2


def test_what_goes_wrong_in_the_first_piece_is_found(known, needs_compiler):
    """The figure is made of what happens before the partition changes for the first time."""
    _, changes, _ = run(known, RungeKutta4(step=5e-4))
    first = changes[0][1]
    names = [channel.name for channel in known[1].equations.channels]
    channels = [names.index("stay.angle_rate")]

    def early(times, values):
        return {"rate_before_it": (float(values[times < first][-1, 0]), "rad/s")}

    coarse, changed, _ = run(known, SymplecticEuler(step=0.01), Judged(channels, early))
    fine, _, _ = run(known, RungeKutta4(step=5e-4), Judged(channels, early))
    assert changed
    assert (coarse.accuracy.verdict, coarse.accuracy.worst) == (
        "inaccurate",
        "'rate_before_it'",
    )
    assert fine.accuracy.verdict == "accurate"


def test_a_run_that_diverges_is_not_continued_in_another_way(known, needs_compiler, monkeypatch):
    """Divergence is reported as such, whatever piece it comes in."""
    monkeypatch.setattr("vehicledyn.integrate.accuracy.divergence._HUGE", 1.5)
    with pytest.raises(NumericalError, match=r"the integration diverges with a step of 0\.5 ms"):
        run(known, RungeKutta4(step=5e-4))
