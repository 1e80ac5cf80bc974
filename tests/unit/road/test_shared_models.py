"""Manoeuvres and drivers of a vehicle hand it the same numbers, so its compiled model is one."""

from dataclasses import replace
from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.codegen.passes.seam_cut import cut_at_seam
from vehicledyn.codegen.toolchain.fingerprint import fingerprint
from vehicledyn.files.scenario.load import load_scenario
from vehicledyn.multibody.equations.derivation import derive

SCENARIOS = Path(__file__).parents[3] / "scenarios"

STEERED = ("steering.rack", "steering.rack, acceleration", "steering.rack, rate")


def system_of(name, *changes):
    return build_subject(load_scenario(SCENARIOS / f"{name}.yaml", changes)).system


def cut_of(name, *changes):
    return cut_at_seam(derive(system_of(name, *changes)))


def test_open_loop_steering_shares_the_model():
    ramp, sine = cut_of("iltis_ramp_steer"), cut_of("iltis_sine_steer")
    assert ramp.handed == sine.handed == STEERED
    assert ramp.model_key == sine.model_key


def test_drivers_share_the_model():
    preview = cut_of("iltis_slalom")
    pursuit = cut_of(
        "iltis_slalom",
        "manoeuvre.driver={kind: pure_pursuit, distance: 8 m, "
        "lag_frequency: 20 rad/s, lag_damping: 0.8, rack_stop: 60 mm}",
    )
    assert preview.handed == pursuit.handed == (*STEERED, "torque of drive")
    assert preview.model_key == pursuit.model_key


def test_other_tyres_are_another_model():
    keys = {
        cut_of("iltis_ramp_steer", f"tyres.kind={kind}").model_key
        for kind in ("calspan", "magic_formula_1987")
    }
    assert len(keys) == 2


def test_with_multipliers_nothing_is_handed():
    """A road vehicle of which no partition lasts once ended as a bug: symbols were left free."""
    system = replace(system_of("iltis_slalom"), constraint_method="multipliers")
    equations = derive(system)
    assert equations.seam is None
    assert fingerprint(equations)


@pytest.mark.long
def test_random_roads_share_the_model():
    first, second = (
        cut_of(
            "iltis_ramp_steer",
            f"road={{kind: iso8608, road_class: {kind}, length: {length} m, start: {start} m, "
            f"track: {track} m, seed: {seed}}}",
        )
        for kind, length, start, track, seed in (("A", 30, 0, 1.5, 1), ("C", 50, 2, 1.4, 2))
    )
    assert first.model_key == second.model_key
