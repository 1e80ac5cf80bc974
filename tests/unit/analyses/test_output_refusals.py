"""Channels and figures that a scenario asks for in vain are refused before a derivation."""

from dataclasses import replace
from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
import vehicledyn.multibody.equations.derivation as derivation
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.simulation.wanted_outputs import validate_outputs
from vehicledyn.base.errors import InputError
from vehicledyn.files.scenario import load_model, load_scenario
from vehicledyn.interface.simulation import simulate
from vehicledyn.multibody import derive
from vehicledyn.multibody.equations.channel_outline import outline_channels

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("name", ["double_pendulum", "jeep_suspension", "testset_wheelset"])
def test_outline_names_the_channels_of_the_equations(name):
    """Open chains, loops with reactions, wheels on rails: the same channels in the same order."""
    system = build_subject(load_model(str(ROOT / f"systems/{name}.yaml"))).system
    assert tuple(outline_channels(system)) == derive(system).channels


def test_outline_knows_the_drift_of_multipliers():
    """Systems with multipliers show how far the states drift off the constraints."""
    system = build_subject(load_model(str(ROOT / "systems/four_bar.yaml"))).system
    system = replace(system, constraint_method="multipliers")
    found = derive(system).channels
    assert tuple(outline_channels(system)) == found
    assert "constraints.position_drift" in [channel.name for channel in found]


@pytest.fixture
def underived(monkeypatch):
    """Let every derivation fail."""

    def derive_nothing(*_, **__):
        raise AssertionError("derived before the refusal")

    monkeypatch.setattr(derivation, "solve_motion", derive_nothing)


@pytest.mark.parametrize(
    ("scenario", "setting", "words"),
    [
        ("iltis_slalom", "output.channels=[chassis.yawrate]", r"mean 'chassis\.yaw_rate'"),
        ("iltis_slalom", "output.channels=[nonsense]", r"there are \d+, in .*chassis\.\*"),
        ("iltis_slalom", "output.plots=[nonsense]", "no plot named 'nonsense'"),
        ("wheelset_limit_cycle", "output.channels=[nonsense]", "matches no channel; there are"),
    ],
)
def test_unknown_outputs_are_refused_before_the_derivation(underived, scenario, setting, words):
    """By the run, and by what validates, in the same words."""
    loaded = load_scenario(ROOT / f"scenarios/{scenario}.yaml", [setting])
    with pytest.raises(InputError, match=words):
        simulate(loaded)
    with pytest.raises(InputError, match=words):
        validate_outputs(loaded)


def test_known_outputs_are_valid(underived):
    """Patterns of channels pass, and nothing is derived for it."""
    loaded = load_scenario(ROOT / "scenarios/iltis_slalom.yaml", ["output.channels=[chassis.*]"])
    validate_outputs(loaded)


def test_channels_found_once_are_not_sought_again(monkeypatch, tmp_path, needs_compiler):
    """Validating again after a change of the outputs looks at the names only."""
    monkeypatch.setenv("VEHICLEDYN_CACHE", str(tmp_path / "cache"))
    path = ROOT / "scenarios/systems/double_pendulum.yaml"
    validate_outputs(load_scenario(path, ["output.channels=[upper.*]"]))
    with monkeypatch.context() as patch:
        patch.setattr("vehicledyn.multibody.equations.channel_outline.outline_channels", None)
        validate_outputs(load_scenario(path, ["output.channels=[lower.*]"]))
        with pytest.raises(InputError, match="'nonsense' matches no channel"):
            validate_outputs(load_scenario(path, ["output.channels=[nonsense]"]))
        with pytest.raises(TypeError):  # another model is another search
            validate_outputs(
                load_scenario(path, ["parameters.length=2 m", "output.channels=[upper.*]"])
            )
    for file in (tmp_path / "cache/channels").iterdir():
        file.write_text(file.read_text().replace("lower", "other"))
    validate_outputs(load_scenario(path, ["output.channels=[lower.*]"]))  # damaged: sought again
