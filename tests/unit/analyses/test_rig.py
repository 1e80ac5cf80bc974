"""The suspension rig against closed geometry, virtual work and a linear solution by hand."""

import re
from pathlib import Path

import numpy as np
import pytest

import vehicledyn as vd

pytestmark = pytest.mark.long

SYSTEMS = Path(__file__).parents[3] / "systems"

COMPLIANT = """
title: A carrier in one bushing
gravity: [0, 0, 0]
bodies:
  chassis: {joints: [T3 height], mass: 500 kg}
  carrier:
    parent: chassis
    at: [0.1 m, 0.7 m, 0.3 m]
    joints: [free]
    mass: 20 kg
    inertia: [0.5 kg*m^2, 0.6 kg*m^2, 0.5 kg*m^2]
bushings:
  block:
    a: {body: chassis, point: [0.05 m, 0.5 m, 0.35 m]}
    b: {body: carrier, point: [-0.05 m, -0.2 m, 0.05 m]}
    stiffness: [2 MN/m, 5 MN/m, 0.1 MN/m]
    turning_stiffness: [40 kN*m/rad, 60 kN*m/rad, 30 kN*m/rad]
sensors:
  wheel: {kind: wheel_angles, body: carrier, axis: [0, 1, 0], radius: 0.3 m, seen_from: chassis}
"""
ARM = np.array([0.05, 0.2, -0.05])
"""Wheel centre from the bushing."""
RADIUS = 0.3


def rig(model, test, values=None, **more):
    return vd.rig(model, test, values, **more)


def columns(data, *names):
    return [np.asarray(data[name]) for name in names]


def _cross(v):
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def _by_hand(force, moment):
    """Return place and turn of the wheel centre, and the pad's force, for a load at the contact.

    Six springs at the bushing, the height of the contact point held: a linear system. A turn about
    x or y moves the wheel's lowest point up or down by no more than its square.
    """
    lever = np.hstack([np.eye(3), -_cross(-ARM)])  # bushing's move of that of the centre
    turning = np.hstack([np.zeros((3, 3)), np.eye(3)])
    stiffness = lever.T @ np.diag([2e6, 5e6, 1e5]) @ lever
    stiffness += turning.T @ np.diag([4e4, 6e4, 3e4]) @ turning
    held = np.eye(6)[2:3]
    matrix = np.block([[stiffness, -held.T], [held, np.zeros((1, 1))]])
    couple = np.cross([0.0, 0.0, -RADIUS], force) + moment
    found = np.linalg.solve(matrix, [*force, *couple, 0.0])
    return found[:3], found[3:6], found[6]


@pytest.fixture(scope="module")
def compliant(tmp_path_factory):
    path = tmp_path_factory.mktemp("rig") / "compliant.yaml"
    path.write_text(COMPLIANT, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("test", "unit", "slot", "compliance", "axis"),
    [
        ("lateral", "N", 1, "lateral_compliance", 1),
        ("longitudinal", "N", 0, "longitudinal_compliance", 0),
        ("aligning", "N*m", 5, None, None),
    ],
)
def test_compliance_is_that_of_the_linear_system(compliant, test, unit, slot, compliance, axis):
    load = np.eye(6)[slot]
    move, turn, pad = _by_hand(load[:3], load[3:])
    data = rig(compliant, test, f"0 {unit}")
    steer, camber = (
        float(np.asarray(data[f"wheel.{n}_compliance"])[0]) for n in ("steer", "camber")
    )
    assert steer == pytest.approx(turn[2], rel=1e-6)
    assert camber == pytest.approx(-turn[0], rel=1e-6, abs=1e-6 * abs(turn[2]))
    if compliance is not None:
        contact = move + np.cross(turn, [0.0, 0.0, -RADIUS])
        found = float(np.asarray(data[f"wheel.{compliance}"])[0])
        assert found == pytest.approx(contact[axis], rel=1e-6)
    if test == "lateral":
        height = float(np.asarray(data["wheel.roll_centre_height"])[0])
        assert height == pytest.approx(-0.7 * pad, rel=1e-6)


def test_wheel_travel_is_that_of_the_closed_loops():
    """Against the kinematics of the same suspension, which an independent program confirms."""
    name = str(SYSTEMS / "double_wishbone_suspension.yaml")
    data = rig(name, "parallel", ("-40 mm", "40 mm", 4))
    z = 7.71713371539e-05
    drives = {"wheel.contact_z": (f"{z - 40} mm", f"{z + 40} mm", 4), "rack.displacement": "0 mm"}
    loops = vd.kinematics(name, drives)
    same = {
        "toe_angle": "wheel.toe_angle",
        "camber": "wheel.camber",
        "half_track": "wheel.half_track",
        "scrub_radius": "wheel.scrub_radius",
        "mechanical_trail": "wheel.mechanical_trail",
        "toe_gain": "ratio.wheel.contact_z.wheel.toe_angle",
        "camber_gain": "ratio.wheel.contact_z.wheel.camber",
        "recession": "ratio.wheel.contact_z.wheel.x",
        "roll_centre_height": "roll_centre.wheel.contact_z.wheel",
    }
    for ours, theirs in same.items():
        found, wanted = np.asarray(data[f"wheel.{ours}"]), np.asarray(loops[theirs])
        assert found == pytest.approx(wanted, abs=1e-7), ours
    load, rate = columns(data, "wheel.load", "wheel.wheel_rate")
    shortened, force = (
        np.asarray(loops[n]) for n in ("ratio.wheel.contact_z.strut.length", "strut.force")
    )
    rise = np.asarray(loops["ratio.wheel.contact_z.wheel.z"])
    assert load == pytest.approx(40.0 * 9.81 * rise + force * shortened, rel=1e-6)
    assert rate[2] == pytest.approx(np.gradient(load, 0.02)[2], rel=2e-3)


def test_roll_centre_of_forces_is_that_of_velocities():
    name = str(SYSTEMS / "wishbone_arms_axle.yaml")
    lifted = rig(name, "parallel", "25 mm")
    pushed = rig(name, "lateral", "0 N", travel="25 mm")
    for side in ("left", "right"):
        channel = f"{side}_wheel_angles.roll_centre_height"
        one, other = (float(np.asarray(d[channel])[0]) for d in (lifted, pushed))
        assert one == pytest.approx(other, rel=1e-6)


def test_roll_of_an_axle_is_antisymmetric():
    data = rig(str(SYSTEMS / "wishbone_arms_axle.yaml"), "roll", ("-1 deg", "1 deg", 2))
    stiffness = np.asarray(data["axle.roll_stiffness"])
    assert stiffness[0] == pytest.approx(stiffness[2], rel=1e-9)
    left, right = columns(data, "left_wheel_angles.camber", "right_wheel_angles.camber")
    assert left == pytest.approx(right[::-1], abs=1e-12)


def test_the_instant_axis_is_the_line_through_the_ball_joints(tmp_path):
    """Two ball joints on wishbones: while the strut stands still the carrier turns about them."""
    text = (SYSTEMS / "double_wishbone_suspension.yaml").read_text(encoding="utf-8")
    head, _, _ = text.partition("    steering_axis:")
    (tmp_path / "unnamed.yaml").write_text(head, encoding="utf-8")
    values = ("-10 mm", "10 mm", 2)
    named = rig(str(SYSTEMS / "double_wishbone_suspension.yaml"), "steer", values)
    found = rig(tmp_path / "unnamed.yaml", "steer", values)
    for name in ("caster", "kingpin_inclination", "mechanical_trail", "lateral_offset"):
        wanted = np.asarray(named[f"wheel.{name}"])
        assert np.asarray(found[f"wheel.{name}"]) == pytest.approx(wanted, abs=1e-7), name


@pytest.mark.parametrize(
    ("model", "test", "values", "words"),
    [
        ("double_wishbone_suspension", "twist", None, "no test named 'twist'"),
        ("double_wishbone_suspension", "lateral", "5 mm", "values of side_force"),
        ("four_bar", "parallel", None, "no sensor 'wheel_angles'"),
        ("five_link_suspension", "steer", "0 mm", "no coordinate named 'wheel_rack'"),
    ],
)
def test_refusals(model, test, values, words):
    steering = "wheel_rack" if "wheel_rack" in words else None
    with pytest.raises(vd.InputError, match=words):
        rig(str(SYSTEMS / f"{model}.yaml"), test, values, steering=steering)


def test_beyond_the_travel_the_places_reached_are_kept():
    name = str(SYSTEMS / "double_wishbone_suspension.yaml")
    with pytest.warns(vd.UnfinishedWarning, match="no place at travel"):
        data = rig(name, "parallel", ("0 mm", "900 mm", 9))
    assert data.status == "failed"
    assert 1 < len(np.asarray(data["travel"])) < 10


def test_the_sedan_states_the_steering_gain_of_its_axle():
    data = rig(str(SYSTEMS / "wishbone_arms_axle.yaml"), "steer", "-0.5 mm:0.5 mm:2")
    gains = columns(data, *(f"{side}_wheel_angles.steer_gain" for side in ("left", "right")))
    text = (SYSTEMS / "sedan.yaml").read_text(encoding="utf-8")
    stated = float(re.search(r"steering_gain: \{value: (\S+) rad/m", text)[1])
    assert stated == pytest.approx(np.mean(gains), rel=1e-3)


def test_the_bushed_sedan_stands_on_its_bushings():
    """Its wheels carry its weight, and its bushings what the arms push across, rate by rate."""
    found = vd.equilibrium("bushed_sedan")
    loads = [float(found[name]) for name in found if name.endswith(".tyre.normal_force")]
    assert len(loads) == 4
    assert loads[0] == pytest.approx(loads[1], rel=1e-6)
    assert sum(loads) == pytest.approx(9.81 * 1671.261, rel=1e-4)
    for end, stiffness in (("front", 12e6), ("rear", 1e6)):
        deflection, force = (
            float(found[f"front_axle.left_{end}_bushing.{what}_y"])
            for what in ("deflection", "force")
        )
        assert force == pytest.approx(-stiffness * deflection, rel=1e-12)


def test_stiff_bushings_leave_the_kinematics_of_rigid_arms():
    stiff = {f"parameters.{end}_bushing.stiffness": "1e9 N/m" for end in ("front", "rear")}
    rigid, bushed = (
        rig(str(SYSTEMS / f"{name}_axle.yaml"), "parallel", "-30 mm:30 mm:2", set=changes)
        for name, changes in (("wishbone_arms", {}), ("bushed_wishbones", stiff))
    )
    for name in ("toe_angle", "camber", "half_track", "wheel_rate"):
        column = f"left_wheel_angles.{name}"
        found, wanted = (np.asarray(data[column]) for data in (bushed, rigid))
        assert found == pytest.approx(wanted, rel=1e-3, abs=2e-5), name


def test_the_rig_reports_camber_from_the_front_and_inclination_to_the_vertical():
    """tan of camber is that of the inclination over the cosine of the steer angle (ISO 8855)."""
    table = vd.rig("wishbone_arms_axle", test="steer")
    camber, leant, steer = (
        table[f"left_wheel_angles.{name}"].values
        for name in ("camber", "inclination", "steer_angle")
    )
    assert np.abs(camber - leant).max() > 1e-3
    assert np.tan(camber) * np.cos(steer) == pytest.approx(np.tan(leant), abs=1e-12)
