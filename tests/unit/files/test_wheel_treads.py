"""Wheels with a flat tread in system files: load, moment of the leaning wheel, bad input."""

import numpy as np
import pytest
from system_texts import Motion, equations

from vehicledyn.base.errors import InputError

SYSTEM = """
title: A wheel that leans
bodies:
  hub: {joints: [T3 height, R1 lean], mass: 100 kg}
  wheel:
    parent: hub
    joints: [R2 spin]
    mass: 10 kg
    inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]
    spins_about: 2
wheels:
  w:
    body: wheel
    radius: 0.33 m
    stiffness: 200 kN/m
    width: 0.2 m
    tyre:
      kind: linear
      nominal_load: 4 kN
      longitudinal_stiffness: 80 kN
      cornering_stiffness: 40 kN/rad
      friction: 0.9
road: {kind: flat}
drives: {lean: {coordinate: hub.lean, law: {kind: constant_rate, rate: 0 rad/s, start: 4 deg}}}
"""


def test_a_leaning_cylinder_feels_the_moment_of_its_load(tmp_path):
    """F = k δ_0, at -w² tan γ/(12 δ_0) from the middle of a tread that touches as a whole."""
    motion, lean, depth = Motion(equations(tmp_path, SYSTEM)), np.radians(4.0), 0.012
    seen = motion.at(hub__height=(0.33 - depth) * np.cos(lean))
    load = 200e3 * depth
    assert seen["w.tyre.normal_force"] == pytest.approx(load, rel=1e-9)
    aside = -(0.2**2) * np.tan(lean) / (12.0 * depth)
    across = aside / np.cos(lean) + (0.33 - depth) * np.sin(lean)
    assert seen["w.contact_y"] == pytest.approx(across, abs=1e-9)
    assert seen["hub.lean_force"] == pytest.approx(-load * across, rel=1e-9)


def test_a_tread_is_round_or_flat(tmp_path):
    text = SYSTEM.replace("width: 0.2 m", "width: 0.2 m\n    crown: 0.1 m")
    with pytest.raises(InputError, match="a tread is round by its crown or flat"):
        equations(tmp_path, text)


@pytest.mark.parametrize("shape", ["width: 0.2 m", "crown: 0.1 m"])
def test_a_load_moves_across_the_tread_once(tmp_path, shape):
    """By the tread's shape or by the file's overturning moment."""
    head, _, rest = SYSTEM.replace("width: 0.2 m", shape).partition("    tyre:")
    text = f"{head}    tyre: {{file: passenger_R0394_mf61.tir}}\n{rest[rest.index('road:') :]}"
    with pytest.raises(InputError, match=f"leave the {shape[:5]} out"):
        equations(tmp_path, text)
    equations(tmp_path, text.replace("mf61.tir}", "mf61.tir, scaling: {LMX: 0}}"))
