"""Beams on an elastic foundation, after Winkler (1867), against closed forms (Hetenyi 1946)."""

import math

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.beam_properties import Stiffness
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes
from vehicledyn.multibody.elements.flexible.foundation import Foundation

MASS, BENDING, LENGTH = 60.0, 6.4e6, 2.0
MODELS = {
    "modes": "model: modes\n    modes: {z: 8}",
    "exact": "model: exact\n    modes: {z: 8}",
    "segments": "model: segments\n    modes: {z: 1}\n    segments: 24",
}


def written(tmp_path, foundation, more="modes: {z: 8}", length=LENGTH, rest=""):
    path = tmp_path / "rail.yaml"
    path.write_text(
        f"""title: A rail on its bed
gravity: [0, 0, 0]
bodies:
  middle: {{joints: [T3 z, R2 pitch]}}
  carrier: {{joints: [T3 height], mass: 50 kg}}
elements:
  rail:
    kind: beam
    body: middle
    length: {length} m
    stiffness: {{mass_per_length: {MASS} kg/m, z: {BENDING} N*m^2, stretch: 1e9 N}}
    {more}
    foundation: {foundation}
{rest}"""
    )
    return path


def frequencies(path):
    found = vd.modes(path, backend="interpreted")
    return 2.0 * math.pi * np.unique(np.round(np.ravel(found["frequency"].values), 7))


@pytest.mark.long
@pytest.mark.parametrize("model", MODELS)
def test_frequencies_of_a_free_beam_rise_by_the_foundation(tmp_path, model):
    bed = 1e7
    path = written(tmp_path, f"{{at: [0, 0, 0], stiffness: [0, 0, {bed} N/m^2]}}", MODELS[model])
    roots = np.array([0.0, 4.730040744862704, 7.853204624095838])
    exact = np.sqrt(bed / MASS + BENDING * (roots / LENGTH) ** 4 / MASS)
    found = frequencies(path)
    rising = found[found > 1.0][:3]
    assert rising == pytest.approx(exact, rel=3e-5 if model == "segments" else 2e-6)


@pytest.mark.long
def test_a_long_rail_sinks_under_its_load(tmp_path):
    """Half of it, whose middle keeps its slope and carries half of the load."""
    load, bed = 1e5, 1e8
    per_length = (bed / (4.0 * BENDING)) ** 0.25
    path = written(
        tmp_path, f"{{at: [0, 0, 0], stiffness: [0, 0, {bed} N/m^2]}}", "modes: {z: 12}", 12.0,
        f"forces:\n  half: {{coordinate: middle.z, force: {-0.5 * load} N}}\n",
    )  # fmt: skip
    path.write_text(path.read_text().replace("T3 z, R2 pitch", "T3 z"))
    found = vd.equilibrium(path, backend="interpreted")
    sinks = load * per_length / (2.0 * bed)
    assert found["middle.z"].values == pytest.approx(-sinks, rel=1e-4)
    assert found["rail.foundation_force_z"].values == pytest.approx(0.5 * load, rel=1e-9)


@pytest.mark.long
def test_part_of_a_beam_swings_against_what_carries_its_foundation(tmp_path):
    """Without modes along z the beam is rigid: two masses and a spring, damped."""
    bed, damping = 1e5, 30.0
    foundation = (
        f"{{stiffness: [0, 0, {bed} N/m^2], damping: [0, 0, {damping} N*s/m^2], on: carrier, "
        "at: [0, 0, 0], begin: 0.25, end: 0.75}"
    )
    path = written(tmp_path, foundation, "modes: {stretch: 1}")
    path.write_text(path.read_text().replace("T3 z, R2 pitch", "T3 z"))
    values = np.ravel(vd.modes(path, backend="interpreted")["eigenvalue"].values)
    swing = values[(values.imag > 1.0) & (values.imag < 500.0)]
    over_mass = 0.5 * LENGTH * (1.0 / (MASS * LENGTH) + 1.0 / 50.0)
    assert abs(swing[0]) ** 2 == pytest.approx(bed * over_mass, rel=1e-9)
    assert swing[0].real == pytest.approx(-0.5 * damping * over_mass, rel=1e-9)


def beam(foundation, body="ground"):
    stiffness = Stiffness(mass_per_length=1.0, z=1.0)
    made = Beam(
        name="rail", body=body, length=1.0, stiffness=stiffness, modes=Modes(z=2),
        foundation=foundation,
    )  # fmt: skip
    return made.added_bodies()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"begin": 0.7, "end": 0.3}, "runs from 0.7 to 0.3"),
        ({"end": 1.2}, "runs from 0 to 1.2"),
        ({"stiffness": (0.0, 0.0, -1.0)}, "foundation.stiffness: is -1 along z"),
        ({"damping": (0.0, -2.0, 0.0)}, "foundation.damping: is -2 along y"),
    ],
)
def test_what_is_no_foundation_is_refused(given, words):
    with pytest.raises(InputError, match=words):
        Foundation(**{"stiffness": (0.0, 0.0, 1.0), **given})


def test_a_line_on_another_body_says_where_it_begins():
    foundation = Foundation(stiffness=(0.0, 0.0, 1.0))
    with pytest.raises(InputError, match=r"foundation\.at: missing; the beam is clamped to 'arm'"):
        beam(foundation, "arm")
    assert len([b for b in beam(foundation) if "support" in b.name]) > 2
