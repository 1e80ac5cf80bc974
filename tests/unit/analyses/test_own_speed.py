"""Analyses of a system at another value of its own parameter "speed"."""

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import find_equilibrium, find_modes
from vehicledyn.analyses.linear.response import linearise_with_inputs
from vehicledyn.files.scenario import load_model, load_scenario

SYSTEM = """\
title: A mass whose frequency is a speed over a radius, and that starts with that speed
parameters: {speed: 3 m/s, radius: 1 m, mass: 2 kg, stiffness: mass * (speed / radius)**2}
bodies:
  mass: {joints: [{kind: T1, name: x, start_rate: speed}], mass: mass, inertia: [1 kg*m^2,
        1 kg*m^2, 1 kg*m^2]}
springs:
  spring: {coordinate: mass.x, law: {kind: spring_damper, stiffness: stiffness}}
"""
SCENARIO = """\
title: It swings
model: swing.yaml
duration: 1 s
start: nominal
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
parameters: {radius: 0.5 m}
"""


def quiet(*_):
    pass


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "swing.yaml").write_text(SYSTEM, encoding="utf-8")
    (tmp_path / "swings.yaml").write_text(SCENARIO, encoding="utf-8")
    return tmp_path


def frequencies(target, speeds):
    report = find_modes(target, speeds=speeds, backend="interpreted", progress=quiet)
    return report, [abs(entry.modes[0].eigenvalue.imag) for entry in report.speeds]


def test_what_is_calculated_from_the_speed_follows_it(folder):
    model = load_model(str(folder / "swing.yaml"), ["radius=2 m"])
    report, found = frequencies(model, [5.0, 7.0])
    assert found == pytest.approx([2.5, 3.5], rel=1e-12)
    assert [entry.speed for entry in report.speeds] == [5.0, 7.0]
    assert "swing at 7 m/s" in report.as_text()


def test_without_a_speed_the_own_one_is_told(folder):
    report, found = frequencies(load_model(str(folder / "swing.yaml")), [])
    assert found == pytest.approx([3.0], rel=1e-12)
    assert report.as_text().startswith("swing at 3 m/s")


def test_a_scenario_is_read_again_with_its_changes(folder):
    scenario = load_scenario(folder / "swings.yaml", ["parameters.mass=9 kg"])
    _, found = frequencies(scenario, [4.0])
    assert found == pytest.approx([8.0], rel=1e-12)


def test_start_rates_follow_in_responses(folder):
    model = linearise_with_inputs(
        load_scenario(folder / "swings.yaml"),
        inputs=["force:mass.x"],
        speed=6.0,
        progress=quiet,
    )
    names = [state.name for state in model.prepared.equations.states]
    assert model.point.state[names.index("mass.x_rate")] == pytest.approx(6.0)


def test_an_equilibrium_at_rest_tells_no_speed(folder):
    still = find_equilibrium(
        load_model(str(folder / "swing.yaml")), speed=5.0, backend="interpreted", progress=quiet
    )
    assert still.speed == 0.0, "nothing rolls on rails: it is at rest"
