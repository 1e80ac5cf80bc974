"""Every kind of joint, law, cut, constraint and sensor that a system file may name."""

import re

import numpy as np
import pytest
from element_examples import ELEMENTS
from joint_examples import described
from system_texts import Motion, equations, load, problems

import vehicledyn.catalogue
from vehicledyn.base.registry import find, kinds
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.building.python_systems import system_as_yaml
from vehicledyn.files.system.kinds import load_kinds
from vehicledyn.multibody import derive
from vehicledyn.symbolic import ops, rotations

assert vehicledyn.catalogue
load_kinds()

MASS = "mass: 2 kg, inertia: [0.3 kg*m^2, 0.4 kg*m^2, 0.5 kg*m^2]"
TRACK = "track: {kind: straight, gauge: 1 m, inclination: 0, rail: 60E1}\n"
OF_ONE_COORDINATE = [kind for kind in kinds("joint_type") if not find("joint_type", kind).elements]
"""Joints whose example is the one that stands in ``joint_examples``."""
JOINTS = {
    **{
        kind: f"{{{', '.join(f'{k}: {v}' for k, v in described(kind, name='q').items())}}}"
        for kind in OF_ONE_COORDINATE
    },
    "turn": "{kind: turn, axis: 3, angle: 90 deg}, R2 q",
    "spherical": "{kind: spherical, sequence: [1, 2, 3]}",
    "free": "free",
    "universal": "{kind: universal, axes: [3, 1]}",
    "cylindrical": "{kind: cylindrical, axis: 3}",
    "planar": "{kind: planar, normal: 2}",
    "spherical_quaternion": "{kind: spherical_quaternion, start_rate: [0, 1 rad/s, 20 deg/s]}",
    "track_frame": "{kind: track_frame, position: 3 m/s * time}, R1 q",
}
COORDINATES = {
    **{key: ["q"] for key in (*OF_ONE_COORDINATE, "turn", "track_frame")},
    "spherical": ["roll", "pitch", "yaw"],
    "free": ["x", "y", "z", "yaw", "pitch", "roll"],
    "universal": ["yaw", "roll"],
    "cylindrical": ["z", "yaw"],
    "planar": ["x", "z", "pitch"],
    "spherical_quaternion": [],
}


def test_joint_with_a_quaternion_has_its_components_and_an_angular_velocity(tmp_path):
    text = (
        f"title: t\nmirror:\n- plane: y\n  names: {{left: right}}\n  bodies:\n"
        f"    left: {{joints: [T1, {{kind: spherical_quaternion, start: [2, 1, 0.5, 0], "
        f"start_rate: [1 rad/s, 60 deg/s, 0]}}], {MASS}}}\n"
        "initial: {left.quaternion_w: 3, right.omega_z: 5 rad/s}\n"
    )
    start = {s.name: s.start for s in equations(tmp_path, text).states}
    assert [start[f"left.quaternion_{c}"] for c in "wxyz"] == [3.0, 1.0, 0.5, 0.0]
    assert [start[f"right.quaternion_{c}"] for c in "wxyz"] == [2.0, -1.0, 0.5, 0.0]
    assert [start[f"left.omega_{c}"] for c in "xyz"] == pytest.approx([1.0, np.pi / 3.0, 0.0])
    assert [start[f"right.omega_{c}"] for c in "xyz"] == pytest.approx([-1.0, np.pi / 3.0, 5.0])


@pytest.mark.parametrize(
    ("joint", "told"),
    [
        ("{kind: screw, axis: 3}", "b.joints[0].lead: missing: Advance in one turn"),
        ("{kind: screw, axis: 4, lead: 1 mm}", "b.joints[0].axis: must be 1, 2 or 3, is '4'"),
        ("{kind: screw, axis: 3, lead: 5 kg}", "b.joints[0].lead: this is in kg, a quantity in m"),
        ("{kind: T1, reflected_inertia: 1 kg*m^2}", "in kg*m^2, a quantity in kg"),
        ("{kind: screw, axis: 3, lead: 1 mm, reflected_inertia: 1 kg}", "quantity in kg*m^2"),
        ("{kind: R1, reflected_inertia: -1 kg*m^2}", "reflected_inertia: "),
        ("{kind: spherical_quaternion, start: [1, 0, 0]}", "b.joints[0].start: it has 4 numbers"),
        ("{kind: spherical_quaternion, start_rate: [1 m, 0, 0]}", "start_rate[0]: this is in m"),
    ],
)
def test_joint_with_a_mistake_is_refused(joint, told, tmp_path):
    found = problems(tmp_path, f"title: t\nbodies: {{b: {{joints: [{joint}], {MASS}}}}}\n")
    assert len(found) == 1 and told in found[0]


@pytest.mark.parametrize("kind", kinds("joint"))
def test_joint(kind, tmp_path):
    text = f"title: t\n{TRACK}bodies: {{b: {{joints: [{JOINTS[kind]}], {MASS}}}}}\n"
    e = equations(tmp_path, text)
    assert [e.states[k].name for k in e.positions] == [f"b.{n}" for n in COORDINATES[kind]]


def test_reflected_inertia(tmp_path):
    """In a file, in mirror images, and as of a system from Python."""

    def read(rotor, screw, slide):
        joints = (
            f"{{kind: R2, name: a{rotor}}}, {{kind: T1, name: b{slide}}}, "
            f"{{kind: screw, axis: 3, lead: 1 mm, name: c{screw}}}"
        )
        return build_system(load(tmp_path, (
            "title: t\nparameters: {rotor: {value: 5 kg*m^2, above: 0}}\n"
            f"mirror: [{{plane: y, names: {{left: right}}, bodies: {{left: {{joints: [{joints}], "
            f"{MASS}}}}}}}]\n"
        )))  # fmt: skip

    own = ", reflected_inertia: "
    with_own = read(f"{own}4 * rotor", f"{own}2 kg*m^2", f"{own}3 kg")
    for number, unit in ((20.0, "kg*m^2"), (2.0, "kg*m^2"), (3.0, "kg")):
        assert system_as_yaml(with_own).count(f"reflected_inertia: {number} {unit}}}") == 2
    rates = {f"{side}__{name}_rate": 1.0 for side in ("left", "right") for name in "abc"}
    plain, one = (Motion(derive(made)).at(**rates) for made in (read("", "", ""), with_own))
    assert one["energy.kinetic"] - plain["energy.kinetic"] == pytest.approx(20.0 + 3.0 + 2.0)


def test_fixed_turn_turns_the_axis_of_the_joint_after_it(tmp_path):
    text = f"title: t\nbodies: {{b: {{joints: [{JOINTS['turn']}], {MASS}}}}}\n"
    text += "sensors: {p: {kind: point, body: b, point: [0, 0, 1 m]}}\n"
    seen = Motion(equations(tmp_path, text)).at(b__q=0.3)
    assert [seen[f"p.{axis}"] for axis in "xyz"] == pytest.approx(
        [0.0, np.sin(0.3), np.cos(0.3)], abs=1e-15
    )


def test_screw_advances_by_its_lead_and_its_mirror_image_is_left_handed(tmp_path):
    text = (
        "title: t\nparameters: {lead: 8 mm}\n"
        "sensors: {l: {kind: point, body: jack_left}, r: {kind: point, body: jack_right}}\n"
        "mirror:\n- plane: y\n  names: {left: right}\n  bodies:\n"
        "    jack_left: {at: [0, 1 m, 0], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2, "
        "1 kg*m^2], joints: "
        "[{kind: screw, axis: 3, lead: lead, name: turn, start: 90 deg}]}\n"
    )
    e = equations(tmp_path, text)
    assert {s.name: s.start for s in e.states} == pytest.approx(
        {
            "jack_left.turn": np.pi / 2.0,
            "jack_right.turn": -np.pi / 2.0,
            "jack_left.turn_rate": 0.0,
            "jack_right.turn_rate": 0.0,
        }
    )
    start = {s.name.replace(".", "__"): s.start for s in e.states}
    seen = Motion(e).at(**start)
    assert [seen["l.z"], seen["r.z"]] == pytest.approx([0.002, 0.002])
    assert [seen["l.y"], seen["r.y"]] == pytest.approx([1.0, -1.0])


LAWS = {
    "spring_damper": (
        "{kind: spring_damper, stiffness: 30 N/m, damping: 4 N*s/m, free_length: 2 m, "
        "preload: 5 N}",
        lambda z, v: 5.0 + 30.0 * (z - 2.0) + 4.0 * v,
    ),
    "constant": ("{kind: constant, amount: 7 N}", lambda z, v: 7.0),
    "polynomial": (
        "{kind: polynomial, stiffness: [3 N/m, 0, 2 N/m^3], damping: [0, 4 N*s^2/m^2], "
        "free_length: 1 m}",
        lambda z, v: 3.0 * (z - 1.0) + 2.0 * (z - 1.0) ** 3 + 4.0 * v**2,
    ),
    "table": (
        "{kind: table, lengths: [1 m, 2 m, 3 m], forces: [0, 10 N, 40 N], damping: 2 N*s/m}",
        lambda z, v: (10.0 * (z - 1.0) if z < 2.0 else 10.0 + 30.0 * (z - 2.0)) + 2.0 * v,
    ),
    "expression": (
        "{kind: expression, force: 'where(rate < 0, 6 N*s/m, 2 N*s/m) * rate + 3 N * length/1 m'}",
        lambda z, v: (6.0 if v < 0.0 else 2.0) * v + 3.0 * z,
    ),
}


@pytest.mark.parametrize("kind", kinds("force_law"))
def test_force_law(kind, tmp_path):
    text, law = LAWS[kind]
    system = f"title: t\nbodies: {{b: {{joints: [T1 q], {MASS}}}}}\nlinks: {{l: {{a: ground, b: b, "
    motion = Motion(equations(tmp_path, system + f"law: {text}}}}}\n"))
    for length in (0.5, 1.7, 2.6, 4.0):
        for rate in (-0.4, 0.9):
            seen = motion.at(b__q=length, b__q_rate=rate)
            assert seen["l.force"] == pytest.approx(law(length, rate), rel=1e-13, abs=1e-13)
            assert seen["d.b.q_rate"] == pytest.approx(-law(length, rate) / 2.0, rel=1e-13)


@pytest.mark.parametrize("kind", kinds("force_law"))
def test_spring_on_a_coordinate_pulls_it_back(kind, tmp_path):
    text, law = LAWS[kind]
    turning = text.replace("N/m^3", "N*m").replace("N/m", "N*m").replace("N*s/m", "N*m*s")
    turning = turning.replace("N*s^2/m^2", "N*m*s^2")
    turning = re.sub(r"(\d) m([,\]}])", r"\1 rad\2", turning)
    turning = turning.replace(" N,", " N*m,").replace(" N}", " N*m}").replace(" N]", " N*m]")
    turning = turning.replace("3 N * length/1 m", "3 N*m * length")
    system = (
        f"title: t\nbodies: {{b: {{joints: [R2 q], {MASS}}}}}\nsprings: {{s: {{coordinate: b.q, "
    )
    motion = Motion(equations(tmp_path, system + f"law: {turning}}}}}\n"))
    seen = motion.at(b__q=1.3, b__q_rate=-0.7)
    assert seen["s.force"] == pytest.approx(-law(1.3, -0.7), rel=1e-13)
    assert seen["d.b.q_rate"] == pytest.approx(-law(1.3, -0.7) / 0.4, rel=1e-13)


TIME_LAWS = {
    "constant_rate": ("{kind: constant_rate, rate: 3 m/s, start: 1 m}", lambda t: 1.0 + 3.0 * t),
    "ramp": (
        "{kind: ramp, first: 1 m, last: 3 m, begin: 1 s, duration: 2 s}",
        lambda t: 1.0 + 2.0 * step(min(max((t - 1.0) / 2.0, 0.0), 1.0)),
    ),
    "sine": (
        "{kind: sine, amplitude: 2 m, frequency: 0.5 Hz, phase: 30 deg, offset: 1 m}",
        lambda t: 1.0 + 2.0 * np.sin(np.pi * t + np.pi / 6.0),
    ),
    "expression": (
        "{kind: expression, position: '1 m * exp(-time/2 s) * cos(3 rad/s * time)'}",
        lambda t: np.exp(-t / 2.0) * np.cos(3.0 * t),
    ),
}


def step(s):
    return 10 * s**3 - 15 * s**4 + 6 * s**5


@pytest.mark.parametrize("kind", kinds("time_law"))
def test_time_law_and_its_rate(kind, tmp_path):
    text, law = TIME_LAWS[kind]
    system = (
        f"title: t\nbodies:\n  b: {{joints: [T1 q], {MASS}}}\n  c: {{joints: [T1 q], {MASS}}}\n"
    )
    motion = Motion(
        equations(tmp_path, system + f"drives: {{d: {{coordinate: b.q, law: {text}}}}}")
    )
    for t in (0.0, 0.5, 1.3, 2.2, 3.5):
        seen, h = motion.at(t), 1e-5
        assert seen["b.q"] == pytest.approx(law(t), rel=1e-13, abs=1e-13)
        slope = (law(t + h) - law(t - h)) / (2.0 * h)
        assert seen["b.q_rate"] == pytest.approx(slope, rel=1e-6, abs=1e-7)


FOUR_BAR = """\
title: t
bodies:
  crank: {joints: [R2 angle], mass: 1 kg, inertia: [0.1 kg*m^2, 0.1 kg*m^2, 0.1 kg*m^2]}
  rocker: {at: [4 m, 0, 0], joints: [R2 angle], mass: 1 kg, inertia: [0.1 kg*m^2, 0.1 kg*m^2,
        0.1 kg*m^2]}
  coupler: {parent: crank, at: [0, 0, 1 m], joints: [{kind: R2, name: angle, start: 1 rad}],
            mass: 1 kg, inertia: [0.1 kg*m^2, 0.1 kg*m^2, 0.1 kg*m^2]}
initial: {crank.angle: 0.2 rad, rocker.angle: 0.1 rad}
cuts:
"""
CUTS = {
    "ball": "  c: {kind: ball, a: {body: coupler, point: [0, 0, 4 m]}, "
    "b: {body: rocker, point: [0, 0, 2 m]}}\n",
    "rod": "  c: {kind: rod, a: {body: coupler, point: [0, 0, 1 m]}, "
    "b: {body: rocker, point: [0, 0, 2 m]}, length: 2.5 m}\n",
    "body": "  c: {kind: body, a: {body: coupler, point: [0, 0, 4 m]}, "
    "b: {body: end, point: [0, 0, 0]}}\n",
}
END = "  end: {parent: rocker, at: [0, 0, 2 m], joints: [R2 angle]}\n"


@pytest.mark.parametrize("kind", kinds("cut"))
def test_cut(kind, tmp_path):
    text = FOUR_BAR.replace("  coupler:", END + "  coupler:") if kind == "body" else FOUR_BAR
    text += CUTS[kind]
    e = equations(tmp_path, text)
    assert e.structure["degrees_of_freedom"] == (2 if kind == "rod" else 1)
    name = e.states[0].name.replace(".", "__")
    seen = Motion(e).at(**{name: e.states[0].start + 0.01})
    assert seen["constraints.position_error"] < 1e-12
    angles = {n: seen[f"{n}.angle"] for n in ("crank", "coupler", "rocker")}
    along = 1.0 if kind == "rod" else 4.0
    total = angles["crank"] + angles["coupler"]
    end = np.array([np.sin(angles["crank"]), np.cos(angles["crank"])])
    end = end + along * np.array([np.sin(total), np.cos(total)])
    rocker = np.array([4.0, 0.0]) + 2.0 * np.array(
        [np.sin(angles["rocker"]), np.cos(angles["rocker"])]
    )
    gap = np.linalg.norm(end - rocker)
    assert gap == pytest.approx(2.5 if kind == "rod" else 0.0, abs=1e-11)


TWO = (
    "title: t\nbodies:\n  a: {joints: [R3 q], mass: 2 kg, inertia: [0.3 kg*m^2, "
    "0.4 kg*m^2, 0.5 kg*m^2]}\n"
)
TURNING = TWO + "  b: {joints: [R3 q], mass: 2 kg, inertia: [0.3 kg*m^2, 0.4 kg*m^2, 0.5 kg*m^2]}\n"
SLIDING = TWO + "  b: {joints: [T3 q], mass: 2 kg, inertia: [0.3 kg*m^2, 0.4 kg*m^2, 0.5 kg*m^2]}\n"
PLANE = (
    "title: t\nbodies: {b: {joints: [T1 x, T2 y, R3 yaw], mass: 2 kg, "
    "inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}}\n"
)
DISK = "title: t\nbodies: {b: {joints: [{kind: free, sequence: [3, 1, 2]}], mass: 2 kg, "
DISK += "inertia: [1 kg*m^2, 2 kg*m^2, 1 kg*m^2], spins_about: 2}}\ninitial: {b.z: 0.5 m}\n"
CONSTRAINTS = {
    "screw": (SLIDING, "sliding: b.q, turning: a.q, pitch: 10 mm", "b.q", 0.01 / (2 * np.pi)),
    "rack": (SLIDING, "sliding: b.q, turning: a.q, radius: 0.2 m", "b.q", 0.2),
    "gears": (TURNING, "driven: b.q, driving: a.q, ratio: 3/2", "b.q", -1.5),
    "belt": (
        TURNING,
        "driven: b.q, driving: a.q, driven_radius: 0.2 m, driving_radius: 0.3 m",
        "b.q",
        1.5,
    ),
    "expression": (TURNING, "zero: b.q + 2 * a.q", "b.q", -2.0),
    "knife_edge": (PLANE, "body: b, point: [0.5 m, 0, 0], across: [0, 1, 0]", "", 0.0),
    "rate_expression": (
        PLANE,
        "points: {p: {body: b, point: [0.5 m, 0, 0]}}, "
        "zero: cos(b.yaw) * p_velocity.y - sin(b.yaw) * p_velocity.x",
        "",
        0.0,
    ),
    "universal_wheel": (
        PLANE,
        "body: b, axis: 1, radius: 0.1 m, roller_angle: 0 deg, centre: [0, 0.5 m, 0]",
        "",
        0.0,
    ),
    "geneva": (
        TURNING,
        "driver: a.q, wheel: b.q, slots: 12, distance: 80 mm",
        "b.q",
        -np.arctan2(np.sin(0.7), 1.0 / np.sin(np.pi / 12) - np.cos(0.7)) / 0.7,
    ),
    "rolling_wheel": (DISK, "body: b, axis: 2, radius: 0.5 m", "", 0.0),
}


@pytest.mark.parametrize("kind", kinds("constraint"))
def test_constraint(kind, tmp_path):
    text, fields, dependent, ratio = CONSTRAINTS[kind]
    e = equations(tmp_path, text + f"constraints: {{c: {{kind: {kind}, {fields}}}}}\n")
    if dependent:
        assert e.structure["degrees_of_freedom"] == 1
        other = e.states[0].name
        seen = Motion(e).at(
            **{other.replace(".", "__"): 0.7, f"{other.replace('.', '__')}_rate": 2}
        )
        assert seen["b.q"] == pytest.approx(ratio * seen["a.q"], rel=1e-12)
        if kind == "geneva":
            return  # its ratio is not constant
        assert seen["b.q_rate"] == pytest.approx(ratio * seen["a.q_rate"], rel=1e-12)
        return
    rates = {s.name.replace(".", "__"): 0.3 + 0.1 * k for k, s in enumerate(e.states)}
    seen = Motion(e).at(**rates)
    assert seen["constraints.velocity_error"] < 1e-12
    if kind == "universal_wheel":
        along = np.cos(seen["b.yaw"]) * seen["b.x_rate"] + np.sin(seen["b.yaw"]) * seen["b.y_rate"]
        assert along - 0.5 * seen["b.yaw_rate"] == pytest.approx(0.0, abs=1e-12)
    elif kind != "rolling_wheel":
        across = (
            -np.sin(seen["b.yaw"]) * seen["b.x_rate"] + np.cos(seen["b.yaw"]) * seen["b.y_rate"]
        )
        assert across + 0.5 * seen["b.yaw_rate"] == pytest.approx(0.0, abs=1e-12)


FREE = f"title: t\nbodies: {{b: {{joints: [free], {MASS}}}}}\n"
STATE = {"x": 0.1, "y": -0.2, "z": 0.3, "yaw": 0.4, "pitch": -0.5, "roll": 0.6}
RATES = {f"{name}_rate": 1.0 - 0.3 * k for k, name in enumerate(STATE)}
SENSORS = {
    "point": "body: b, point: [0.1 m, 0.2 m, 0.3 m]",
    "rates": "body: b",
    "angles": "body: b, sequence: [1, 2, 3]",
    "body": "body: b",
    "accelerometer": "body: b, point: [0.1 m, 0, 0]",
    "seat": "body: b, point: [0.1 m, 0, 0]",
    "floor": "body: b, point: [0.1 m, 0, 0]",
    "expression": "value: 'b.x * b.y_rate + time * 1 m^2/s^2', unit: m^2/s",
    "wheel_angles": "body: b, centre: [0, 0.1 m, 0], axis: [0, -1, 0], radius: 0.3 m, side: right, "
    "steering_axis: {lower: {body: b, point: [0, 0, -0.1 m]}, upper: {body: b, point: [0, "
    "0, 0.1 m]}}",
    "reaction": "body: b, point: [0.1 m, 0, 0], axes: parent",
    "constraint_force": "constraint: k, body: b}}\n"
    "constraints: {k: {kind: knife_edge, body: b, across: [0, 1, 0]",
}

PUSHED = f"title: t\ngravity: [0, 0, 0]\nbodies: {{b: {{joints: [T1 x, T2 y, T3 z], {MASS}}}}}\n"


@pytest.mark.parametrize("kind", kinds("element"))
def test_element(kind, tmp_path):
    fields, force = ELEMENTS[kind]
    text = PUSHED + f"elements: {{e: {{kind: {kind}, {fields}}}}}\n"
    seen = Motion(equations(tmp_path, text)).at(2.0, b__x=0.3, b__x_rate=-4.0, b__y_rate=0.7)
    free = [axis for axis in "xyz" if f"d.b.{axis}_rate" in seen]
    assert len(free) == (2 if kind == "cam_joint" else 3)
    rates = [2.0 * seen[f"d.b.{axis}_rate"] for axis in free]
    assert rates == pytest.approx(force(seen)[: len(free)], rel=1e-13, abs=1e-13)


@pytest.mark.parametrize("kind", kinds("sensor"))
def test_sensor(kind, tmp_path):
    text = FREE + f"sensors: {{s: {{kind: {kind}, {SENSORS[kind]}}}}}\n"
    states = {f"b__{name}": value for name, value in {**STATE, **RATES}.items()}
    motion = Motion(equations(tmp_path, text))
    if kind == "constraint_force":
        states = {k: v for k, v in states.items() if k != "b__y_rate"}
    seen = motion.at(2.0, **states)
    assert any(name.startswith("s") for name in seen)
    assert all(np.isfinite(value) for value in seen.values())
    turn = rotations.turn(3, 0.4) @ rotations.turn(2, -0.5) @ rotations.turn(1, 0.6)
    turned = ops.numeric([], turn)()
    if kind == "point":
        where = np.array([0.1, -0.2, 0.3]) + turned @ np.array([0.1, 0.2, 0.3])
        assert [seen[f"s.{a}"] for a in "xyz"] == pytest.approx(where, rel=1e-13)
        h = 1e-6
        after = motion.at(
            2.0, **{k: v + h * states.get(f"{k}_rate", 0.0) for k, v in states.items()}
        )
        slope = [(after[f"s.{a}"] - seen[f"s.{a}"]) / h for a in "xyz"]
        assert [seen[f"s.velocity_{a}"] for a in "xyz"] == pytest.approx(slope, abs=1e-5)
        fall = motion.at(2.0, **{k: v for k, v in states.items() if not k.endswith("_rate")})
        assert fall["s.acceleration_z"] == pytest.approx(-9.81, rel=1e-12)
    if kind == "rates":
        # The yaw rate is about the vertical, the roll rate about the body's own axis.
        about_z = turned.T @ np.array([0.0, 0.0, seen["b.yaw_rate"]])
        roll = np.array([seen["b.roll_rate"], 0.0, 0.0])
        pitch = np.array([0.0, np.cos(0.6), -np.sin(0.6)]) * seen["b.pitch_rate"]
        found = [seen[f"s.angular_velocity_{a}"] for a in "xyz"]
        assert found == pytest.approx(about_z + roll + pitch, rel=1e-12)
    if kind == "floor":
        # What falls freely without turning feels nothing: less the weight that is taken off.
        still = motion.at(2.0, **{k: v for k, v in states.items() if not k.endswith("_rate")})
        found = [still[f"s.{word}"] for word in ("longitudinal", "lateral", "vertical")]
        assert found == pytest.approx([0.0, 0.0, -9.81], abs=1e-12)
        rolling = seen["b.roll_rate"] - np.sin(-0.5) * seen["b.yaw_rate"]
        assert seen["s.roll_rate"] == pytest.approx(rolling, rel=1e-12)
    if kind == "wheel_angles":
        steer = np.arctan2(-turned[0, 1], turned[1, 1])
        assert [seen["s.steer_angle"], seen["s.toe_angle"]] == pytest.approx([steer] * 2, rel=1e-12)
        assert seen["s.z"] == pytest.approx(0.3 + 0.1 * turned[2, 1], rel=1e-12)
    if kind == "expression":
        assert seen["s"] == pytest.approx(0.1 * seen["b.y_rate"] + 2.0, rel=1e-13)
