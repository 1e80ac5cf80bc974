"""Right-hand sides of the Iltis: lanes, one case alone and the interpreter agree."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.run.rerun import prepare_run
from vehicledyn.scenario import load_scenario
from vehicledyn.solve.compiler import suitable_lanes
from vehicledyn.solve.kernel import compile_kernel
from vehicledyn.solve.lanes import compile_lanes

SCENARIOS = Path(__file__).parents[3] / "scenarios"


@pytest.fixture(scope="module", params=["iltis_ramp_steer", "iltis_slalom"])
def run(request, needs_compiler):
    loaded = load_scenario(SCENARIOS / f"{request.param}.yaml")
    return prepare_run(loaded, backend="compiled", progress=lambda what, part: None)


@pytest.mark.parametrize("lanes", [lanes for lanes in (4, 8) if lanes <= suitable_lanes()])
def test_rates_do_not_depend_on_who_computes_them(run, lanes):
    prepared, start = run
    rng = np.random.default_rng(3)
    masses = [p.unit == "kg" for p in prepared.equations.parameters]
    values = np.tile(prepared.kernel.parameters, (lanes, 1))
    values[:, masses] *= np.linspace(0.9, 1.1, lanes)[:, None]
    states = start.state + 0.02 * rng.normal(size=(lanes, start.state.size))
    engine, _ = compile_lanes(prepared.equations, prepared.kernel.key, lanes)
    unknowns = engine.spread(np.tile(start.unknowns, (lanes, 1)))
    constants = engine.prepare(engine.spread(values))
    rates, fate = engine.rates(0.7, engine.spread(states), unknowns, constants)
    assert not fate.status.any()
    interpreted = compile_kernel(prepared.equations, backend="interpreted")
    for lane in range(lanes):
        alone = prepared.kernel.with_parameters(values[lane])
        solved = alone.solve_unknowns(0.7, states[lane], start.unknowns)
        found = alone.rates(0.7, states[lane], solved)
        assert np.array_equal(rates[: found.size, lane], found)
        wanted = interpreted.with_parameters(values[lane]).rates(0.7, states[lane], solved)
        assert found == pytest.approx(wanted, rel=0.0, abs=1e-12 * np.abs(wanted).max())
