"""Angles of attack that contacts count with, and what is told of vehicles that exceed them."""

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.files.scenario import load_model
from vehicledyn.rail.contact.attack_remarks import attack_remarks
from vehicledyn.rail.contact.wheel_grid import largest_attack

WAGON = """
title: Two axles on frames of their own
parameters: {{begin: 10 m, speed: 60 km/h, half_base: 4.5 m}}
track:
  kind: layout
  gauge: 1435 mm
  inclination: 1/40
  rail: 60E1
  segments:
    - {{kind: straight, length: 50 m}}
    - {{kind: clothoid, length: 50 m}}
    - {{kind: arc, length: 100 m, radius: -250 m}}
creep: {{kind: shen_hedrick_elkins, friction: 0.35}}
rail_contact: {{kind: elastic, youngs_modulus: 210 GPa, poissons_ratio: 0.28, damping: 2 s/m{more}}}
repeat:
  - for: {{axle: [1, 2]}}
    bodies:
      "frame_{{axle}}":
        joints:
          - kind: track_frame
            position: "begin + (3 - 2 * {{axle}}) * half_base + speed * time"
      "wheelset_{{axle}}":
        parent: "frame_{{axle}}"
        at: [0, 0, 460 mm]
        joints: [T2 y, T3 z, R3 yaw, R1 roll, R2 spin]
        mass: 1.3 t
        inertia: [700 kg*m^2, 100 kg*m^2, 700 kg*m^2]
        spins_about: 2
    rail_wheels:
      "axle_{{axle}}":
        body: "wheelset_{{axle}}"
        wheels: [left, right]
        radius: 460 mm
        tape_circle: 750 mm
        profile: S1002
"""


def wheels_of(folder, more=""):
    path = folder / "wagon.yaml"
    path.write_text(WAGON.format(more=more), encoding="utf-8")
    parts = build_subject(load_model(str(path))).system.parts
    return {part.name: part for part in parts if part.name.startswith("axle")}


def test_a_long_wheelbase_counts_with_larger_angles(tmp_path):
    """At 9 m in 250 m front axles run at up to 36 mrad, where contact jumps on the flange too."""
    axle = wheels_of(tmp_path)["axle_2"]
    assert axle.wheels.nearest == pytest.approx(9.0)
    assert len(axle.contact.grid.middles) == 3
    assert largest_attack(1 / 250, 9.0) == pytest.approx(0.036)
    assert largest_attack(1 / 250, 1.8) == largest_attack(1 / 250) == pytest.approx(0.008)


def test_wheels_that_exceed_their_angle_are_told(tmp_path):
    axle = wheels_of(tmp_path, ", angle_of_attack: 5 mrad")["axle_1"]
    assert len(axle.contact.grid.middles) == 2
    known = {"axle_1.angle_of_attack": np.array([0.0, -0.0196, 0.01])}
    (remark,) = attack_remarks([axle], known)
    assert "19.6 mrad" in remark and "rail_contact.angle_of_attack: 20 mrad" in remark
    known["axle_1.angle_of_attack"] *= 0.5
    assert not list(attack_remarks([axle], known))
    assert not list(attack_remarks([axle], {}))
