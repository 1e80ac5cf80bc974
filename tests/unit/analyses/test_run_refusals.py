"""What a run refuses before it computes anything, and what it leaves alone."""

from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_scenario

SHORT = """
title: A short way straight on
model: iltis
tyres: {kind: calspan}
road: {kind: flat}
contact: vertical
wheel_spin: prescribed
speed: 10 m/s
manoeuvre: {kind: straight}
duration: 0.02 s
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


SYSTEMS = Path(__file__).parents[3] / "systems"


@pytest.fixture
def scenario(tmp_path):
    path = tmp_path / "short.yaml"
    path.write_text(SHORT)
    return path


def run(path, output, *changes):
    loaded = load_scenario(path, changes)
    return run_scenario(loaded, output=output, backend="auto", progress=lambda *_: None)


def test_solver_that_cannot_treat_the_model_leaves_an_older_result(scenario, tmp_path):
    output = tmp_path / "good.h5"
    assert run(scenario, output).status == "ok"
    before = output.read_bytes()
    cvodes = "solver={kind: cvodes, relative_tolerance: 1e-8, absolute_tolerance: 1e-8}"
    with pytest.raises(InputError, match="cannot treat the loops"):
        run(scenario, output, cvodes)
    assert output.read_bytes() == before


def test_constraints_that_a_method_cannot_hold_leave_no_file(tmp_path):
    (tmp_path / "loop.yaml").write_text(
        f"title: A loop closed by partitioning\nmodel: {SYSTEMS / 'four_bar.yaml'}\n"
        "duration: 0.1 s\nsolver: {kind: hht, step: 10 ms, constraints: index3}\n"
        "output: {interval: 10 ms}\n"
    )
    with pytest.raises(InputError, match="take 'constraint_method: multipliers'"):
        run(tmp_path / "loop.yaml", tmp_path / "loop.h5")
    assert not (tmp_path / "loop.h5").exists()


@pytest.mark.parametrize("key", ["road", "tyres", "wheel_spin"])
def test_validation_misses_what_the_vehicle_needs(scenario, key):
    with pytest.raises(InputError, match=f"{key}: missing"):
        load_scenario(scenario, [f"{key}=null"])


DIVERGING = """
title: A step far too long for the tyre
model: {system}
duration: 5 s
solver: {{kind: rk4, step: 10 ms}}
parameters: {{wheel: {{stiffness: 1e9 N/m}}}}
output: {{interval: 10 ms}}
"""


def test_a_run_that_diverges_keeps_what_it_computed(tmp_path):
    """It ends where its last samples are finite yet beyond all sense."""
    system = Path(__file__).parents[3] / "systems" / "quarter_car.yaml"
    path = tmp_path / "diverging.yaml"
    path.write_text(DIVERGING.format(system=system))
    outcome = run(path, tmp_path / "diverging.h5")
    assert outcome.status == "failed"
    assert "the integration diverges with a step of 10 ms" in outcome.messages[-1]
    assert outcome.summary["energy_drift"].value > 1e15


@pytest.mark.parametrize(
    ("step", "reason"),
    [("0.1 ms", "is no longer a finite number"), ("0.2 ms", "Newton's method did not converge")],
)
def test_loops_that_diverge_end_with_the_reason(step, reason, tmp_path):
    """Neither a better partition nor dependent constraints are sought among what is no number."""
    (tmp_path / "rod.yaml").write_text(
        f"title: A rod that bends too fast\nmodel: {SYSTEMS / 'slider_crank_flexible.yaml'}\n"
        f"duration: 5 ms\nsolver: {{kind: symplectic_euler, step: {step}}}\n"
        "output: {interval: 0.2 ms}\n"
    )
    outcome = run(tmp_path / "rod.yaml", tmp_path / "rod.h5")
    assert outcome.status == "failed"
    assert any(reason in message for message in outcome.messages), outcome.messages
