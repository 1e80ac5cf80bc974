"""Elements of system files that bring bodies and coordinates: starts, drives, assemblies."""

import pytest
from system_texts import Motion, equations, problems

ARM = """\
title: An arm
parameters: {length: 2 m}
bodies: {hub: {joints: [R3 turn], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}}
elements:
  bar: {kind: flexible_bar, body: hub, length: length, mass_per_length: 1 kg/m,
        bending_stiffness: 9 N*m^2, modes: 1, frames: [0.5, 1]}
initial: {bar.mode_1: 2 cm, bar.mode_1_rate: 0.3 m/s}
"""
LOAD = "  load: {parent: FRAME, mass: 2 kg}\n"


def test_their_coordinates_start_as_the_file_says(tmp_path):
    e = equations(tmp_path, ARM)
    start = {s.name: s.start for s in e.states}
    assert (start["bar.mode_1"], start["bar.mode_1_rate"]) == (0.02, 0.3)
    seen = Motion(e).at()
    assert seen["bar.tip"] == pytest.approx(0.04, rel=1e-9)


def test_they_can_be_driven_and_used_in_expressions(tmp_path):
    text = ARM.partition("initial")[0] + (
        "drives: {shake: {coordinate: bar.mode_1, law: {kind: constant_rate, rate: 0.1 m/s}}}\n"
        "sensors: {s: {kind: expression, value: 2 * bar.mode_1, unit: m}}\n"
    )
    e = equations(tmp_path, text)
    assert [s.name for s in e.states] == ["hub.turn", "hub.turn_rate"]
    assert Motion(e).at(2.0)["s"] == pytest.approx(0.4, rel=1e-12)


def test_an_assembly_brings_them_under_its_name(tmp_path):
    (tmp_path / "arm.yaml").write_text(ARM, encoding="utf-8")
    text = "title: t\nassemblies: {left: {file: arm.yaml}}\nbodies:\n"
    text += LOAD.replace("FRAME", "left.bar.frame_2")
    e = equations(tmp_path, text)
    start = {s.name: s.start for s in e.states}
    assert start["left.bar.mode_1"] == 0.02
    seen = Motion(e).at()
    assert seen["left.bar.frame_2.across"] == pytest.approx(0.04, rel=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("bar.mode_1:", "bar.mode_2:", "no coordinate named 'bar.mode_2'"),
        ("frames: [0.5, 1]", "frames: [0.5, 1.5]", "frames"),
        ("modes: 1", "modes: 4", "elements.bar.modes: must be 1, 2 or 3"),
        ("9 N*m^2", "0 N*m^2", "elements.bar.bending_stiffness: must be greater than 0 N"),
        ("body: hub,", "body: hup,", "elements.bar.body: no body named 'hup'"),
    ],
)
def test_mistakes_are_named(tmp_path, old, new, words):
    found = problems(tmp_path, ARM.replace(old, new))
    assert any(words in line for line in found), found


def test_a_name_that_is_taken_is_refused(tmp_path):
    text = ARM.replace("bodies: {", "bodies: {bar.frame_1: {mass: 1 kg}, ")
    found = problems(tmp_path, text)
    assert any("bar.frame_1" in line for line in found), found


BLADE = """\
title: A blade on a hub without mass, with a load at its end
bodies:
  hub: {joints: [R3 turn]}
  load: {parent: blade.tip, mass: 2 kg}
elements:
  blade: {kind: beam, body: hub, length: 2 m, modes: {y: 3}, frames: [0.5],
          section: {shape: rectangle, width: 8 mm, height: 9 mm},
          material: {density: 7870 kg/m^3, young: 200 GPa}}
"""


def test_a_massless_body_carries_what_an_element_brings(tmp_path):
    assert not problems(tmp_path, BLADE)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("frames: [0.5]", "frames: [1.5]", "1.5 is beyond the beam; places run from 0 to 1"),
        ("frames: [0.5]", "segments: 0", "segments: must be at least 1, is 0"),
        ("{y: 3}", "{y: 30}", "30 is not from 0 to 12"),
        ("{y: 3}", "{}", "would be rigid"),
        ("frames: [0.5]", "stiffness: {mass_per_length: 1 kg/m}", "not both"),
        ("width: 8 mm, ", "", "a rectangle needs its width and height"),
        ("shape: rectangle", "radius: 1 mm, shape: rectangle", "a rectangle has no radius"),
        ("{y: 3}", "{y: 3}, stiffening: axial_force", "needs modes.stretch"),
        ("parent: blade.tip", "parent: blade", "'blade' deforms; hang it on a frame"),
    ],
)
def test_one_mistake_in_a_beam_is_one_problem(tmp_path, old, new, words):
    """Bodies and joints that depend on the beam are not named beside it."""
    (found,) = problems(tmp_path, BLADE.replace(old, new))
    assert words in found
