"""The chain of four-bar linkages in YAML, through its singular configurations, in few steps."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.prepare import prepare, start_point
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.files.scenario import load_scenario

SCENARIO = Path(__file__).parents[2] / "scenarios" / "systems" / "four_bar_chain.yaml"
LINKAGES = 20
# What is asked of B0, the top of the first upright, at all samples of the 4 s [m].
POSITION = 1e-4
# Right-hand sides in all: four in each of the 200 steps of 4 s, and twelve in a step of a passage.
EVALUATIONS = 1800

pytestmark = pytest.mark.validation


def pendulum(times):
    """Angle of the uprights, which stay parallel: one pendulum of inertia I and moment K."""
    inertia = (LINKAGES + 1) / 3 + LINKAGES
    moment = 9.81 * ((LINKAGES + 1) / 2 + LINKAGES)

    def rates(time, x):
        return [x[1], -moment / inertia * np.cos(x[0])]

    start = [0.5 * np.pi, -1.0]
    found = solve_ivp(
        rates, (0.0, times[-1]), start, "DOP853", t_eval=times, rtol=1e-12, atol=1e-12
    )
    return found.y[0]


# Samples of half a second leave loops to be passed before the first one.
@pytest.mark.parametrize("interval", [0.02, 0.5])
def test_chain_in_steps_of_20_ms(interval):
    loaded = load_scenario(SCENARIO)
    s, samples = loaded.scenario, []
    prepared = prepare(loaded, backend="auto", progress=lambda *_: None)
    start = start_point(prepared, 0.0, s.start)
    statistics = simulate_monitored(
        prepared.subject.system,
        prepared.kernel,
        s.solver,
        start=0.0,
        stop=s.duration,
        state=start.state,
        unknowns=start.unknowns,
        interval=interval,
        sink=lambda *parts: samples.append(parts),
        progress=lambda *_: None,
        happened=lambda *_: None,
        watch=lambda: prepared.watch,
    )
    times = np.concatenate([part[0] for part in samples])
    outputs = np.concatenate([part[3] for part in samples])
    names = [channel.name for channel in prepared.equations.channels]
    x, z = (outputs[:, names.index(name)] for name in ("b0.x", "b0.z"))
    angle = pendulum(times)
    assert times == pytest.approx(np.arange(0.0, 4.0 + 0.5 * interval, interval))
    assert np.hypot(x - np.cos(angle), z - np.sin(angle)).max() < POSITION
    assert outputs[:, names.index("constraints.position_error")].max() < 1e-12
    if interval == s.output.interval:  # the budget is that of the shipped output
        assert statistics.evaluations <= EVALUATIONS
