"""Derivatives of what the suspension rig shows, against a linear system by hand."""

import numpy as np
import pytest

import vehicledyn as vd
from vehicledyn.base.errors import InputError

COMPLIANT = """
title: A carrier in one bushing
gravity: [0, 0, 0]
parameters:
  bushing: {place: [0.05 m, 0.5 m, 0.35 m], x: 2 MN/m, y: 5 MN/m, z: 0.1 MN/m}
  wheel: {y: 0.7 m, z: 0.3 m, radius: 0.3 m}
bodies:
  chassis: {joints: [T3 height], mass: 500 kg}
  carrier:
    parent: chassis
    at: [0.1 m, wheel.y, wheel.z]
    joints: [free]
    mass: 20 kg
    inertia: [0.5 kg*m^2, 0.6 kg*m^2, 0.5 kg*m^2]
bushings:
  block:
    a: {body: chassis, point: bushing.place}
    b:
      body: carrier
      point: ["bushing.place.x - 0.1 m", bushing.place.y - wheel.y, bushing.place.z - wheel.z]
    stiffness: [bushing.x, bushing.y, bushing.z]
    turning_stiffness: [40 kN*m/rad, 60 kN*m/rad, 30 kN*m/rad]
sensors:
  wheel:
    {kind: wheel_angles, body: carrier, axis: [0, 1, 0], radius: wheel.radius, seen_from: chassis}
"""
NAMES = ["bushing.place.x", "bushing.place.y", "bushing.place.z"]
NAMES += ["bushing.x", "bushing.y", "bushing.z", "wheel.y", "wheel.z", "wheel.radius"]
VALUES = np.array([0.05, 0.5, 0.35, 2e6, 5e6, 1e5, 0.7, 0.3, 0.3])
LOADS = {"lateral": (1, "side_force"), "longitudinal": (0, "longitudinal_force")}


def _by_hand(values, axis):
    """Return steer compliance, camber compliance, and the pad's force for a force at the contact.

    The height of the contact point is held by the pad; six springs act at the bushing.
    """
    place, stiffness, (y, z, radius) = values[:3], values[3:6], values[6:]
    force = np.eye(3)[axis]
    arm = np.array([place[0] - 0.1, place[1] - y, place[2] - z])
    cross = np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])
    lever = np.hstack([np.eye(3), -cross])
    turning = np.hstack([np.zeros((3, 3)), np.eye(3)])
    matrix = lever.T @ np.diag(stiffness) @ lever + turning.T @ np.diag([4e4, 6e4, 3e4]) @ turning
    held = np.eye(6)[2:3]
    matrix = np.block([[matrix, -held.T], [held, np.zeros((1, 1))]])
    couple = np.array([radius * force[1], -radius * force[0], 0.0])
    found = np.linalg.solve(matrix, [*force, *couple, 0.0])
    return np.array([found[5], -found[3], found[6]])


@pytest.mark.parametrize("test", LOADS)
def test_compliances_of_a_bushing_follow_the_linear_system(tmp_path, test):
    path = tmp_path / "compliant.yaml"
    path.write_text(COMPLIANT, encoding="utf-8")
    axis, control = LOADS[test]
    of = [f"rig(wheel.{name}, {test})" for name in ("steer_compliance", "camber_compliance")]
    last = {"lateral": "roll_centre_height", "longitudinal": "brake_support_angle"}[test]
    found = vd.sensitivity(path, [*of, f"rig(wheel.{last}, {test})"])
    assert list(found["figure"].values)[2] == f"wheel.{last} at {control} = 0 N"
    names = list(found["parameter"].values)
    columns = [names.index(name) for name in NAMES]
    exact = []
    for k in range(len(VALUES)):
        step = np.zeros(len(VALUES), dtype=complex)
        step[k] = 1e-40j
        moved = VALUES + step
        steer, camber, pad = _by_hand(moved, axis)
        own = {"lateral": -moved[6] * pad, "longitudinal": np.arctan(-pad)}[test]
        exact.append(np.array([steer, camber, own]).imag / 1e-40)
    exact = np.array(exact).T
    slopes = found["figure_slope"].values[:, columns]
    size = np.abs(exact * VALUES).max(axis=1, keepdims=True) / VALUES
    assert np.abs(slopes - exact) / size == pytest.approx(0.0, abs=1e-11)


@pytest.mark.parametrize(
    ("of", "to", "match"),
    [
        ("rig(wheel.toe_gain)", "*", r"write rig\(QUANTITY, TEST"),
        ("rig(wheel.toe_gian, parallel)", "*", r"did you mean 'wheel\.toe_gain'"),
        ("rig(wheel.toe_gain, paralel)", "*", "did you mean 'parallel'"),
        ("rig(wheel.toe_gain, parallel, 5 N)", "*", "values of travel"),
        ("rig(wheel.toe_gain, parallel, 0 mm, traval=1 mm)", "*", "did you mean 'travel'"),
        ("rig(wheel.toe_gain, parallel, travel=1 mm, travel=2 mm)", "*", "given twice"),
        ("rig(wheel.toe_gain, parallel)", "start.chassis.height", "no start values"),
        ("rig(wheel.toe_gain, parallel)", "lower.bal.x", r"did you mean 'lower\.ball\.x'"),
        ("rig(wheel.toe_angle, parallel, 900 mm)", "*", "no place at travel|cannot be closed"),
        (["rig(wheel.toe_gain, parallel)", "wheel.toe_angle"], "*", "one after the other"),
    ],
)
def test_names_are_checked(of, to, match):
    with pytest.raises((InputError, vd.NumericalError), match=match):
        vd.sensitivity("double_wishbone_suspension", of, to)


STOP = """
title: A carrier on a spring and a stop that begins to touch
gravity: [0, 0, 0]
parameters: {spring: 20 kN/m, stop: 50 kN/m, place: 10 mm}
bodies:
  chassis: {joints: [T3 height], mass: 500 kg}
  carrier:
    parent: chassis
    at: [0 m, 0.7 m, 0.3 m]
    joints: [T3 travel]
    mass: 20 kg
forces:
  spring:
    coordinate: carrier.travel
    force: -spring * position - stop * max(position - place, 0 m)
sensors:
  wheel: {kind: wheel_angles, body: carrier, axis: [0, 1, 0], radius: 0.3 m, seen_from: chassis}
"""


def test_a_stop_that_begins_to_touch_has_no_derivative(tmp_path):
    """A wheel rate jumps there, the derivative of a load too; toe does not feel it."""
    path = tmp_path / "stop.yaml"
    path.write_text(STOP, encoding="utf-8")
    of = [f"rig(wheel.{n}, parallel, 9 mm:10 mm:1)" for n in ("wheel_rate", "load", "toe_angle")]
    with pytest.warns(vd.AccuracyWarning, match="corner here, such as a stop"):
        found = vd.sensitivity(path, of, ["spring", "place"])
    slopes = found["figure_slope"].values
    assert slopes[[0, 2, 4, 5]] == pytest.approx(np.array([[1, 0], [9e-3, 0], [0, 0], [0, 0]]))
    assert np.isnan(slopes[[1, 3]]).all()


def test_the_rig_tells_where_slopes_jump(tmp_path):
    """At the stop the wheel rate is 20 N/mm below and 70 N/mm above, and shown between them."""
    path = tmp_path / "stop.yaml"
    path.write_text(STOP, encoding="utf-8")
    match = "10 mm .*wheel_rate' jumps there between 20 and 70 N"
    with pytest.warns(vd.AccuracyWarning, match=match):
        found = vd.rig(path, "parallel", "0 mm:20 mm:4")
    assert found["wheel.wheel_rate"].values == pytest.approx([20e3, 20e3, 45e3, 70e3, 70e3])
    assert len(found.notes) == 1
    away = vd.rig(path, "parallel", "1 mm:9.9 mm:4")
    assert not away.notes


def test_wheels_that_cannot_rise_are_refused(tmp_path):
    path = tmp_path / "rigid.yaml"
    path.write_text(STOP.replace("T3 travel", "T1 travel"), encoding="utf-8")
    with pytest.raises(InputError, match="nothing lets the wheel of 'wheel' rise"):
        vd.rig(path, "parallel")


def test_each_name_has_figures_of_its_own(tmp_path):
    """Studies count them: a pattern beside a name must not pass for one figure."""
    path = tmp_path / "stop.yaml"
    path.write_text(STOP, encoding="utf-8")
    of = ["rig(wheel.wheel_rate, parallel, 0 mm:5 mm:1)", "rig(wheel.wheel_rate, parallel, 5 mm)"]
    assert vd.sensitivity(path, of, "spring")["figure_value"].shape == (3,)
