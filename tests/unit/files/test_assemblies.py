"""Systems made of other system files: names, places, parameters, connections, mirror images."""

import numpy as np
import pytest
from system_texts import Motion, equations

import vehicledyn as vd
from vehicledyn.analyses.models.assembly_tree import assembly_lines
from vehicledyn.files.building.construct import build_system
from vehicledyn.files.building.write import model_as_yaml
from vehicledyn.files.scenario import load_scenario
from vehicledyn.files.system.assemblies import read as assemblies
from vehicledyn.files.system.files import SystemFiles
from vehicledyn.files.system.read import read_system
from vehicledyn.multibody import derive
from vehicledyn.studies import load_study

ARM = """
title: An arm on a spring that hangs on a carrier
parameters:
  length: {value: 0.5 m, description: Length of the arm}
  half: length / 2
  mass: 2 kg
  rig_mass: 9 kg
  spring: {stiffness: 40 N*m/rad, damping: 1 N*m*s/rad}
connections:
  carrier: {body: stand, description: The body that carries the arm}
rig: {parameters: [rig_mass], springs: [stand]}
bodies:
  stand: {joints: [T3 height], mass: rig_mass}
  arm:
    parent: stand
    at: [0.1 m, 0.2 m, 0]
    joints: [R1 roll, R2 angle]
    mass: mass
    com: [half, 0.01 m, 0]
    inertia: [0.01 kg*m^2, 0.02 kg*m^2, 0.03 kg*m^2]
springs:
  stand: {coordinate: stand.height, law: {kind: spring_damper, stiffness: 1e4 N/m}}
  arm:
    coordinate: arm.angle
    law: {kind: spring_damper, stiffness: spring.stiffness, damping: spring.damping}
  roll: {coordinate: arm.roll, law: {kind: spring_damper, stiffness: 30 N*m/rad}}
initial: {arm.angle: 5 deg, stand.height: 1 mm}
sensors:
  tip: {kind: point, body: arm, point: [length, 0, 0]}
"""

CART = """
title: A cart with an arm on either side
parameters: {mass: 5 kg, reach: 0.8 m}
bodies:
  cart: {joints: [T1 x, R3 yaw], mass: mass, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
mirror:
  - plane: y
    names: {left: right}
    assemblies:
      left:
        file: arm.yaml
        at: [0.3 m, 0.4 m, 0]
        turns: [{axis: 3, angle: 10 deg}]
        parameters: {length: reach, spring: {stiffness: 50 N*m/rad}}
        connect: {carrier: cart}
"""

FLAT = """
title: The same in one file
parameters:
  mass: 5 kg
  reach: 0.8 m
bodies:
  cart: {joints: [T1 x, R3 yaw], mass: mass, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
mirror:
  - plane: y
    names: {left: right}
    bodies:
      left_arm:
        parent: cart
        at:
          - 0.3 m + cos(10 deg) * 0.1 m - sin(10 deg) * 0.2 m
          - 0.4 m + sin(10 deg) * 0.1 m + cos(10 deg) * 0.2 m
          - 0
        joints: [{kind: turn, axis: 3, angle: 10 deg}, R1 roll, R2 angle]
        mass: 2 kg
        com: [reach / 2, 0.01 m, 0]
        inertia: [0.01 kg*m^2, 0.02 kg*m^2, 0.03 kg*m^2]
    springs:
      left_spring:
        coordinate: left_arm.angle
        law: {kind: spring_damper, stiffness: 50 N*m/rad, damping: 1 N*m*s/rad}
      left_roll: {coordinate: left_arm.roll, law: {kind: spring_damper, stiffness: 30 N*m/rad}}
    sensors:
      left_tip: {kind: point, body: left_arm, point: [reach, 0, 0]}
    initial: {left_arm.angle: 5 deg}
"""


@pytest.fixture(autouse=True)
def arm(tmp_path):
    """An arm in a file of its own."""
    path = tmp_path / "arm.yaml"
    path.write_text(ARM, encoding="utf-8")
    written(tmp_path, "swing.yaml", "title: x\nmodel: arm.yaml\nduration: 1 s\n")
    return path


def complaints(path):
    """Return what is wrong with a file, file names without their folder."""
    model, found = read_system(path)
    assert (model is None) == bool(found)
    return [str(problem).replace(f"{path.parent}/", "") for problem in found]


def written(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def state(motion, seed=3):
    """Return random states by name, the assembly's names as those of the flat file."""
    random = np.random.default_rng(seed)
    names = sorted(s.name for s in motion.equations.states)
    return {name.replace(".", "__"): random.normal() for name in names}


def test_an_assembly_moves_as_the_same_parts_written_in_one_file(tmp_path):
    made, flat = Motion(equations(tmp_path, CART)), Motion(equations(tmp_path, FLAT))
    random = np.random.default_rng(5)
    given = {s.name: random.normal() for s in flat.equations.states}

    def renamed(name):
        for side in ("left", "right"):
            name = name.replace(f"{side}_arm", f"{side}.arm").replace(f"{side}_tip", f"{side}.tip")
            name = name.replace(f"{side}_spring", f"{side}.arm")
            name = name.replace(f"{side}_roll", f"{side}.roll")
        return name

    want = flat.at(**{name.replace(".", "__"): value for name, value in given.items()})
    found = made.at(**{renamed(n).replace(".", "__"): v for n, v in given.items()})
    assert {renamed(name) for name in want} == set(found)
    for name, value in want.items():
        assert found[renamed(name)] == pytest.approx(value, rel=1e-12, abs=1e-12), name
    starts = {s.name: s.start for s in made.equations.states}
    assert starts["left.arm.angle"] == pytest.approx(np.radians(5.0))
    assert "left.stand.height" not in starts


def test_the_file_runs_by_itself_with_its_stand_ins(arm):
    model, problems = read_system(arm)
    assert not problems
    assert "stand.height" in {s.name for s in derive(build_system(model)).states}


def test_parameters_are_given_by_the_user_and_stay_addressable(tmp_path):
    path = written(tmp_path, "cart.yaml", CART)
    model, _ = read_system(path)
    assert model.resolved["left.length"] == pytest.approx(0.8)
    assert model.resolved["left.half"] == pytest.approx(0.4)
    assert "left.rig_mass" not in model.resolved
    given = {"reach": "1 m", "left": {"spring": {"stiffness": "70 N*m/rad"}}}
    model, problems = read_system(path, {"parameters": given})
    assert not problems
    assert model.resolved["left.length"] == pytest.approx(1.0)
    assert model.resolved["left.spring.stiffness"] == pytest.approx(70.0)
    assert SystemFiles.groups(path) == {"mass", "reach", "left"}


def test_starts_of_the_user_come_before_those_of_the_part(tmp_path):
    text = CART + "initial: {left.arm.angle: 2 deg}\n"
    starts = {s.name: s.start for s in equations(tmp_path, text).states}
    assert starts["left.arm.angle"] == pytest.approx(np.radians(2.0))
    assert starts["right.arm.angle"] == pytest.approx(np.radians(5.0))


def test_a_file_without_connections_stands_on_what_is_given_for_the_ground(tmp_path):
    written(
        tmp_path,
        "hook.yaml",
        "title: x\nbodies: {hook: {joints: [R2 swing], mass: 1 kg, com: [0, 0, -1 m]}}\n",
    )
    text = """
title: A crane
bodies: {trolley: {joints: [T1 x], mass: 2 kg}}
assemblies: {load: {file: hook.yaml, at: [0, 0, -0.1 m], connect: {ground: trolley}}}
"""
    motion = Motion(equations(tmp_path, text))
    # free mass below a trolley: x'' of the trolley at angle a and no rates is m g sin a cos a / M*
    angle, gravity = 0.3, 9.81
    found = motion.at(load__hook__swing=angle)
    expected = gravity * np.sin(angle) * np.cos(angle) / (2.0 + np.sin(angle) ** 2)
    assert abs(found["d.trolley.x_rate"]) == pytest.approx(expected, rel=1e-12)


def test_assemblies_hold_assemblies_and_repeat(tmp_path):
    written(
        tmp_path,
        "cart.yaml",
        CART.replace(
            "bodies:\n",
            """connections:
  cart: {body: cart}
bodies:
""",
            1,
        ),
    )
    text = """
title: A train of two
parameters: {mass: 7 kg}
bodies: {lead: {joints: [T1 x], mass: mass}}
repeat:
  - for: {i: [1, 2]}
    assemblies:
      "cart_{i}":
        file: cart.yaml
        at: ["-{i} * 2 m", 0, 0]
        parameters: {left: {mass: mass / 7}}
        connect: {cart: lead}
"""
    model, problems = read_system(written(tmp_path, "train.yaml", text))
    assert not problems
    assert "cart_2.right.arm.roll" in model.coordinates
    assert model.resolved["cart_2.left.mass"] == pytest.approx(1.0)
    assert model.resolved["cart_1.left.length"] == pytest.approx(0.8)
    (first, _), inner = model.assemblies, model.assemblies[0].inner
    assert (first.name, first.file) == ("cart_1", "cart.yaml")
    assert [item.name for item in inner] == ["left", "right"]
    assert "An arm on a spring" in model.text
    assert "The same" not in model.text


def test_the_tree_of_assemblies_is_shown(tmp_path):
    model, _ = read_system(written(tmp_path, "cart.yaml", CART))
    assert assembly_lines(model.assemblies) == [
        "assemblies",
        "  left: arm.yaml, An arm on a spring that hangs on a carrier",
        "  right: mirror image of left, with its parameters",
        "",
    ]


def test_the_written_out_file_makes_the_same_equations(tmp_path):
    model, _ = read_system(written(tmp_path, "cart.yaml", CART))
    again = equations(tmp_path, model_as_yaml(model))
    found = derive(build_system(model))
    assert [s.name for s in again.states] == [s.name for s in found.states]
    assert [p.name for p in again.parameters] == [p.name for p in found.parameters]
    one, two = Motion(found), Motion(again)
    assert one.at(**state(one)) == two.at(**state(two))


def test_a_file_of_another_folder_finds_what_lies_beside_it(tmp_path, arm):
    (tmp_path / "parts").mkdir()
    arm.rename(tmp_path / "parts" / "arm.yaml")
    path = written(tmp_path, "cart.yaml", CART.replace("file: arm.yaml", "file: parts/arm.yaml"))
    assert complaints(path) == []


def test_systems_of_the_library_are_parts_by_name(tmp_path):
    text = """
title: A suspension on a frame
bodies: {frame: {joints: [T3 z], mass: 300 kg}}
assemblies:
  corner: {file: macpherson_suspension, connect: {chassis: frame, rack: frame}}
"""
    model, problems = read_system(written(tmp_path, "frame.yaml", text))
    assert not problems
    assert "corner.carrier.slide" in model.coordinates


def test_a_point_at_the_origin_of_a_body_comes_before_the_place_of_the_assembly(tmp_path):
    text = CART.replace(
        "connect: {carrier: cart}", "connect: {carrier: {body: cart, point: POINT}}"
    )
    tips = []
    for point in ("[0, 0, 0]", "[1e-12 m, 0, 0]", "[0.3 m, 0.4 m, 0]"):
        found = Motion(equations(tmp_path, text.replace("POINT", point))).at()
        tips.append(found["left.tip.x"])
    assert tips[0] == pytest.approx(tips[1], abs=1e-9)
    assert tips[2] - tips[0] == pytest.approx(0.3, abs=1e-9)


def test_coordinates_are_connected(tmp_path):
    written(
        tmp_path,
        "brake.yaml",
        """
title: A brake
connections: {shaft: {coordinate: shaft.angle, description: Angle of what it brakes}}
rig: {bodies: [shaft]}
bodies: {shaft: {joints: [R2 angle], inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2], mass: 1 kg}}
forces: {brake: {coordinate: shaft.angle, force: -2 N*m*s/rad * shaft.angle_rate}}
""",
    )
    text = """
title: A wheel
bodies: {wheel: {joints: [R2 turn], inertia: [4 kg*m^2, 4 kg*m^2, 4 kg*m^2], mass: 1 kg}}
assemblies: {brake: {file: brake.yaml, connect: {shaft: wheel.turn}}}
"""
    found = Motion(equations(tmp_path, text)).at(wheel__turn_rate=3.0)
    assert found["d.wheel.turn_rate"] == pytest.approx(-1.5, rel=1e-12)


def test_events_and_switches_of_a_part_keep_to_it(tmp_path):
    written(
        tmp_path,
        "bumper.yaml",
        """
title: A mass that counts its impacts on a wall
parameters: {wall: 0.5 m}
bodies: {slug: {joints: [T1 x, T2 y], mass: 1 kg}}
switches: {count: 0}
events:
  hit:
    when: wall - tip.x + slug.y * count
    points: {tip: {body: slug, point: [0.1 m, 0, 0]}}
    reset: {slug.x_rate: -slug.x_rate, count: count + 1}
""",
    )
    text = """
title: Two of them
assemblies:
  one: {file: bumper.yaml, at: [1 m, 0, 0]}
  two: {file: bumper.yaml, parameters: {wall: 0.7 m}}
"""
    model, problems = read_system(written(tmp_path, "two.yaml", text))
    assert not problems
    event = model.file.events["two.hit"]
    assert str(event.when) == "two.wall - tip.x + two.slug.y * two.count"
    assert {name: str(value) for name, value in event.reset.items()} == {
        "two.slug.x_rate": "-two.slug.x_rate",
        "two.count": "two.count + 1",
    }
    assert model.file.bodies["one.slug"].parent == "one.ground"
    assert model.file.bodies["two.slug"].parent == "ground"


BAD = {
    "itself": (
        "file: arm.yaml",
        "file: bad.yaml",
        "bad.yaml:10:15: mirror[0].assemblies.left.file: the file would be an assembly of itself: "
        "bad.yaml -> bad.yaml",
    ),
    "file of the library": (
        "file: arm.yaml",
        "file: quarter_car.yaml",
        "bad.yaml:10:15: mirror[0].assemblies.left.file: there is no such file; the library has "
        "one of this name: write 'quarter_car'",
    ),
    "connection": (
        "connect: {carrier: cart}",
        "connect: {carrier: cart, carier: cart}",
        "bad.yaml:14:34: mirror[0].assemblies.left.connect.carier: no connection named 'carier'",
    ),
    "unconnected": (
        "connect: {carrier: cart}",
        "connect: {}",
        "bad.yaml:14:9: mirror[0].assemblies.left.connect: missing: the body for the connection "
        "'carrier' (The body that carries the arm)",
    ),
    "body": (
        "{carrier: cart}",
        "{carrier: car}",
        "bad.yaml:14:28: mirror[0].assemblies.left.connect.carrier: no body named",
    ),
    "twice": (
        "mirror:",
        "assemblies: {left: {file: arm.yaml, connect: {carrier: cart}}}\nmirror:",
        "'left' is defined twice",
    ),
    "taken": ("reach: 0.8 m", "reach: 0.8 m, left: 1", "the name is taken: parameters 'left'"),
    "parameter": ("length: reach", "lenght: reach", "did you mean 'length'?"),
    "no unit": (
        "length: reach",
        "length: 0.8",
        "bad.yaml:13:22: mirror[0].assemblies.left.parameters.length: 0.8 has no unit; "
        "write '0.8 m'",
    ),
    "unit": (
        "length: reach",
        "length: mass",
        "bad.yaml:13:30: mirror[0].assemblies.left.parameters.length: this is in kg, the parameter "
        "is a quantity in m",
    ),
    "image": (
        "names: {left: right}",
        "names: {lft: right}",
        "bad.yaml:9:7: mirror[0].assemblies.left: the name has none of the pieces lft of 'names'",
    ),
    "scenario": ("file: arm.yaml", "file: swing.yaml", "swing.yaml:2:1: model: this is a scenario"),
    "missing file": ("file: arm.yaml", "file: none.yaml", "none.yaml"),
    "library": (
        "file: arm.yaml",
        "file: macpherson_suspensio",
        "did you mean 'macpherson_suspension'?",
    ),
    "bound": (
        "length: reach",
        "mass: -1 kg * reach / 1 m",
        "arm.yaml:18:5: bodies.arm.mass: must be greater than 0 kg, is -0.8 "
        "(in 'left' of bad.yaml:9)",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_what_is_wrong_with_an_assembly_is_said_once_with_its_line(tmp_path, case):
    old, new, message = BAD[case]
    assert old in CART
    found = complaints(written(tmp_path, "bad.yaml", CART.lstrip("\n").replace(old, new, 1)))
    assert len(found) == 1, found
    assert message in found[0]


def test_two_assemblies_with_one_name_are_refused(tmp_path):
    entry = "  one: {file: arm.yaml, connect: {carrier: ground}}\n"
    path = written(tmp_path, "two.yaml", f"title: x\nassemblies:\n{entry}{entry}")
    assert complaints(path) == ["two.yaml:4:3: assemblies.one: given twice; the first is in line 3"]


def test_a_circle_of_files_is_refused_with_all_of_them(tmp_path):
    for one, other in (("a", "b"), ("b", "c"), ("c", "a")):
        text = f"title: x\nassemblies: {{{other}: {{file: {other}.yaml}}}}\n"
        written(tmp_path, f"{one}.yaml", text)
    (found,) = complaints(tmp_path / "a.yaml")
    assert found.startswith("c.yaml:2:24: assemblies.a.file: the file would be an assembly of")
    assert "a.yaml -> b.yaml -> c.yaml -> a.yaml (in 'c' of b.yaml:2) (in 'b' of a.yaml:2)" in found


def test_files_nested_too_deeply_are_refused(tmp_path):
    written(tmp_path, "f0.yaml", "title: x\nbodies: {b: {joints: [T1], mass: 1 kg}}\n")
    for k in range(1, 200):
        text = f"title: x\nassemblies: {{a: {{file: f{k - 1}.yaml}}}}\n"
        written(tmp_path, f"f{k}.yaml", text)
    (found,) = complaints(tmp_path / "f199.yaml")
    assert "nested more than 25 deep" in found


def test_mistakes_inside_a_part_name_its_line_and_where_it_is_used(tmp_path, arm):
    arm.write_text(
        ARM.replace("com: [half, 0.01 m, 0]", "com: [hafl, 0.01 m, 0]"), encoding="utf-8"
    )
    (found,) = complaints(written(tmp_path, "cart.yaml", CART))
    assert found.startswith("arm.yaml:19:10: bodies.arm.com: no quantity named")
    assert "did you mean 'half'" in found
    assert found.endswith("(in 'left' of cart.yaml:10)")


def test_parts_that_rest_on_the_rig_are_refused_in_their_own_file(tmp_path, arm):
    arm.write_text(ARM.replace("springs: [stand]", "cuts: [none]"), encoding="utf-8")
    found = complaints(arm)
    assert any("rig.cuts[0]: no cuts named 'none'" in line for line in found)
    assert any("springs.stand.coordinate: 'stand.height' belongs to the rig" in w for w in found)


def test_doubling_files_are_refused_before_they_fill_the_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(assemblies, "MOST_PARTS", 50)
    written(tmp_path, "f0.yaml", "title: x\nbodies: {b: {joints: [T1], mass: 1 kg}}\n")
    for k in range(1, 20):
        text = f"title: x\nassemblies: {{a: {{file: f{k - 1}.yaml}}, b: {{file: f{k - 1}.yaml}}}}\n"
        written(tmp_path, f"f{k}.yaml", text)
    found = complaints(tmp_path / "f19.yaml")
    assert len(found) == 1
    assert found[0].startswith("f6.yaml:2:34: assemblies.b: the assemblies make more than 50 parts")


def test_a_wrong_parameter_of_an_assembly_is_refused(tmp_path):
    path = written(tmp_path, "cart.yaml", CART)
    given = {"left": {"spring": {"stifness": "1 N*m/rad"}}}
    _, (problem,) = read_system(path, {"parameters": given})
    assert "no such parameter; did you mean 'stiffness'" in problem.message


def test_a_wheeled_system_has_no_parameter_named_like_the_speed_of_its_scenario(tmp_path):
    text = """
title: A wheel that falls
parameters: {speed: 3 m/s}
road: {kind: flat}
bodies:
  hub: {joints: [T1 x, T3 z], mass: 10 kg}
  wheel: {parent: hub, joints: [R2 spin], mass: 5 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2],
        spins_about: 2}
wheels:
  wheel: {body: wheel, radius: 0.3 m, stiffness: 2e5 N/m, tyre: {kind: magic_formula_1987}}
"""
    assert complaints(written(tmp_path, "wheel.yaml", text)) == [
        "wheel.yaml:3:21: parameters.speed: 'speed' is the forward speed of what has wheels; take "
        "another name"
    ]


@pytest.mark.long
def test_a_parameter_of_an_assembly_is_swept_by_study_option_and_python(tmp_path):
    written(tmp_path, "cart.yaml", CART)
    run = "title: x\nmodel: cart.yaml\nduration: 20 ms\nsolver: {kind: rk4, step: 1 ms}\n"
    scenario = written(tmp_path, "run.yaml", f"{run}output: {{interval: 10 ms}}\n")
    key = "left.spring.stiffness"
    loaded = load_scenario(scenario, [f"{key}=70 N*m/rad"])
    assert loaded.resolved["parameters"][key] == 70.0
    assert loaded.changed({key: "80 N*m/rad"}).resolved["parameters"][key] == 80.0
    vary = f"parameters.{key}: [30 N*m/rad, 60 N*m/rad]"
    text = f"title: x\nscenario: run.yaml\ncases: {{kind: grid, vary: {{{vary}}}}}\n"
    study = written(tmp_path, "study.yaml", text)
    (axis,) = load_study(study).design.axes
    assert (axis.unit, list(axis.values)) == ("N*m/rad", [30.0, 60.0])
    swept = vd.sweep(scenario, vary={f"parameters.{key}": ["30 N*m/rad", "600 N*m/rad"]})
    ends = [np.asarray(swept["left.arm.angle"].values)[case][-1] for case in (0, 1)]
    assert abs(ends[0] - ends[1]) > 1e-4
