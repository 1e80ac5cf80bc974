"""Mirror groups that refer to what another group made."""

import re
from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd
import vehicledyn.catalogue
from vehicledyn.base.errors import InputError
from vehicledyn.files.expressions.algebra import NUMBERS
from vehicledyn.files.scenario import load_model

SYSTEMS = Path(__file__).parents[3] / "systems"
ARMS = """
title: Two arms, and what acts on them, in two mirror groups
bodies:
  frame: {joints: [T3 height, R1 roll], mass: 300 kg, inertia: [60 kg*m^2, 100 kg*m^2, 100 kg*m^2]}
mirror:
  - plane: y
    names: {left: right}
    springs:
      spring_left:
        coordinate: arm_left.swing
        law: {kind: spring_damper, stiffness: 1 kN*m/rad}
    forces:
      turning_left: {coordinate: arm_left.swing, force: 2 N*m - arm_left.lift_rate * 1 N*m*s/rad}
      lifting_left: {coordinate: arm_left.lift, force: 3 N*m - arm_left.swing * 1 N*m/rad}
      rolling_left: {coordinate: frame.roll, force: 5 N*m}
  - plane: y
    names: {left: right}
    bodies:
      arm_left:
        parent: frame
        at: [0, 0.4 m, 0]
        joints: [R1 swing, R2 lift]
        mass: 10 kg
        com: [0.1 m, 0.2 m, 0]
        inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]
"""


@pytest.fixture
def forces(tmp_path):
    path = tmp_path / "arms.yaml"
    path.write_text(ARMS)
    file = load_model(str(path)).written.file
    return file.forces, file.springs


def test_image_acts_on_the_image_of_another_group(forces):
    """What acts on a left arm of another group acts on the right arm in the image."""
    made, springs = forces
    assert springs["spring_right"].coordinate == "arm_right.swing"
    assert made["turning_right"].coordinate == "arm_right.swing"
    assert made["lifting_right"].coordinate == "arm_right.lift"


def test_signs_are_those_of_the_other_groups_coordinates(forces):
    """A turn about x changes its sign in the mirror, as force and as a term; one about y not."""
    made, _ = forces
    turning, lifting = made["turning_right"].force, made["lifting_right"].force
    assert "arm_right.lift_rate" in str(turning)
    assert "arm_right.swing" in str(lifting)
    values = {"arm_right.lift_rate": 0.5, "arm_right.swing": 0.25}
    assert evaluated(turning, values) == pytest.approx(-(2.0 - 0.5))
    assert evaluated(lifting, values) == pytest.approx(3.0 + 0.25)


def test_body_without_an_image_stays_its_own(forces):
    """The frame, which no group made twice, is pushed the other way."""
    made, _ = forces
    assert made["rolling_right"].coordinate == "frame.roll"
    assert evaluated(made["rolling_right"].force, {}) == pytest.approx(-5.0)


def test_motors_of_the_bogie_turn_both_wheels():
    """Both motors once turned the left wheel, and the bogie stood 0.074 mm aside."""
    forces = load_model(str(SYSTEMS / "bas2000_bogie.yaml")).written.file.forces
    assert forces["motor_left"].coordinate == "large_left.spin"
    assert forces["motor_right"].coordinate == "large_right.spin"


def evaluated(expression, values):
    """Return the value of an expression of numbers."""
    return expression.value(values, NUMBERS)


BEAMS = """
title: Two curved beams with bodies at their tips
parameters: {{gravity: 9.81 m/s^2}}
gravity: [0, 0, -gravity]
bodies:
  hub: {{joints: [T3 z], mass: 10 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}}
mirror:
  - plane: {plane}
    names: {{left: right}}
    elements:
      left_beam:
        kind: beam
        body: hub
        at: [0.1 m, 0.2 m, 0.3 m]
        direction: [0, 1, 0]
        length: 0.5 m
        curvature: [0.5 rad/m, 1 rad/m, 2 rad/m]
        model: exact
        section: {{shape: rectangle, width: 20 mm, height: 8 mm}}
        material: {{density: 7850 kg/m^3, young: 2 GPa, poisson: 0.3}}
        modes: {{z: 1, y: 1, twist: 1}}
    {rest}
sensors:
  left: {{kind: point, body: {left}, point: [0.1 m, 0.2 m, 0.05 m]}}
  right: {{kind: point, body: {right}, point: [0.1 m, {y}0.2 m, 0.05 m]}}
"""
END = """bodies:
      left_end:
        parent: left_beam.tip
        joints: [{kind: turn, axis: 3, angle: -90 deg}]
        mass: 3 kg
        com: [0.1 m, 0.2 m, 0]
        inertia: [1 kg*m^2, 2 kg*m^2, 1 kg*m^2]"""


def _moved(folder, **given):
    (folder / "beams.yaml").write_text(BEAMS.format(**given))
    run = "title: Beams\nmodel: beams.yaml\nduration: 5 ms\nsolver: {kind: rk4, step: 0.5 ms}\n"
    (folder / "run.yaml").write_text(run + "output: {interval: 5 ms}\n")
    result = vd.simulate(folder / "run.yaml", backend="interpreted")
    return [
        np.stack([result[f"{side}.{axis}"].values for axis in "xyz"]) for side in ("left", "right")
    ]


@pytest.mark.long
def test_image_of_a_curved_beam_and_what_hangs_on_it_move_in_the_mirror(tmp_path):
    """A body at the tip of the left beam has an image at the tip of the right one."""
    names = {"left": "left_end", "right": "right_end", "y": "-"}
    left, right = _moved(tmp_path, plane="y", rest=END, **names)
    assert right == pytest.approx(left * np.array([1, -1, 1])[:, None], abs=1e-12)
    assert np.ptp(left, axis=1).max() > 1e-4


@pytest.mark.parametrize("plane", ["x", "y", "z"])
def test_images_of_curved_beams_are_curved_the_other_way(plane, tmp_path):
    """Sections are mirrored across their y axis: twist and curvature about z turn round."""
    names = {"left": "left_beam.tip", "right": "right_beam.tip", "y": ""}
    path = tmp_path / "beams.yaml"
    path.write_text(BEAMS.format(plane=plane, rest="", **names))
    image = load_model(str(path)).written.file.elements["right_beam"]
    assert list(image.curvature.value({}, NUMBERS)) == [-0.5, 1.0, -2.0]


@pytest.mark.parametrize(
    ("plane", "rest", "words"),
    [
        ("x", END, "'left_beam.tip' belongs to an element, whose frames are mirrored across y"),
        ("y", "initial: {left_beam.z_1: 1 mm}", "the mirror motion of 'left_beam.z_1' of the"),
        (
            "y",
            "springs: {left_s: {coordinate: left_beam.z_1, law: {kind: spring_damper}}}",
            "the mirror motion of 'left_beam.z_1' of the element 'left_beam' is not known; write",
        ),
    ],
)
def test_what_has_no_known_image_is_refused(plane, rest, words, tmp_path):
    """Frames across other planes and coordinates of elements are named, with what to do."""
    path = tmp_path / "beams.yaml"
    names = {"left": "left_beam.tip", "right": "right_beam.tip", "y": ""}
    path.write_text(BEAMS.format(plane=plane, rest=rest, **names))
    with pytest.raises(InputError, match=re.escape(words)):
        load_model(str(path))


WHEELS = """
title: A cart with wheels of rollers, and a cam
bodies:
  cart: {joints: [T1 x, T2 y, R3 yaw], mass: 10 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
mirror:
  - plane: x
    names: {front: rear}
    bodies:
      front_hub: {parent: cart, at: [0.2 m, 0.3 m, 0.1 m], joints: [R2 turn], mass: 1 kg}
      front_other: {parent: cart, at: [0.4 m, 0.3 m, 0.1 m], joints: [R2 turn], mass: 1 kg}
    constraints:
      front_wheel:
        {kind: universal_wheel, body: front_hub, axis: 2, radius: 0.1 m, roller_angle: 45 deg}
    elements:
      front_wheel_2:
        kind: roller_wheel
        hub: front_other
        axis: 2
        radius: 0.1 m
        rollers: 8
        roller_angle: 40 deg
        roller_radius: 20 mm
        roller_mass: 0.1 kg
        stiffness: 1e5 N/m
        friction: 0.5
"""


def test_rollers_have_the_other_hand_in_the_image(tmp_path):
    """Rollers at 45 deg lie at -45 deg in the mirror, of averaged wheels and of real ones."""
    path = tmp_path / "wheels.yaml"
    path.write_text(WHEELS)
    file = load_model(str(path)).written.file
    angle = file.constraints["rear_wheel"].roller_angle.value({}, NUMBERS)
    assert angle == pytest.approx(-np.pi / 4)
    assert file.elements["rear_wheel_2"].roller_angle == -40.0


def test_cams_have_no_image(tmp_path):
    """The outline of a cam would be run over backwards: refused with its place."""
    text = (SYSTEMS / "cam_follower.yaml").read_text()
    lines = text.splitlines()
    where = lines.index("elements:")
    group = lines[where:]
    end = next((k for k, line in enumerate(group[1:], 1) if line[:1].strip()), len(group))
    inside = ["mirror:", "  - plane: y", "    names: {contact: other}"]
    inside += [f"    {line}" for line in group[:end]]
    path = tmp_path / "cams.yaml"
    path.write_text("\n".join([*lines[:where], *inside, *group[end:]]))
    with pytest.raises(InputError, match="the outline of its cam is not mirrored; write it and"):
        load_model(str(path))
