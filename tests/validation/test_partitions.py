"""Runs that outlive their partition: singular configurations passed, coordinates exchanged."""

from functools import partial

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from test_closed_forms import REFERENCE, four_bars, start_values
from test_rolling import GRAVITY, sloping_skate

from vehicledyn.analyses.preparation.rate_determinacy import rate_monitor_of
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.registry import find
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import (
    GROUND,
    BallCut,
    Body,
    ConstantRate,
    Joint,
    ParameterTable,
    System,
    derive,
)
from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor

pytestmark = pytest.mark.validation

# What is asked of the program, through five turns and ten singular configurations.
POSITION = 1e-7


def rk4(step):
    return find("solver", "rk4")(step=step)


def dop853(tolerance):
    return find("solver", "dop853")(relative_tolerance=tolerance, absolute_tolerance=tolerance)


class Motion:
    """Samples of a run by name, and when the partition has changed."""

    def __init__(self, system, solver, duration, interval, **changes):
        equations = derive(system)
        state, unknowns = start_values(equations)
        for k, s in enumerate(equations.states):
            state[k] = changes.get(s.name, state[k])
        self.changes, found = [], []
        self.statistics = simulate_monitored(
            system,
            compile_kernel(equations, backend="interpreted"),
            solver,
            start=0.0,
            stop=duration,
            state=state,
            unknowns=unknowns,
            interval=interval,
            sink=lambda *parts: found.append(parts),
            progress=lambda what, part: None,
            happened=lambda name, time: self.changes.append((name, time)),
        )
        self.time = np.concatenate([part[0] for part in found])
        self.states = np.concatenate([part[1] for part in found])
        self.names = [s.name for s in equations.states]
        outputs = np.concatenate([part[3] for part in found])
        names = [c.name for c in equations.channels]
        self.channel = dict(zip(names, outputs.T, strict=True))
        assert self.time == pytest.approx(np.arange(len(self.time)) * interval, abs=1e-12)
        assert self.time[-1] == pytest.approx(duration)


@pytest.mark.parametrize(
    ("count", "solver"),
    [
        (1, partial(rk4, 1e-3)),
        (2, partial(rk4, 1e-3)),
        (1, partial(dop853, 1e-11)),
        (2, partial(dop853, 1e-11)),
    ],
)
def test_four_bars_pass_the_singular_configuration(count, solver):
    motion = Motion(four_bars(count), solver(), 10.0, 0.01)
    expected = REFERENCE["n_four_bar"]["ten_seconds"][count]
    angle = motion.channel["upright_0.angle"][-1]
    assert (np.cos(angle), np.sin(angle)) == pytest.approx(
        (expected["x"], expected["y"]), abs=POSITION
    )
    # All uprights stay parallel: no loop has changed to its other branch.
    last = motion.channel[f"upright_{count}.angle"]
    assert np.abs(last - motion.channel["upright_0.angle"]).max() < 1e-11
    assert motion.channel["constraints.position_error"].max() < 1e-12
    assert not motion.changes


def test_many_four_bars_pass_at_once():
    """Twenty loops are singular at the same time; the motion is that of one pendulum."""
    count = 20
    motion = Motion(four_bars(count), rk4(1e-3), 1.0, 0.01)
    inertia, pull = (count + 1) / 3 + count, 9.81 * ((count + 1) / 2 + count)

    def pendulum(time, x):
        return [x[1], -pull / inertia * np.cos(x[0])]

    exact = solve_ivp(
        pendulum, (0, 1), [np.pi / 2, -1.0], method="DOP853", rtol=1e-13, atol=1e-13
    ).y[0, -1]
    assert motion.channel[f"upright_{count}.angle"][-1] == pytest.approx(exact, abs=POSITION)


R, L, J, M = 0.3, 0.8, 0.05, 1.7


@pytest.mark.parametrize(("angle", "rate"), [(1.3, 6.0), (1.8, -8.0)])
def test_a_loop_that_first_moves_away_from_its_singular_configuration(angle, rate):
    """Its determinant grows at the start and passes zero before the first sample."""
    start = {"upright_0.angle": angle, "upright_0.angle_rate": rate}
    motion = Motion(four_bars(1), rk4(0.05), 0.5, 0.5, **start)
    inertia, pull = 2 / 3 + 1, 9.81 * 2

    def pendulum(time, x):
        return [x[1], -pull / inertia * np.cos(x[0])]

    exact = solve_ivp(pendulum, (0, 0.5), [angle, rate], method="DOP853", rtol=1e-13, atol=1e-13).y[
        0, -1
    ]
    assert motion.channel["upright_1.angle"][-1] == pytest.approx(exact, abs=POSITION)


def slider_crank(angle, role):
    """A crank that turns freely and carries a slider on; ``role`` is that of the crank's angle."""
    crank_joint = Joint("R3", "crank.angle", angle, role, 4.0)
    crank = Body("crank", GROUND, joints=(crank_joint,), mass=1.0, inertia=(J, J, J))
    lean = np.arcsin(R / L * np.sin(angle))
    rod = Body("rod", "crank", (R, 0.0, 0.0), (Joint("R3", "rod.angle", -lean - angle),))
    place = R * np.cos(angle) + L * np.cos(lean)
    free = "independent" if role == "dependent" else "auto"
    joint = Joint("T1", "slider.x", place, free)
    slider = Body("slider", GROUND, joints=(joint,), mass=M)
    cut = BallCut("pin", "rod", (L, 0.0, 0.0), "slider", (0.0, 0.0, 0.0))
    return System("slider-crank", ParameterTable(), (crank, rod, slider), (cut,), gravity=(0, 0, 0))


@pytest.mark.parametrize("solver", [partial(rk4, 5e-4), partial(dop853, 1e-11)])
def test_a_slider_crank_changes_its_coordinate_before_the_dead_centre(solver):
    """With the slider independent the crank is not determined at the dead centres."""
    angle, turning = 1.1, 4.0
    s, c = np.sin(angle), np.cos(angle)
    slope = -R * s - R**2 * s * c / np.sqrt(L**2 - R**2 * s**2)
    start = {"slider.x_rate": slope * turning}
    given = Motion(slider_crank(angle, "dependent"), solver(), 2.0, 0.01, **start)
    good = Motion(slider_crank(angle, "independent"), solver(), 2.0, 0.01)
    assert [name for name, _ in given.changes] == ["partition.changed"]
    assert not good.changes
    assert np.ptp(good.channel["crank.angle"]) > 2.0 * np.pi
    for name in ("crank.angle", "slider.x", "crank.angle_rate", "slider.x_rate"):
        assert given.channel[name] == pytest.approx(good.channel[name], abs=1e-8), name
    # States stay those of the first partition.
    assert given.names[0] == "slider.x"
    assert np.array_equal(given.states[:, 0], given.channel["slider.x"])


@pytest.mark.parametrize("interval", [0.01, 0.1])
def test_a_skate_turns_across_and_on(interval):
    """Its velocity is given by ẋ, which says nothing where the edge points across."""
    slope, turning, duration = 0.4, 1.3, 5.0
    motion = Motion(sloping_skate(slope), dop853(1e-12), duration, interval, heading_rate=turning)
    assert len(motion.changes) >= 3
    angle = turning * motion.time
    size = GRAVITY * np.sin(slope) / (2.0 * turning**2)
    assert motion.channel["x"] == pytest.approx(size * np.sin(angle) ** 2, abs=1e-8)
    assert motion.channel["y"] == pytest.approx(
        size * (angle - 0.5 * np.sin(2.0 * angle)), abs=1e-8
    )


@pytest.mark.parametrize("lanes", [1, 4])
def test_skates_in_lanes_turn_across_and_on(lanes):
    """Those that come to point across are run by themselves, the others stay in their lanes."""
    slope, duration, turning = 0.4, 2.0, np.array([0.1, 1.3, 0.4, 2.1, 0.2])
    system = sloping_skate(slope)
    kernel = compile_kernel(derive(system))
    e, by_themselves = kernel.equations, []
    state, _ = start_values(e)
    states = np.tile(state, (len(turning), 1))
    states[:, [s.name for s in e.states].index("heading_rate")] = turning
    names = [channel.name for channel in e.channels]

    def runner(kernel, solver, **span):
        by_themselves.append(span["state"])
        told = {"progress": lambda *_: None, "happened": lambda *_: None}
        return simulate_monitored(system, kernel, solver, **span, **told)

    result = run_batch(
        make_batch(kernel, lanes=lanes),
        rk4(1e-3),
        Cases(np.tile(kernel.parameters, (len(turning), 1)), states, np.zeros((len(turning), 0))),
        start=0.0,
        stop=duration,
        interval=0.02,
        channels=[names.index("x"), names.index("y")],
        runner=runner,
        rates=rate_monitor_of(e, lambda: PartitionMonitor.of(system)),
    )
    assert not any(end.failed for end in result.ends)
    # Pointing across by more than acos 0.3 is too weak: 1.3 and 2.1 rad/s get there in 2 s.
    assert np.array_equal(by_themselves, states[[1, 3]])
    angle = turning[:, None] * result.times
    size = (GRAVITY * np.sin(slope) / (2.0 * turning**2))[:, None]
    assert result.samples[:, :, 0] == pytest.approx(size * np.sin(angle) ** 2, abs=1e-8)
    expected = size * (angle - 0.5 * np.sin(2.0 * angle))
    assert result.samples[:, :, 1] == pytest.approx(expected, abs=1e-8)


def test_a_mechanism_that_locks_names_its_loop():
    """A driven arm pulls a chain of two bars tight, which cannot follow any further."""
    arm_joint = Joint("R3", "arm.angle", role="driven")
    arm = Body("arm", GROUND, joints=(arm_joint,), mass=1.0, inertia=(0.1,) * 3)
    tip, bar = (0.5, 0.0, 0.0), 0.55
    lean = np.arccos(0.35 / bar)
    solid = {"mass": 1.0, "inertia": (0.1,) * 3}
    first = Body("first", "arm", tip, (Joint("R3", "first.angle", lean),), **solid)
    second = Body(
        "second", "first", (bar, 0.0, 0.0), (Joint("R3", "second.angle", -2.0 * lean),), **solid
    )
    cut = BallCut("anchor", "second", (bar, 0.0, 0.0), GROUND, (1.2, 0.0, 0.0))
    system = System(
        "tether",
        ParameterTable(),
        (arm, first, second),
        (cut,),
        (ConstantRate("motor", "arm.angle", 1.0),),
        gravity=(0, 0, 0),
    )
    # The distance of tip and anchor is 2 · 0.55 m where this is the angle of the arm.
    tight = np.arccos((0.5**2 + 1.2**2 - 1.1**2) / (2.0 * 0.5 * 1.2))
    with pytest.raises(NumericalError, match=r"'anchor'.*singular.*'first\.angle'") as raised:
        Motion(system, rk4(1e-3), 3.0, 0.01)
    told = float(str(raised.value).split("t = ")[1].split(" ")[0])
    assert told == pytest.approx(tight, abs=0.05)
