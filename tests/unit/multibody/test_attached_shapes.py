"""Shapes with kinks where loads act span static deflections under these exactly."""

import warnings

import numpy as np
import pytest
from beam_kernels import (
    BENDING,
    GIVEN,
    LENGTH,
    MASS,
    PACE,
    STRETCH,
    TWIST,
    at_rest,
    frequencies,
    kernel_of,
)

import vehicledyn as vd
from vehicledyn.base.errors import AccuracyWarning, InputError
from vehicledyn.multibody import Body
from vehicledyn.multibody.bodies.attached_shapes import attached_shapes
from vehicledyn.multibody.bodies.beam_properties import Stiffness
from vehicledyn.multibody.bodies.beam_shapes import quadrature
from vehicledyn.multibody.elements.external_wrenches import ExternalWrench
from vehicledyn.multibody.elements.flexible.beam import Beam, Modes


@pytest.mark.parametrize("order", [1, 2])
def test_shapes_are_decoupled(order):
    shapes = attached_shapes(6, order, (0.3, 0.75, 1.0, 0.3))
    places, weights = quadrature(12, (0.3, 0.75))
    moved, bent = shapes.at(places), shapes.at(places, order)
    assert (moved.T * weights) @ moved == pytest.approx(np.eye(6), abs=1e-10)
    springs = (bent.T * weights) @ bent
    assert springs / np.diag(springs) == pytest.approx(np.eye(6), abs=1e-8)
    assert np.diag(springs) == pytest.approx(shapes.stiffness)


@pytest.mark.parametrize("model", ["modes", "exact"])
def test_loads_in_the_middle_of_a_beam(model):
    """Deflections and loads of sections to rounding; eight polynomials twist 5 % too little."""
    force, torque = np.array([3e-5, 0.0, -2e-6]), 1e-6
    load = ExternalWrench(
        "load", body="beam.frame_1", force=lambda t: tuple(force), torque=lambda t: (torque, 0, 0)
    )
    kernel = kernel_of(
        parts=(load,), frames=(0.4, 0.2), basis="attached", model=model,
        modes=Modes(z=5, y=5, twist=3, stretch=3),
    )  # fmt: skip
    seen, at = at_rest(kernel), 0.4 * LENGTH
    reach = at**2 * (3.0 * LENGTH - at) / 6.0 / BENDING
    assert seen["beam.tip_z"] == pytest.approx(force[2] * reach, rel=1e-6)
    assert seen["beam.tip_x"] == pytest.approx(force[0] * at / STRETCH, rel=1e-3)
    assert seen["beam.start.moment_y"] == pytest.approx(-force[2] * at, rel=1e-6)
    assert seen["beam.frame_2.moment_y"] == pytest.approx(-force[2] * 0.5 * at, rel=1e-6)
    if model == "modes":
        assert seen["beam.frame_2.shear_force_z"] == pytest.approx(force[2], rel=1e-6)
    assert seen["beam.frame_2.torque"] == pytest.approx(torque, rel=1e-6)
    assert seen["beam.frame_1.moment_y"] == pytest.approx(0.0, abs=1e-9)
    twisted = 0.5 * torque**2 * at / TWIST
    bent = force[2] ** 2 * at**3 / 6.0 / BENDING
    pulled = 0.5 * force[0] ** 2 * at / STRETCH
    assert seen["beam.strain_energy"] == pytest.approx(twisted + bent + pulled, rel=1e-6)


@pytest.mark.long
def test_frequencies_with_a_mass_in_the_middle():
    """Roots of the determinant of two spans; ten polynomials are 7e-4 and 1.5e-3 off."""
    load = Body("load", "beam.frame_1", mass=2.0 * MASS * LENGTH)
    found = frequencies(kernel_of(load, modes=Modes(z=8), basis="attached", frames=(0.4,)))[:3]
    assert found == pytest.approx([6.475038974, 25.322676009, 115.515387005], rel=1e-4)


@pytest.mark.long
def test_a_large_force_in_the_middle():
    """The end moves aside by 0.5 of the length, as that of two beams, one on the other's end."""
    kernels = []
    push = {"force": lambda t: (0.0, 0.0, -8.0 * BENDING / LENGTH**2), "axes": "body"}
    given = {"model": "exact", "stiffness": GIVEN}
    load = ExternalWrench("load", body="beam.tip", **push)
    rest = Beam("rest", body="beam.tip", length=0.6 * LENGTH, modes=Modes(z=4), **given)
    kernels.append(kernel_of(parts=(load, rest), length=0.4 * LENGTH, modes=Modes(z=5), **given))
    load = ExternalWrench("load", body="beam.frame_1", **push)
    basis = {"basis": "attached", "frames": (0.4,), "modes": Modes(z=8)}
    kernels.append(kernel_of(parts=(load,), **basis, **given))
    two, one = (at_rest(kernel, 40) for kernel in kernels)
    assert one["beam.strain_energy"] == pytest.approx(two["beam.strain_energy"], rel=1e-4)
    assert one["beam.start.moment_y"] == pytest.approx(two["beam.start.moment_y"], rel=1e-3)


@pytest.mark.long
def test_rotation_stiffens_it():
    """Flap at a speed of 12, hub ratio 0; own Legendre-Ritz solution."""
    modes = Modes(z=8)
    found = frequencies(kernel_of(speed=12.0 * PACE, modes=modes, basis="attached", frames=(0.3,)))
    expected = [13.170150, 37.603112, 79.614478]
    assert found[:3] / PACE == pytest.approx(expected, rel=1e-3)


BED, STIFF = 1e8, 6.4e6
WAVES = (BED / 4.0 / STIFF) ** 0.25
"""λ: a long rail sinks by P λ/2 k, Hetenyi (1946)."""
RAIL = f"""title: A rail under a wheel
gravity: [0, 0, 0]
bodies:
  start: {{joints: [T3 z, R2 pitch]}}
elements:
  rail:
    kind: beam
    body: start
    length: {8.0 / WAVES} m
    stiffness: {{mass_per_length: 60 kg/m, z: {STIFF} N*m^2}}
    modes: {{z: 8}}
    basis: BASIS
    frames: [0.5]
    foundation: {{at: [0, 0, 0], stiffness: [0, 0, {BED} N/m^2]}}
wrenches:
  wheel: {{body: rail.frame_1, force: [0, 0, -1 kN]}}
sensors:
  middle: {{kind: point, body: rail.frame_1, shows: [position]}}
"""


@pytest.mark.long
@pytest.mark.parametrize(("basis", "missing"), [("attached", 2.8e-4), ("polynomials", 0.10428)])
def test_a_rail_on_its_bed(tmp_path, basis, missing):
    """What polynomials miss is told, of the frame that a force acts on."""
    (tmp_path / "rail.yaml").write_text(RAIL.replace("BASIS", basis))
    with warnings.catch_warnings(record=True) as issued:
        warnings.simplefilter("always")
        found = vd.equilibrium(tmp_path / "rail.yaml", backend="interpreted")
    share = found["middle.z"].values / (-1e3 * WAVES / 2.0 / BED)
    assert share == pytest.approx(1.0 - missing, abs=1e-5)
    told = [str(w.message) for w in issued if w.category is AccuracyWarning]
    words = "under a force at rail.frame_1 it sinks 10 % too little with 8 shapes"
    assert [words in text for text in told] == ([True] if missing > 0.01 else [])


def test_tapered_beams_of_modes_have_no_kinks():
    start, end = (Stiffness(mass_per_length=1.0, z=z) for z in (1.0, 2.0))
    settings = {"length": 1.0, "stiffness": start, "end_stiffness": end, "modes": Modes(z=4)}
    with pytest.raises(InputError, match="are those of a uniform beam"):
        Beam("beam", body="ground", basis="attached", **settings)


def test_frames_too_near_to_an_end_are_refused():
    with pytest.raises(InputError, match=r"frames: 1e-05 is too near to an end"):
        attached_shapes(6, 2, (1e-5,))


@pytest.mark.long
def test_sweeps_say_which_cases_have_too_few_shapes(tmp_path):
    """The bed is a parameter: with a hundredth of it the eight polynomials do."""
    rail = RAIL.replace("BASIS", "polynomials").replace(f"{BED} N/m^2", "bed")
    title, rest = rail.split("\n", 1)
    rail = f"{title}\nparameters: {{bed: {BED} N/m^2}}\n{rest}"
    (tmp_path / "rail.yaml").write_text(rail)
    (tmp_path / "run.yaml").write_text(
        "title: It stands\nmodel: rail.yaml\nduration: 10 us\n"
        "solver: {kind: rk4, step: 0.1 us}\noutput: {interval: 10 us}\n"
    )
    (tmp_path / "study.yaml").write_text(
        "title: Two beds\nscenario: run.yaml\ncases: {kind: grid, vary: "
        f"{{parameters.bed: [{0.01 * BED} N/m^2, {BED} N/m^2]}}}}\n"
        "output: {interval: 10 us}\n"
    )
    words = "it sinks by up to 10 % too little under its loads in 1 of 2 cases \\(1\\); take 'basis"
    with pytest.warns(AccuracyWarning, match=words):
        found = vd.sweep(tmp_path / "study.yaml", backend="interpreted", workers=1)
    missing = found["sinks_too_little.rail"].values
    # A free rail of λ L = 8 sinks a little more than a long one (Hetenyi (1946)).
    more = (np.cosh(8.0) + np.cos(8.0) + 2.0) / (np.sinh(8.0) + np.sin(8.0))
    expected = 1.0 - (1.0 - 0.10428) / more
    assert missing == pytest.approx([np.nan, expected], abs=1e-5, nan_ok=True)


def test_kinks_whose_stiffness_drowns_that_of_the_other_shapes_are_refused():
    """Beyond a place at 0.9999 the beam is 1e16 times as stiff as in all."""
    for place in (0.999, 0.9999, 0.99999):
        with pytest.raises(InputError, match=rf"frames: {place:g} is too near to an end"):
            attached_shapes(4, 2, (0.4, place))
    near = attached_shapes(8, 2, (0.99,))
    assert near.stiffness[0] ** 0.25 == pytest.approx(1.8751040687, rel=1e-8)


def test_torques_inside_a_beam_are_told(tmp_path):
    """One that a link with an arm makes, with 4 polynomials; nothing of forces at the end."""
    text = """title: A rod that a spring twists
elements:
  rod:
    kind: beam
    body: ground
    length: 1 m
    section: {shape: circle, radius: 10 mm}
    material: {density: 7850 kg/m^3, young: 210 GPa}
    modes: {twist: 4}
    basis: BASIS
    frames: [0.4]
links:
  spring:
    a: {body: ground, point: [0.4 m, 0.1 m, 1 m]}
    b: {body: rod.FRAME, point: [0, 0.1 m, 0]}
    law: {kind: spring_damper, stiffness: 1 kN/m, free_length: 0.9 m}
"""
    words = "under a torque at rod.frame_1 it twists 9.9 % too little there with 4 shapes"
    for given in ("polynomials frame_1", "attached frame_1", "polynomials tip"):
        basis, frame = given.split()
        file = tmp_path / "rod.yaml"
        file.write_text(text.replace("BASIS", basis).replace("FRAME", frame))
        with warnings.catch_warnings(record=True) as issued:
            warnings.simplefilter("always")
            vd.equilibrium(file, backend="interpreted")
        told = [str(w.message) for w in issued if w.category is AccuracyWarning]
        is_coarse = (basis, frame) == ("polynomials", "frame_1")
        assert [words in t for t in told] == [True] * is_coarse
