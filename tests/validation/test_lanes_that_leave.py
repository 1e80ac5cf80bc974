"""Cases side by side whose loops come near to singular configurations leave their lanes alone."""

from functools import partial

import numpy as np
import pytest
from nets import net
from test_closed_forms import start_values
from test_partitions import L, R, rk4, slider_crank

from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.codegen.toolchain.compiler import CompilationError, find_compiler, suitable_lanes
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.integrate.single_case import SingleCase
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive

pytestmark = pytest.mark.validation

ANGLE, SPAN = 1.1, {"start": 0.0, "stop": 1.0, "interval": 0.01}
TURNING = np.linspace(0.2, 4.0, 11)  # rad/s; the fast ones pass dead centres


def slider_rate(turning):
    s, c = np.sin(ANGLE), np.cos(ANGLE)
    return (-R * s - R**2 * s * c / np.sqrt(L**2 - R**2 * s**2)) * turning


def swept(role, lanes, *, watched):
    """Return times, samples of crank angle and slider place, and ends of all cases."""
    system = slider_crank(ANGLE, role)
    equations = derive(system)
    state, unknowns = start_values(equations)
    names = [s.name for s in equations.states]
    states = np.tile(state, (len(TURNING), 1))
    if role == "dependent":
        states[:, names.index("slider.x_rate")] = slider_rate(TURNING)
    else:
        states[:, names.index("crank.angle_rate")] = TURNING
    cases = Cases(
        np.tile([p.value for p in equations.parameters], (len(TURNING), 1)),
        states,
        np.tile(unknowns, (len(TURNING), 1)),
    )
    channels = [c.name for c in equations.channels]
    runner = partial(
        simulate_monitored,
        system,
        progress=lambda what, part: None,
        happened=lambda name, time: None,
    )
    return run_batch(
        make_batch(compile_kernel(equations), lanes=lanes),
        rk4(5e-4),
        cases,
        channels=[channels.index("crank.angle"), channels.index("slider.x")],
        **({"runner": runner} if watched else {}),
        **SPAN,
    )


def has_lanes():
    try:
        find_compiler()
    except CompilationError:
        return False
    return suitable_lanes() >= 4


@pytest.mark.skipif(not has_lanes(), reason="lanes need a compiler and wide registers")
def test_cases_that_pass_a_dead_centre_leave_their_lanes(monkeypatch):
    left, run = [], SingleCase.run

    def counted(alone, cases, number, room):
        left.append(number)
        return run(alone, cases, number, room)

    monkeypatch.setattr(SingleCase, "run", counted)
    found = swept("dependent", 4, watched=True)
    assert 2 <= len(left) <= 9
    assert not any(end.failed for end in found.ends)
    good = swept("independent", 1, watched=True)
    assert np.ptp(good.samples[-1, :, 0]) > np.pi / 2
    assert found.samples == pytest.approx(good.samples, abs=1e-7)
    one = swept("dependent", 1, watched=True)
    assert np.array_equal(found.samples, one.samples)
    unwatched = swept("dependent", 4, watched=False)
    assert any(end.failed for end in unwatched.ends)


def swinging(system, equations, count):
    """Cases of a net that starts with random rates, from none to fast ones."""
    state = np.array([s.start for s in equations.states])
    states, rng = np.tile(state, (count, 1)), np.random.default_rng(1)
    rates = list(equations.velocities)
    for k in range(count):
        states[k, rates] = 0.25 * k * rng.normal(size=len(rates))
    unknowns = np.tile([u.start for u in equations.unknowns], (count, 1))
    return Cases(np.zeros((count, 0)), states, unknowns)


@pytest.mark.skipif(not has_lanes(), reason="lanes need a compiler and wide registers")
@pytest.mark.parametrize("rows", [2, 3])
def test_nets_in_lanes_change_their_partition_as_single_runs_do(rows, monkeypatch):
    """Every case whose partition changes leaves its lane, and all are the same to the bit."""
    left, run = [], SingleCase.run

    def counted(alone, cases, number, room):
        left.append(number)
        return run(alone, cases, number, room)

    monkeypatch.setattr(SingleCase, "run", counted)
    system = net(rows, 2, pinned=((0, 0),))
    equations = derive(system)
    kernel, span = compile_kernel(equations), {"start": 0.0, "stop": 0.2, "interval": 0.01}
    cases = swinging(system, equations, 9)
    silent = {"progress": lambda *_: None}
    names = [c.name for c in equations.channels]
    channels = [names.index(name) for name in ("p1_0.x", "p1_1.z", "energy.kinetic")]
    found = run_batch(
        make_batch(kernel, lanes=4),
        rk4(1e-3),
        cases,
        channels=channels,
        runner=partial(simulate_monitored, system, happened=lambda *_: None, **silent),
        **span,
    )
    changed = set()
    for k in range(len(cases)):
        rows_of_case = []
        simulate_monitored(
            system,
            kernel,
            rk4(1e-3),
            state=cases.states[k],
            unknowns=cases.unknowns[k],
            sink=lambda t, x, z, y, kept=rows_of_case: kept.append(y[:, channels]),
            happened=lambda name, time, k=k: changed.add(k),
            **silent,
            **span,
        )
        assert np.array_equal(found.samples[k], np.vstack(rows_of_case))
    assert changed
    assert changed <= set(left)
    assert len(left) < len(cases)
