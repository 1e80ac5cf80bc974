"""System files with quaternions: equilibrium and modes."""

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import find_equilibrium, find_modes
from vehicledyn.files.scenario import load_model

BALL = "{kind: spherical_quaternion, start: [0.9, 0.3, 0.2, 0.1]}"
TURNS = "{kind: spherical, sequence: [3, 2, 1]}"
PLATE = """
title: A plate that hangs on a ball joint and carries a pendulum
bodies:
  plate: {{joints: [{joint}], mass: 2 kg, com: [0.1 m, 0, -0.5 m], inertia: [0.2 kg*m^2,
        0.3 kg*m^2, 0.25 kg*m^2]}}
  arm:
    parent: plate
    at: [0, 0, -1 m]
    joints: [R2 angle]
    mass: 0.5 kg
    com: [0, 0, -0.4 m]
    inertia: [0.05 kg*m^2, 0.05 kg*m^2, 0.02 kg*m^2]
"""


def quiet(*_):
    """Show no progress."""


@pytest.fixture
def plate(tmp_path):
    def load(joint):
        path = tmp_path / "plate.yaml"
        path.write_text(PLATE.format(joint=joint), encoding="utf-8")
        return load_model(str(path))

    return load


def test_equilibrium_turns_the_body_in_every_direction(plate):
    found = find_equilibrium(plate(BALL), speed=None, backend="interpreted", progress=quiet)
    rows = {row.name: row.equilibrium for row in found.coordinates}
    q = np.array([rows[f"plate.quaternion_{c}"] for c in "wxyz"])
    assert np.linalg.norm(q) == pytest.approx(1.0, abs=1e-14)
    w, x, y, z = q
    down = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z])
    arm = np.array([np.sin(rows["arm.angle"]), 0.0, np.cos(rows["arm.angle"])])
    # The arm hangs down, and the centre of mass of both below the joint.
    assert arm == pytest.approx(down, abs=1e-8)
    whole = 2.0 * np.array([0.1, 0.0, -0.5]) - 0.5 * np.array([0.0, 0.0, 1.0]) - 0.2 * down
    assert np.cross(whole, down) == pytest.approx(np.zeros(3), abs=1e-8)
    assert "plate.quaternion_w" in found.as_text() and "mm" not in found.as_text()


def test_modes_are_those_of_three_turns(plate):
    found = [
        find_modes(
            plate(joint), speeds=[], backend="interpreted", progress=quiet, start="static"
        ).speeds[0]
        for joint in (BALL, TURNS)
    ]
    frequencies = [sorted(mode.frequency for mode in case.modes) for case in found]
    assert frequencies[0] == pytest.approx(frequencies[1], abs=1e-7)
    assert [mode.kind for mode in found[0].modes].count("oscillation") == 3
