"""Mirror groups that refer to what another group made."""

from pathlib import Path

import pytest

import vehicledyn.catalogue  # noqa: F401
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
