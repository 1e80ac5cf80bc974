"""Starts that the constraints do not allow are moved, and the run tells which and where to."""

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses import run_scenario
from vehicledyn.files.scenario import load_scenario
from vehicledyn.results.store.reader import open_result

DISK = """
title: A disk on the ground whose coordinates may all move
bodies:
  disk:
    joints: [T1 x, T2 y, T3 z, R3 yaw, R1 lean, R2 spin]
    mass: 1 kg
    inertia: [0.06 kg*m^2, 0.12 kg*m^2, 0.06 kg*m^2]
constraints:
  contact: {kind: rolling_wheel, body: disk, axis: 2, radius: 0.5 m}
"""
ROLL = """
title: It rolls for a moment
model: disk.yaml
initial: {disk.lean: 0.5 rad, disk.spin_rate: 4 rad/s}
duration: 20 ms
solver: {kind: rk4, step: 1 ms}
output: {interval: 10 ms}
"""


def run(folder, *changes, model=DISK):
    (folder / "disk.yaml").write_text(model)
    (folder / "roll.yaml").write_text(ROLL)
    outcome = run_scenario(
        load_scenario(folder / "roll.yaml", changes),
        output=folder / "roll.h5",
        backend="interpreted",
        progress=lambda *_: None,
    )
    with open_result(outcome.path) as result:
        first = result.as_frame().iloc[0]
    told = [line for line in outcome.messages if line.startswith("start moved")]
    return told, first


def test_both_height_and_lean_are_moved_and_told(tmp_path):
    told, first = run(tmp_path, "initial.disk.z=0.5 m")
    assert first["disk.z"] == pytest.approx(0.5 * np.cos(first["disk.lean"]), abs=1e-12)
    assert abs(first["disk.lean"] - 0.5) > 0.01
    lean = f"'disk.lean' from 28.65 deg to {np.rad2deg(first['disk.lean']):.4g} deg"
    (line,) = told
    assert f"'disk.z' from 0.5 m to {first['disk.z']:.4g} m, {lean};" in line


def test_start_that_fits_needs_no_word(tmp_path):
    told, first = run(tmp_path, f"initial.disk.z={0.5 * np.cos(0.5):.17g} m")
    assert not told
    assert first["disk.lean"] == pytest.approx(0.5, abs=1e-12)


def test_independent_coordinate_keeps_its_start(tmp_path):
    kept = DISK.replace("R1 lean", "{kind: R1, name: lean, role: independent}")
    told, first = run(tmp_path, "initial.disk.z=0.5 m", model=kept)
    assert first["disk.lean"] == pytest.approx(0.5, abs=1e-15)
    assert ["lean" in line for line in told] == [False]
