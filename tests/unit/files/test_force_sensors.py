"""Sensors of reactions and constraint forces in system files, and units of multipliers."""

import subprocess
import sys

import numpy as np
import pytest
from system_texts import Motion, equations, problems

TEXT = """
title: t
parameters: {length: 0.5 m}
bodies:
  cart: {joints: [T1 x], mass: 2 kg}
  rod: {parent: cart, at: [0, 0, 0.1 m], joints: [R2 a], mass: 1 kg, com: [0, 0, -length],
        inertia: [0.02 kg*m^2, 0.02 kg*m^2, 0]}
  bead: {joints: [T1 x, T2 y], mass: 0.1 kg}
constraints:
  rope: {kind: expression, points: {tip: bead}, zero: "norm(tip - [0, 0, 1 m]) - 2 m"}
  turn: {kind: expression, zero: "rod.a - 2 rad/m * cart.x"}
initial: {bead.x: 1 m, bead.y: 1.4142135623730951 m}
sensors:
"""


def test_reaction_in_all_axes_and_about_points(tmp_path):
    text = TEXT + (
        "  w: {kind: reaction, body: rod}\n"
        "  b: {kind: reaction, body: rod, axes: body, point: [0, 0, -length]}\n"
        "  p: {kind: reaction, body: rod, axes: parent, of: parent}\n"
        "  f: {kind: reaction, body: cart, shows: [force]}\n"
    )
    e = equations(tmp_path, text)
    seen = Motion(e).at()
    names = {c.name: c for c in e.channels}
    assert names["b.torque_y"].unit == "N*m"
    assert [names[f"{k}.force_x"].frame for k in "wbp"] == ["world", "rod", "cart"]
    assert "f.torque_x" not in names
    w, b, p = ({q: np.array([seen[f"{k}.{q}_{a}"] for a in "xyz"]) for q in ("force", "torque")}
               for k in "wbp")  # fmt: skip
    turn = seen["rod.a"]
    rotation = np.array(
        [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    )
    assert rotation @ b["force"] == pytest.approx(w["force"], abs=1e-12)
    arm = np.array([0.0, 0.0, -0.5])
    assert b["torque"] == pytest.approx(
        rotation.T @ w["torque"] - np.cross(arm, rotation.T @ w["force"]), abs=1e-12
    )
    assert p["force"] == pytest.approx(w["force"], abs=1e-12)
    assert p["torque"] == pytest.approx(w["torque"], abs=1e-12)
    assert seen["f.force_z"] == pytest.approx(3.0 * 9.81, rel=0.2)


def test_multipliers_have_the_unit_that_their_expressions_give_them(tmp_path):
    text = TEXT + "  r: {kind: constraint_force, constraint: rope, body: bead, shows: [force]}\n"
    e = equations(tmp_path, text)
    channels = {c.name: c for c in e.channels}
    assert channels["rope.multiplier"].unit == "N"
    assert channels["turn.multiplier"].unit == "N*m"
    assert "∂h/∂q" in channels["rope.multiplier"].description
    seen = Motion(e).at()
    force = [seen[f"r.force_{a}"] for a in "xyz"]
    along = np.array([1.0, np.sqrt(2.0), -1.0]) / 2.0
    assert force == pytest.approx(seen["rope.multiplier"] * along, abs=1e-13)


@pytest.mark.parametrize(
    ("zero", "unit"),
    [
        ("bead.x * bead.y - 1 m^2", "N/m"),
        ("bead.x / bead.y - 1", "N*m"),
        ("sqrt(bead.x * bead.y) - 1 m", "N"),
    ],
)
def test_units_of_other_multipliers(zero, unit, tmp_path):
    text = (
        "title: t\nbodies: {bead: {joints: [{kind: T1, name: x, start: 1 m}, "
        "{kind: T2, name: y, start: 1 m}], mass: 1 kg}}\n"
        f"constraints: {{wire: {{kind: expression, zero: {zero}}}}}\n"
    )
    (channel,) = (c for c in equations(tmp_path, text).channels if c.name == "wire.multiplier")
    assert channel.unit == unit


@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        ("{kind: reaction, body: rood}", "no body named 'rood'; did you mean 'rod'"),
        ("{kind: reaction, body: ground}", "needs no force"),
        ("{kind: reaction, body: rod, axes: wheel}", "axes"),
        ("{kind: reaction, body: rod, point: [1 kg, 0, 0]}", "a quantity in m is needed"),
        ("{kind: constraint_force, constraint: rop, body: bead}", "did you mean 'rope'"),
        ("{kind: constraint_force, constraint: rope, body: rod}", "'rope' acts on 'bead'"),
        ("{kind: constraint_force, constraint: turn, body: rod}", "acts on coordinates"),
    ],
)
def test_mistakes_are_told_with_their_place(sensor, message, tmp_path):
    found = problems(tmp_path, f"{TEXT}  s: {sensor}\n")
    assert len(found) == 1
    assert found[0].startswith("14:")
    assert "sensors.s" in found[0]
    assert message in found[0]


def test_reading_system_files_loads_nothing_heavy():
    code = (
        "import sys; from vehicledyn.files.system.kinds import load_kinds; load_kinds(); "
        "print(sorted({'casadi', 'h5py', 'matplotlib', 'numpy', 'pandas'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"
