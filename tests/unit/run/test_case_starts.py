"""Many cases start where each would start by itself."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.run.case_starts import CaseStarter
from vehicledyn.run.prepare import prepare
from vehicledyn.scenario import load_scenario
from vehicledyn.solve.batch import make_batch
from vehicledyn.solve.case_rates import CaseRates
from vehicledyn.solve.kernel import compile_kernel

SCENARIOS = Path(__file__).parents[3] / "scenarios"


@pytest.fixture(scope="module")
def prepared(needs_compiler):
    return ready(SCENARIOS / "iltis_ramp_steer.yaml")


def ready(path):
    return prepare(load_scenario(path), backend="compiled", progress=lambda what, part: None)


def varied(prepared, **factors):
    """Return parameters in which the named ones are multiplied."""
    names = [p.name for p in prepared.equations.parameters]
    n = len(next(iter(factors.values())))
    values = np.tile(prepared.kernel.parameters, (n, 1))
    for name, factor in factors.items():
        values[:, names.index(name.replace("__", "."))] *= factor
    return values


@pytest.mark.parametrize("kind", ["nominal", "static", "steady"])
def test_cases_start_where_each_starts_alone(prepared, kind):
    values = varied(prepared, chassis__mass=np.linspace(0.8, 1.3, 11))
    speeds = np.linspace(10.0, 20.0, 11)
    starter = CaseStarter(prepared, make_batch(prepared.kernel), speed=15.0, kind=kind)
    started = starter.starts(values, speeds=speeds)
    assert not started.problems
    for index in (0, 4, 10):
        point = starter._alone(prepared.subject, values[index], speeds[index])
        assert started.cases.states[index] == pytest.approx(point.state, abs=1e-9)
        assert started.cases.unknowns[index] == pytest.approx(point.unknowns, abs=1e-9)
    names = [p.name for p in prepared.equations.parameters]
    assert np.array_equal(started.cases.parameters[:, names.index("speed")], speeds)


@pytest.mark.parametrize("kind", ["static", "steady"])
def test_neighbours_and_lanes_do_not_matter(prepared, kind):
    values = varied(prepared, chassis__mass=np.linspace(0.8, 1.3, 11))
    speeds = np.full(11, 20.0)
    whole = CaseStarter(prepared, make_batch(prepared.kernel), speed=20.0, kind=kind).starts(
        values, speeds=speeds
    )
    single = CaseStarter(prepared, make_batch(prepared.kernel, lanes=1), speed=20.0, kind=kind)
    for chosen in (slice(0, 1), slice(3, 6), slice(10, 11)):
        part = single.starts(values[chosen], speeds=speeds[chosen])
        assert np.array_equal(part.cases.states, whole.cases.states[chosen])
        assert np.array_equal(part.cases.unknowns, whole.cases.unknowns[chosen])


def test_far_cases_are_approached_in_steps(prepared, monkeypatch):
    """The first steps from the base case lead nowhere for these springs."""

    def alone(*arguments):
        raise AssertionError("balanced by itself")

    monkeypatch.setattr(CaseStarter, "_alone", alone)
    values = varied(prepared, leaf_spring__stiffness=np.array([0.5, 1.0, 4.0]))
    starter = CaseStarter(prepared, make_batch(prepared.kernel), speed=20.0, kind="steady")
    started = starter.starts(values, speeds=np.full(3, 20.0))
    for index in range(3):
        kernel = prepared.kernel.with_parameters(started.cases.parameters[index])
        rates = kernel.rates(-1.0, started.cases.states[index], started.cases.unknowns[index])
        assert np.abs(rates[starter._rates]).max() < 1e-8


@pytest.mark.parametrize("lanes", [4, 8])
def test_rates_in_lanes_are_those_of_the_interpreter(prepared, lanes):
    rng = np.random.default_rng(3)
    values = varied(prepared, chassis__mass=np.linspace(0.9, 1.1, 10))
    batch = make_batch(prepared.kernel, lanes=lanes)
    start = CaseStarter(prepared, batch, speed=20.0, kind="steady").base
    states = start.state + 0.02 * rng.normal(size=(10, start.state.size))
    unknowns = np.tile(start.unknowns, (10, 1))
    rates, found = CaseRates(batch, values)(0.7, states, unknowns, np.ones(10, dtype=bool))
    assert found.all()
    interpreted = compile_kernel(prepared.equations, backend="interpreted")
    for index in range(10):
        kernel = interpreted.with_parameters(values[index])
        wanted = kernel.rates(0.7, states[index], unknowns[index])
        assert rates[index] == pytest.approx(wanted, rel=0.0, abs=1e-12 * np.abs(wanted).max())


def test_a_case_without_a_start_is_told(prepared):
    values = varied(prepared, chassis__mass=np.array([1.0, -3.0, 1.0]))
    starter = CaseStarter(prepared, make_batch(prepared.kernel), speed=20.0, kind="static")
    started = starter.starts(values, speeds=np.full(3, 20.0))
    assert list(started.problems) == [1]
    assert "no equilibrium" in started.problems[1]
    assert np.array_equal(started.cases.states[0], started.cases.states[2])


def test_given_rates_are_kept(needs_compiler):
    prepared = ready(SCENARIOS / "systems" / "four_bar.yaml")
    assert prepared.subject.given_rates
    starter = CaseStarter(prepared, make_batch(prepared.kernel), speed=0.0, kind=None)
    values = np.tile(prepared.kernel.parameters, (3, 1))
    started = starter.starts(values, speeds=np.zeros(3))
    assert not started.problems
    assert np.array_equal(started.cases.states, np.tile(starter.base.state, (3, 1)))
