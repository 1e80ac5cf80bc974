"""Hunting along a parameter that the start depends on: the motion follows it, or is refused."""

from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.hunting.hunt import find_limit_cycles
from vehicledyn.analyses.hunting.start import HuntSettings
from vehicledyn.analyses.linear.eigenmodes import find_modes
from vehicledyn.analyses.linear.equilibrium import find_equilibrium
from vehicledyn.analyses.linear.response import linearise_with_inputs
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.files.scenario import load_model, load_scenario

pytestmark = pytest.mark.long

SYSTEMS = Path(__file__).parents[3] / "systems"
SCENARIO = SYSTEMS.parent / "scenarios" / "systems" / "bicycle.yaml"

WEAVE, CAPSIZE = 4.29238253634111, 6.02426201538837
"""Meijaard, Papadopoulos, Ruina, Schwab (2007), section 5: where the benchmark bicycle changes
stability [m/s]."""

CART = """\
title: A cart with a pendulum, pushed along a floor that {law}
parameters: {{push: 3 m/s, aside: 0.1 rad}}
bodies:
  cart: {{joints: [T1 way], mass: 2 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}}
  bob: {{parent: cart, joints: [R2 swing], mass: 1 kg, com: [0, 0, -1 m]}}
forces:
  floor: {{coordinate: cart.way, force: "{force}"}}
  air: {{coordinate: bob.swing, force: -0.1 N*m*s/rad * rate}}
initial: {{cart.way_rate: push, bob.swing: aside}}
"""


def study(target, parameter, first, last, **more):
    settings = HuntSettings(parameter, first, last, points=20, simulate=False, **more)
    return find_limit_cycles(target, settings, backend="auto", progress=lambda *_: None)


def cart(tmp_path, law, force):
    path = tmp_path / "cart.yaml"
    path.write_text(CART.format(law=law, force=force), encoding="utf-8")
    return load_model(str(path))


def test_the_bicycle_changes_stability_where_the_benchmark_does():
    report = study(load_model(str(SYSTEMS / "bicycle.yaml")), "forward_speed", 3.0, 8.0)
    figures = report.table.figures
    assert report.status == "ok"
    assert figures["oscillation_ceases"] == pytest.approx(WEAVE, abs=1e-9)
    assert figures["divergence_begins"] == pytest.approx(CAPSIZE, abs=1e-9)
    assert "linear_critical" not in figures and "divergence_ceases" not in figures
    (message,) = report.messages
    assert "not isolated" in message and "rear_wheel.spin_rate" in message


def test_eigenvalues_are_those_of_each_speed():
    """They are those of the same file read at that speed."""
    path = str(SYSTEMS / "bicycle.yaml")
    table = study(load_model(path), "forward_speed", 3.0, 8.0).table
    for k in (0, 7, -1):
        value = float(table.locus_values[k])
        target = load_model(path, (f"parameters.forward_speed={value!r} m/s",))
        modes = find_modes(target, speeds=(), backend="auto", progress=lambda *_: None)
        expected = modes.table.cases[0].eigenvalue
        found = [e for e in table.eigenvalues[k] if abs(e) > 1e-6 and e.imag >= 0.0]
        assert len(found) >= 3
        for eigenvalue in found:
            assert np.abs(expected - eigenvalue).min() < 1e-8


@pytest.mark.parametrize("verb", ["equilibrium", "eig", "response"])
def test_a_speed_that_is_none_of_the_system_is_refused(verb):
    """The bicycle's speed is its parameter forward_speed; at another one nothing would change."""
    target = load_model(str(SYSTEMS / "bicycle.yaml"))
    told = {"backend": "interpreted", "progress": lambda *_: None}
    with pytest.raises(InputError, match="speed: nothing in 'bicycle' depends on a speed"):
        if verb == "equilibrium":
            find_equilibrium(target, speed=3.0, **told)
        elif verb == "eig":
            find_modes(target, speeds=(3.0,), **told)
        else:
            linearise_with_inputs(target, inputs=(), speed=3.0, progress=told["progress"])


def test_a_parameter_of_the_start_alone_is_refused(tmp_path):
    target = cart(tmp_path, "does nothing", "0 N")
    with pytest.raises(InputError, match=r"parameter='aside': .*it changes the start alone"):
        study(target, "aside", 0.0, 0.2)


def test_disturbances_of_a_scenario_are_set_aside():
    """A roll rate leads to a motion in circles, whose speed is not that of the start."""
    report = study(load_scenario(SCENARIO), "forward_speed", 3.0, 8.0)
    figures = report.table.figures
    assert report.status == "ok"
    assert figures["oscillation_ceases"] == pytest.approx(WEAVE, abs=1e-9)
    assert figures["divergence_begins"] == pytest.approx(CAPSIZE, abs=1e-9)
    assert report.messages[0].startswith("'initial' of the scenario is set aside (frame.roll_rate)")


def test_a_disturbance_that_is_asked_for_is_kept():
    target = load_scenario(SCENARIO, ("initial.frame.roll_rate=0.1 rad/s",))
    with pytest.raises(InputError, match=r"forward_speed': .*without disturbances in 'initial'"):
        study(target, "forward_speed", 3.0, 8.0)


def test_a_motion_that_cannot_follow_is_refused(tmp_path):
    """Friction stops the cart, whatever speed it begins with."""
    target = cart(tmp_path, "brakes", "-5 N*s/m * rate")
    with pytest.raises((InputError, NumericalError), match=r"start alone|is not steady"):
        study(target, "push", 1.0, 4.0)


def test_a_parameter_without_any_effect_is_refused(tmp_path):
    path = tmp_path / "cart.yaml"
    text = CART.format(law="does nothing", force="0 N").replace("push:", "idle: 1 m, push:")
    path.write_text(text.replace("push: 3 m/s", "push: 3 m/s"), encoding="utf-8")
    with pytest.raises(InputError, match="neither the equations nor the start depend on it"):
        study(load_model(str(path)), "idle", 1.0, 2.0)


def test_a_branch_from_the_end_of_the_range_begins_outside_it_by_rounding(tmp_path):
    """Its first cycle may lie outside, behind an end that it has not passed."""
    path = tmp_path / "swing.yaml"
    law = "-100 N/m * position + gain * rate - 4e4 N*s/m^3 * position**2 * rate"
    path.write_text(
        "title: A mass that begins to swing by itself\nparameters: {gain: 1 N*s/m}\n"
        "bodies: {mass: {joints: [T1 x], mass: 1 kg}}\n"
        f"forces: {{spring: {{coordinate: mass.x, force: {law}}}}}\n",
        encoding="utf-8",
    )
    report = study(load_model(str(path)), "gain", -1.0, 1e-300)
    assert any("it leaves the range at gain = 1e-300" in text for text in report.messages)
