"""What a system file may say, and how every mistake in it is told."""

import functools
from dataclasses import replace

import jsonschema
import numpy as np
import pytest
from system_texts import Motion, equations, load, problems

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import kinds
from vehicledyn.base.yaml import parse_yaml
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.building.write import model_as_yaml
from vehicledyn.files.system.assemblies.mirror import mirror_image
from vehicledyn.files.system.kinds import load_kinds
from vehicledyn.files.system.schema import system_schema
from vehicledyn.files.system.sets import MirrorSet
from vehicledyn.multibody import derive

load_kinds()

GOOD = """\
title: A crank on a spring
parameters:
  length: 200 mm
  half: length / 2
  hinge: [0, 0, 1 m]
  crank: {mass: {value: 2 kg, description: Mass of the crank}, inertia: 0.1 kg*m^2}
bodies:
  crank:
    at: hinge
    joints: [R2 angle]
    mass: crank.mass
    com: [0, 0, -half]
    inertia: [crank.inertia, crank.inertia, 0]
  tip:
    parent: crank
    at: [0, 0, -length]
    joints: [{kind: T3, name: slide}]
    mass: 1 kg
springs:
  spring: {coordinate: crank.angle, law: {kind: spring_damper, stiffness: 3 N*m/rad}}
drives:
  slide: {coordinate: tip.slide, law: {kind: sine, amplitude: 1 cm, frequency: 2 Hz}}
sensors:
  tip: {kind: point, body: tip}
initial: {crank.angle: 10 deg}
"""


def test_an_inertia_may_be_a_vector_by_its_name(tmp_path):
    named = GOOD.replace("inertia: 0.1 kg*m^2", "inertia: [0.1 kg*m^2, 0.2 kg*m^2, 0.15 kg*m^2]")
    named = named.replace("[crank.inertia, crank.inertia, 0]", "crank.inertia")
    assert problems(tmp_path, named) == []
    values = {p.name: p.value for p in equations(tmp_path, named).parameters}
    assert [values[f"crank.inertia.{axis}"] for axis in "xyz"] == [0.1, 0.2, 0.15]
    (first, *_) = problems(tmp_path, named.replace("inertia: crank.inertia", "inertia: crank.no"))
    assert "no quantity named 'crank.no.x'" in first
    (first,) = problems(tmp_path, named.replace("inertia: crank.inertia", "inertia: 2 * half"))
    assert "expected a list or the name of a vector" in first


def test_good_file_has_no_problems_and_keeps_its_parameters_free(tmp_path):
    e = equations(tmp_path, GOOD)
    assert {p.name: (p.value, p.unit) for p in e.parameters} == {
        "length": (0.2, "m"),
        "hinge.x": (0.0, "m"),
        "hinge.y": (0.0, "m"),
        "hinge.z": (1.0, "m"),
        "crank.mass": (2.0, "kg"),
        "crank.inertia": (0.1, "kg*m^2"),
    }
    description = {p.name: p.description for p in e.parameters}
    assert description["crank.mass"] == "Mass of the crank"
    assert [s.name for s in e.states] == ["crank.angle", "crank.angle_rate"]
    assert e.states[0].start == pytest.approx(np.radians(10.0), rel=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("title: A", "titel: A", ["1:1: title: missing: What the system is, in a sentence",
         "1:1: titel: unknown key; did you mean 'title'?"]),
        ("length / 2", "lenght / 2", ["4:9: parameters.half: no quantity named 'lenght'; did you "
         "mean 'length'? Known: length"]),
        ("length / 2", "half + 1 m", ["4:9: parameters.half: rests on itself: half -> half"]),
        ("length / 2", "length + 1 kg", ["4:9: parameters.half: a quantity in m and one in kg do "
         "not go together"]),
        ("length / 2", "open('x')", ["4:9: parameters.half: no function named 'open'; Known: "
         "abs, acos, asin, atan, atan2, cos, cross, dot, exp, log, max, min, mirror_x, mirror_y, "
         "mirror_z, norm, sign, sin, sqrt, tan, tanh, unit, where"]),
        ("  half:", "  sin: 3\n  half:", ["4:8: parameters.sin: 'sin' has a meaning in "
         "expressions; take another name"]),
        ("  half:", "  a b: 3\n  half:", ["4:8: parameters.a b: 'a b' cannot be a name; use "
         "letters, digits and _"]),
        ("at: hinge", "at: length", ["9:9: bodies.crank.at: expected a vector"]),
        ("at: hinge", "at: [0, 1 kg, 0]", ["9:13: bodies.crank.at[1]: this is in kg, a quantity in "
         "m is needed here"]),
        ("mass: 1 kg", "mass: length", ["18:11: bodies.tip.mass: this is in m, a quantity in kg "
         "is needed here"]),
        ("mass: 1 kg", "mass: 2 * length / length", ["18:11: bodies.tip.mass: this is a pure "
         "number, a quantity in kg is needed here; write numbers with their unit"]),
        ("mass: 1 kg", "mass: 2", ["18:11: bodies.tip.mass: 2 has no unit; write '2 kg'"]),
        ("mass: 1 kg", "mass: 2 kg + 3", ["18:11: bodies.tip.mass: 3 has no unit; write '3 kg'"]),
        ("at: hinge", "at: [0, 1, 0]", ["9:13: bodies.crank.at[1]: 1 has no unit; write '1 m'"]),
        ("10 deg", "0.2", ["25:24: initial.crank.angle: 0.2 has no unit; write '0.2 rad' or "
         "'0.2 deg'"]),
        ("length / 2", "[length, 2, 0]", ["4:9: parameters.half: 2 has no unit; write '2 m'"]),
        ("mass: 1 kg", "mass: -1 kg", ["18:11: bodies.tip.mass: must be greater than 0 kg, is -1"]),
        ("inertia: [crank.inertia, crank.inertia, 0]", "inertia: [1 kg*m^2, 1 kg*m^2, 3 kg*m^2]",
         ["13:14: bodies.crank.inertia: the moments 1, 1, 3 kg m² break the triangle inequality: "
          "the largest exceeds the sum of the other two; where they were identified or hold motors "
          "and gears, say 'apparent_inertia: true'"]),
        ("inertia: [crank.inertia, crank.inertia, 0]", "inertia: [1 kg*m^2, 1 kg*m^2]",
         ["8:3: bodies.crank: the inertia has 3 or 6 elements, not 2"]),
        ("parent: crank", "parent: cranc", ["15:13: bodies.tip.parent: no body named 'cranc'; "
         "did you mean 'crank'? Known: crank, ground, tip"]),
        ("at: hinge", "parent: tip", ["9:13: bodies.crank.parent: the bodies hang on each other: "
         "crank -> tip -> crank"]),
        ("  tip:\n    parent", "  crank:\n    parent", ["14:3: bodies.crank: given twice; the "
         "first is in line 8", "22:23: drives.slide.coordinate: no coordinate named 'tip.slide'; "
         "Known: crank.angle", "24:28: sensors.tip.body: no body named 'tip'; "
         "Known: crank, ground"]),
        ("{kind: T3, name: slide}", "R7", ["17:14: bodies.tip.joints[0].kind: no joint named "
         f"'R7'; Known: {', '.join(kinds('joint'))}"]),
        ("name: slide}", "name: crank.angle}", ["17:14: bodies.tip.joints[0]: coordinate "
         "'crank.angle' is defined twice, first in body 'crank'; give this one a name",
         "22:23: drives.slide.coordinate: no coordinate named 'tip.slide'; Known: crank.angle"]),
        ("name: slide}", "name: slide, role: independent}", ["22:23: drives.slide.coordinate: "
         "'tip.slide' is declared independent and cannot be driven"]),
        ("    mass: 1 kg\nsprings", "springs", []),
        ("coordinate: crank.angle", "coordinate: crank.angel", ["20:24: springs.spring.coordinate:"
         " no coordinate named 'crank.angel'; did you mean 'crank.angle'? Known: crank.angle, "
         "tip.slide"]),
        ("stiffness: 3 N*m/rad", "stiffness: 3 N/m", ["20:75: springs.spring.law.stiffness: this "
         "is in N/m, a quantity in N*m/rad is needed here"]),
        ("kind: spring_damper", "kind: spring", ["20:49: springs.spring.law.kind: no force_law "
         "named 'spring'; did you mean 'spring_damper'? Known: constant, expression, "
         "polynomial, spring_damper, table"]),
        ("frequency: 2 Hz", "frequency: 2 rad/s", ["22:80: drives.slide.law.frequency: this is in "
         "rad/s, a quantity in Hz is needed here"]),
        ("  slide: {coordinate", "  spring: {coordinate", ["22:11: drives.spring: the name is "
         "taken: springs 'spring' has it"]),
        ("initial: {crank.angle", "initial: {crank.angel", ["25:24: initial.crank.angel: no "
         "coordinate named 'crank.angel'; did you mean 'crank.angle'? Known: crank.angle, "
         "crank.angle_rate, tip.slide, tip.slide_rate"]),
        ("initial: {crank.angle", "initial: {tip.slide: 1 mm, crank.angle", ["25:22: "
         "initial.tip.slide: 'tip.slide' is driven; its law says where it starts"]),
        ("10 deg}", "1 kg}", ["25:24: initial.crank.angle: this is in kg, a quantity in rad is "
         "needed here"]),
    ],
)  # fmt: skip
def test_each_problem_has_its_line(tmp_path, old, new, told):
    assert GOOD.count(old) == 1, old
    found = problems(tmp_path, GOOD.replace(old, new))
    assert found == told


@pytest.mark.parametrize(
    "force", ["0 / 0", "rate * 1 N*m*s / (2 - 2)", "time * sqrt(-1) * 1 N*m/s"]
)
def test_laws_with_impossible_constants_are_refused(tmp_path, force):
    """They cost nothing to find, and no equations can be derived of them."""
    text = "title: t\nbodies:\n  a: {joints: [R2 q], mass: 1 kg, com: [0, 0, 1 m]}\n"
    (line,) = problems(tmp_path, f'{text}forces:\n  f: {{coordinate: a.q, force: "{force}"}}\n')
    assert line.startswith("5:31: forces.f.force: ")


def test_all_problems_come_at_once(tmp_path):
    text = GOOD.replace("length / 2", "lenght").replace("parent: crank", "parent: cranc")
    text = text.replace("3 N*m/rad", "3 kg").replace("10 deg", "10 m")
    fields = [line.split(": ")[1] for line in problems(tmp_path, text)]
    assert fields == [
        "parameters.half", "bodies.tip.parent", "springs.spring.law.stiffness",
        "initial.crank.angle",
    ]  # fmt: skip


def test_body_without_mass_at_the_end_of_a_chain(tmp_path):
    text = "title: t\nbodies:\n  a: {joints: [R2 q], mass: 1 kg, com: [0, 0, 1 m]}\n"
    (line,) = problems(tmp_path, text + "  b: {parent: a, joints: [R2 q]}\n")
    assert line.startswith("4:") and "nothing resists 'b.q'" in line
    joint = "{kind: R2, name: q, reflected_inertia: 1 kg*m^2}"
    assert problems(tmp_path, f"{text}  b: {{parent: a, joints: [{joint}]}}\n") == []


def test_body_without_inertia_about_its_last_axis(tmp_path):
    text = "title: t\nbodies:\n  a: {joints: [T1 x], mass: 1 kg}\n"
    (line,) = problems(tmp_path, text + "  b: {parent: a, joints: [R2 q], mass: 1 kg}\n")
    assert line.startswith("4:") and "no inertia about its last axis" in line
    good = "  b: {parent: a, joints: [R2 q], mass: 1 kg, com: [0, 0, 1 m]}\n"
    assert problems(tmp_path, text + good) == []


def test_massless_end_may_be_held_by_a_cut(tmp_path):
    text = "title: t\nbodies:\n  a: {joints: [R2 q], mass: 1 kg, com: [0, 0, 1 m]}\n"
    text += "  b: {parent: a, joints: [{kind: T1, name: q, start: 1 m}]}\n"
    text += "cuts: {c: {kind: rod, a: b, b: {body: ground, point: [2 m, 0, 0]}, length: 1 m}}\n"
    assert equations(tmp_path, text).structure["degrees_of_freedom"] == 1


CHAIN = """\
title: Three rods
parameters: {length: 1 m, mass: 1 kg}
bodies:
  rod_0: {joints: [R2 angle], mass: mass, com: [0, 0, -length], inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
repeat:
  - for: {i: {from: 1, to: 2}}
    bodies:
      rod_{i}:
        parent: "rod_{i-1}"
        at: [0, 0, -length]
        joints: [R2 angle]
        mass: mass * {i + 1}
        com: [0, 0, -length]
        inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]
    initial: {"rod_{i}.angle": "{i} * 10 deg"}
"""  # noqa: E501


def test_repetition_makes_what_is_written_out(tmp_path):
    head, _, _ = CHAIN.partition("repeat")
    rods = "".join(
        f"  rod_{i}: {{parent: rod_{i - 1}, at: [0, 0, -length], joints: [R2 angle], "
        f"mass: mass * {i + 1}, com: [0, 0, -length], inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}}\n"
        for i in (1, 2)
    )
    written = head + rods + "initial: {rod_1.angle: 10 deg, rod_2.angle: 20 deg}\n"
    one, two = Motion(equations(tmp_path, CHAIN)), Motion(equations(tmp_path, written))
    states = {s.name.replace(".", "__"): 0.1 * k for k, s in enumerate(one.equations.states)}
    assert one.at() == two.at()
    assert one.at(**states) == two.at(**states)


def test_several_indices_texts_and_nested_groups(tmp_path):
    text = """\
title: t
repeat:
  - for: {axle: [front, rear], i: [1, 2]}
    bodies: {"{axle}_{i}": {joints: [T3 z], mass: "{i} * 1 kg"}}
    repeat:
      - for: {k: {from: 1, to: "{i}"}}
        sensors: {"{axle}_{i}_{k}": {kind: point, body: "{axle}_{i}", shows: [position]}}
"""
    file = load(tmp_path, text).file
    assert list(file.bodies) == ["front_1", "front_2", "rear_1", "rear_2"]
    assert list(file.sensors)[:3] == ["front_1_1", "front_2_1", "front_2_2"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("{i: {from: 1, to: 2}}", "{i: 3}", "6:14: repeat[0].for.i: expected a list of whole"),
        ("{i: {from: 1, to: 2}}", "{}", "6:10: repeat[0].for: missing: indices and their values"),
        ("rod_{i-1}", "rod_{j}", "9:17: repeat[0].bodies.rod_{i}.parent: '{j}': no quantity"),
        ("mass * {i + 1}", "mas", "12:15: repeat[0].bodies.rod_{i}.mass: no quantity named 'mas'"),
        ("rod_{i}:", "rod:", "8:7: repeat[0].bodies.rod: 'rod' is defined twice"),
        ("to: 2", "to: x", "6:28: repeat[0].for.i.to: expected a whole number, found 'x'"),
        ("    bodies:\n      rod", "    bodys: 3\n    bodies:\n      rod", "7:12: repeat[0].bodys"),
    ],
)
def test_problems_of_repetition_point_at_the_group_once(tmp_path, old, new, words):
    found = problems(tmp_path, CHAIN.replace(old, new))
    assert any(line.startswith(words) for line in found), found
    assert len(found) == len(set(found))


SIDE = """\
title: Two arms
parameters: {hinge: [0.1 m, 0.5 m, 0.2 m]}
bodies:
  chassis: {joints: [free], mass: 10 kg, inertia: [1 kg*m^2, 2 kg*m^2, 3 kg*m^2]}
"""
ARM = """\
    bodies:
      arm_left:
        parent: chassis
        at: hinge
        joints: [{kind: R1, name: swing, start: 0.3 rad}, {kind: turn, axis: 3, angle: 20 deg},
              R2 lift,
                 {kind: T2, name: reach, start: 0.1 m}]
        mass: 2 kg
        com: [0.1 m, 0.2 m, 0.3 m]
        inertia: [1 kg*m^2, 1.1 kg*m^2, 1.2 kg*m^2, 0.1 kg*m^2, 0.2 kg*m^2, 0.3 kg*m^2]
    links:
      spring_left:
        a: {body: chassis, point: [0, 0.2 m, 1 m]}
        b: {body: arm_left, point: [0, 0.3 m, 0]}
        law: {kind: spring_damper, stiffness: 100 N/m, damping: 3 N*s/m, free_length: 0.2 m}
    springs:
      lift_left: {coordinate: arm_left.swing, law: {kind: polynomial, stiffness: [3 N*m, 4 N*m]}}
    forces:
      reach_left: {coordinate: arm_left.reach,
                   force: 5 N - 2 N/m * position * arm_left.lift + 3 N*s * arm_left.swing_rate}
    wrenches:
      wind_left: {body: arm_left, point: [0, 0.1 m, 0.2 m], force: [1 N, 2 N, 3 N],
                  torque: [1 N*m, 2 N*m, 3 N*m], axes: body}
    sensors:
      tip_left: {kind: point, body: arm_left, point: [0, 1 m, 0]}
    initial: {arm_left.swing_rate: 0.7 rad/s, arm_left.lift: 0.2 rad}
"""


ARMS = SIDE + "mirror:\n  - plane: y\n    names: {left: right}\n" + ARM
FILES = {"crank": GOOD, "chain": CHAIN, "arms": ARMS}


def test_mirror_image_moves_as_a_mirror_shows(tmp_path):
    """A left-right symmetric state of both sides gives left-right symmetric accelerations."""
    text = SIDE + "mirror:\n  - plane: y\n    names: {left: right}\n" + ARM
    motion = Motion(equations(tmp_path, text))
    rng = np.random.default_rng(1)
    odd = {"swing": -1.0, "lift": 1.0, "reach": -1.0}
    states = {}
    for name, sign in odd.items():
        for tail in ("", "_rate"):
            value = rng.normal() * 0.4
            states[f"arm_left__{name}{tail}"] = value
            states[f"arm_right__{name}{tail}"] = sign * value
    seen = motion.at(0.3, **states)
    for name, sign in odd.items():
        left, right = (seen[f"d.arm_{side}.{name}_rate"] for side in ("left", "right"))
        assert abs(left) > 1e-3
        assert right == pytest.approx(sign * left, rel=1e-10)
    for name in ("y", "yaw", "roll"):
        assert seen[f"d.chassis.{name}_rate"] == pytest.approx(0.0, abs=1e-10)
    for what in ("", "velocity_", "acceleration_"):
        for axis, sign in (("x", 1.0), ("y", -1.0), ("z", 1.0)):
            left, right = (seen[f"tip_{side}.{what}{axis}"] for side in ("left", "right"))
            assert right == pytest.approx(sign * left, rel=1e-9, abs=1e-12)
    starts = {s.name: s.start for s in motion.equations.states}
    assert starts["arm_right.swing"] == -starts["arm_left.swing"] == -0.3
    assert starts["arm_right.swing_rate"] == -0.7
    assert starts["arm_right.lift"] == 0.2


@pytest.mark.parametrize("plane", ["x", "y", "z"])
def test_image_of_an_image_is_the_thing_itself(tmp_path, plane):
    """Twice mirrored, every vector, start and law is what it was, though written otherwise."""
    names = {"left": "right", "right": "left"}
    model = load(tmp_path, ARMS.replace("plane: y", f"plane: {plane}"))
    sections = ("bodies", "links", "springs", "forces", "wrenches", "sensors", "initial")

    def group(of):
        return MirrorSet.model_construct(plane=plane, names=names, **of)

    left = {
        section: {k: v for k, v in getattr(model.file, section).items() if "left" in k}
        for section in sections
    }
    twice = mirror_image(group(mirror_image(group(left)).sections)).sections
    update = {k: {**getattr(model.file, k), **twice[k]} for k in sections}
    assert all(twice[section].keys() == left[section].keys() for section in sections)
    back = replace(model, file=model.file.model_copy(update=update))
    one, two = (Motion(derive(build_system(m))) for m in (model, back))
    assert one.equations.states == two.equations.states
    states = {s.name.replace(".", "__"): 0.1 + 0.05 * k for k, s in enumerate(one.equations.states)}
    first, second = one.at(0.2, **states), two.at(0.2, **states)
    assert first == pytest.approx(second, rel=1e-11, abs=1e-11)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("names: {left: right}", "names: {lift: right}", "the name has none of the pieces lift"),
        ("plane: y", "plane: w", "must be 'x', 'y' or 'z'"),
        ("parent: chassis", "parent: chasis", "no body named 'chasis'"),
        ("mass: 2 kg", "mass: 2 m", "this is in m, a quantity in kg"),
    ],
)
def test_problems_of_a_mirrored_group_are_told_once(tmp_path, old, new, words):
    text = SIDE + "mirror:\n  - plane: y\n    names: {left: right}\n" + ARM
    found = problems(tmp_path, text.replace(old, new))
    assert any(words in line for line in found), found
    assert len(found) == len(set(found))
    assert all(line.partition(": ")[2].startswith("mirror[0]") for line in found)


@pytest.mark.parametrize("text", FILES.values(), ids=FILES)
def test_written_back_a_file_loads_to_the_same_equations(tmp_path, text):
    model = load(tmp_path, text)
    again = load(tmp_path, model_as_yaml(model))
    assert again.parameters.values == model.parameters.values
    one, two = (Motion(derive(build_system(m))) for m in (model, again))
    assert [p.name for p in one.equations.parameters] == [p.name for p in two.equations.parameters]
    assert one.equations.states == two.equations.states
    states = {s.name.replace(".", "__"): 0.1 + 0.05 * k for k, s in enumerate(one.equations.states)}
    assert one.at(0.4, **states) == pytest.approx(two.at(0.4, **states), rel=1e-13)
    assert model_as_yaml(again) == model_as_yaml(model)


def test_a_change_of_a_parameter_moves_what_is_calculated_from_it(tmp_path):
    model = load(tmp_path, GOOD, parameters={"length": 0.4, "hinge": {"z": "2 m"}})
    assert model.resolved["half"] == 0.2
    assert model.parameters.values["hinge"] == (0.0, 0.0, 2.0)
    derived = derive(build_system(model))
    assert {p.name: p.value for p in derived.parameters}["length"] == 0.4


TOP = """\
title: A top that precesses steadily
parameters:
  moment: 2 N*m
  inertia: 0.1 kg*m^2
  precession: 4 rad/s
  spin: moment / (inertia * precession)
bodies:
  top:
    joints: [R3 yaw, R1 tilt, R3 spin]
    mass: 1 kg
    com: [0, 0, 0.1 m]
    inertia: [0.1 kg*m^2, 0.1 kg*m^2, inertia]
initial: {top.tilt: 0.5 rad, top.spin_rate: spin}
"""


@pytest.mark.parametrize(
    ("given", "spin"), [({}, 5.0), ({"spin": "6 rad/s"}, 6.0), ({"spin": 7}, 7.0)]
)
def test_a_calculated_parameter_is_a_rate_whatever_its_radians(tmp_path, given, spin):
    model = load(tmp_path, TOP, parameters=given)
    assert derive(build_system(model)).states[-1].start == pytest.approx(spin)


def test_a_parameter_that_is_a_frequency_is_no_rate(tmp_path):
    (line,) = problems(tmp_path, TOP.replace("moment / (inertia * precession)", "5 Hz"))
    assert line.endswith(
        "initial.top.spin_rate: this is in 1/s, a quantity in rad/s is needed here"
    )


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"parameters": {"lenght": 1}}, "no such parameter; did you mean 'length'?"),
        ({"parameters": {"length": "1 kg"}}, "this is in kg, the parameter is a quantity in m"),
        ({"parameters": {"crank": 3}}, "this is a group; expected a mapping"),
        ({"parameters": {"hinge": {"w": 3}}}, "unknown component. Known: x, y, z"),
        ({"initial": {"crank": {"angel": 3}}}, "no coordinate named 'crank.angel'"),
    ],
)
def test_wrong_changes_are_refused(tmp_path, given, words):
    with pytest.raises(InputError) as refused:
        load(tmp_path, GOOD, **given)
    assert words in str(refused.value)


@functools.cache
def checked():
    """Return what checks systems, whose schema is itself checked."""
    schema = system_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


@pytest.mark.parametrize("text", FILES.values(), ids=FILES)
def test_schema_accepts_good_files_and_refuses_unknown_keys(text):
    validator = checked()
    data = parse_yaml(text, "").data
    assert [error.message for error in validator.iter_errors(data)] == []
    assert not validator.is_valid({**data, "bodys": {}})
    assert not validator.is_valid({**data, "bodies": {"a": {"mas": 1}}})


def test_schema_describes_every_property():
    schema = system_schema()
    objects = [schema, *(d for d in schema["$defs"].values() if d.get("type") == "object")]
    assert len(objects) > 30
    for entry in objects:
        assert entry["additionalProperties"] is False
        for name, inner in entry.get("properties", {}).items():
            assert "description" in inner or "$ref" in inner or name == "kind", (name, inner)
