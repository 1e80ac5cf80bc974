"""Right-hand sides of the Iltis: lanes, one case alone and the interpreter agree."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.base.registry import find
from vehicledyn.codegen.toolchain.compiler import suitable_lanes
from vehicledyn.files.scenario import load_scenario
from vehicledyn.integrate.batch import Cases, make_batch, run_batch
from vehicledyn.kernel.lanes import compile_lanes
from vehicledyn.kernel.make_kernel import compile_kernel

pytestmark = pytest.mark.long

SCENARIOS = Path(__file__).parents[3] / "scenarios"


@pytest.fixture(scope="module", params=["iltis_ramp_steer", "iltis_slalom"])
def run(request, needs_compiler):
    loaded = load_scenario(SCENARIOS / f"{request.param}.yaml")
    return prepare_run(loaded, backend="compiled", progress=lambda what, part: None)


@pytest.fixture(scope="module")
def interpreted(run):
    prepared, _ = run
    return compile_kernel(prepared.equations, backend="interpreted")


@pytest.mark.parametrize("lanes", [lanes for lanes in (4, 8) if lanes <= suitable_lanes()])
def test_rates_do_not_depend_on_who_computes_them(run, interpreted, lanes):
    prepared, start = run
    rng = np.random.default_rng(3)
    values = np.tile(prepared.kernel.parameters, (lanes, 1))
    values *= rng.uniform(0.98, 1.02, values.shape)
    states = start.state + 0.02 * rng.normal(size=(lanes, start.state.size))
    engine, _ = compile_lanes(prepared.equations, prepared.kernel.key, lanes)
    unknowns = engine.spread(np.tile(start.unknowns, (lanes, 1)))
    constants = engine.prepare(engine.spread(values))
    rates, fate = engine.rates(0.7, engine.spread(states), unknowns, constants)
    assert not fate.status.any()
    for lane in range(lanes):
        alone = prepared.kernel.with_parameters(values[lane])
        solved = alone.solve_unknowns(0.7, states[lane], start.unknowns)
        found = alone.rates(0.7, states[lane], solved)
        assert np.array_equal(rates[: found.size, lane], found)
        wanted = interpreted.with_parameters(values[lane]).rates(0.7, states[lane], solved)
        assert found == pytest.approx(wanted, rel=0.0, abs=1e-12 * np.abs(wanted).max())


def test_channels_do_not_depend_on_which_are_asked_for(run):
    prepared, start = run
    kernel, batch = prepared.kernel, make_batch(prepared.kernel)
    if batch.lanes == 1:
        pytest.skip("this processor carries no lanes")
    cases = Cases(*(np.tile(a, (2, 1)) for a in (kernel.parameters, start.state, start.unknowns)))
    solver = find("solver", "rk4")(step=1e-3)

    def sampled(channels):
        span = {"start": 0.0, "stop": 0.02, "interval": 0.01}
        return run_batch(batch, solver, cases, channels=channels, **span).samples

    names = [channel.name for channel in prepared.equations.channels]
    everything = sampled(range(len(names)))
    assert np.isfinite(everything).all()
    for name in (
        "chassis.x",
        "suspension_fl.carrier_angle_rate",
        "tie_rod_rr.axial_force",
        "energy.kinetic",
        "accelerometer.lateral",
        "leaf_spring_rl.force",
        "wheel_rr.tyre.lateral_force",
    ):
        one = names.index(name)
        assert np.array_equal(sampled([one])[:, :, 0], everything[:, :, one]), name
