"""Shapes of bodies in system files: in place, mirrored, in assemblies, and refused where wrong."""

import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import kinds
from vehicledyn.files.scenario import load_model
from vehicledyn.files.system.kinds import load_kinds
from vehicledyn.multibody.equations.system_shapes import appearance

SYSTEM = """
title: Shapes
parameters: {length: 2 m}
bodies:
  car: {joints: [T1 x], mass: 100 kg, inertia: [1 kg*m^2, 1 kg*m^2, 1 kg*m^2]}
mirror:
  - plane: PLANE
    names: {left: right}
    bodies:
      left_arm: {parent: car, joints: [R1 angle], mass: 1 kg, inertia: [1 kg*m^2, 1 kg*m^2,
            1 kg*m^2]}
    shapes:
      left_side:
        kind: extrusion
        body: left_arm
        at: [0.1 m, 0.5 m, 0.2 m]
        x: [0 m, length, length]
        z: [0 m, 0 m, 1 m]
        width: 0.1 m
      left_rod: {kind: cylinder, body: car, a: [1 m, 2 m, 3 m], b: [4 m, 5 m, 6 m], radius: 10 mm}
"""


def shapes(path, text):
    path.write_text(text, encoding="utf-8")
    system = build_subject(load_model(str(path))).system
    values = [entry.value for entry in system.table.entries]
    return {shape["name"]: shape for shape in appearance(system, values)["shapes"]}


def test_shapes_stand_for_their_bodies_and_follow_parameters(tmp_path):
    found = shapes(tmp_path / "s.yaml", SYSTEM.replace("PLANE", "y"))
    side = found["left_side"]
    assert side["profile"] == [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]]
    assert side["at"] == {"body": "left_arm", "point": [0.1, 0.5, 0.2]}
    assert not any(s["kind"] == "box" for s in found.values())


@pytest.mark.parametrize(
    ("plane", "at", "corner", "end"),
    [
        ("y", [0.1, -0.5, 0.2], [2.0, 1.0], [4.0, -5.0, 6.0]),
        ("x", [-0.1, 0.5, 0.2], [-2.0, 1.0], [-4.0, 5.0, 6.0]),
        ("z", [0.1, 0.5, -0.2], [2.0, -1.0], [4.0, 5.0, -6.0]),
    ],
)
def test_mirror_images(tmp_path, plane, at, corner, end):
    found = shapes(tmp_path / "s.yaml", SYSTEM.replace("PLANE", plane))
    side, rod = found["right_side"], found["right_rod"]
    assert side["at"] == {"body": "right_arm", "point": at}
    assert side["profile"][2] == corner
    assert (rod["b"]["body"], rod["b"]["point"]) == ("car", end)


def test_shapes_of_an_assembly_move_with_it(tmp_path):
    part = (
        "title: t\nbodies:\n  arm: {joints: [R1 q], mass: 1 kg, inertia: [1 kg*m^2, "
        "1 kg*m^2, 1 kg*m^2]}\nshapes:\n"
    )
    part += "  rod: {kind: sphere, body: arm, at: [1 m, 0, 0], radius: 1 cm}\n"
    (tmp_path / "part.yaml").write_text(part, encoding="utf-8")
    whole = "title: t\nassemblies: {front: {file: part.yaml}}\n"
    found = shapes(tmp_path / "whole.yaml", whole)
    (ball,) = [shape for name, shape in found.items() if name.endswith("rod")]
    assert ball["at"]["body"] == "front.arm"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("body: left_arm\n", "body: left_arn\n", r"left_side\.body: .*'left_arm'"),
        ("z: [0 m, 0 m, 1 m]", "z: [0 m, 0 m]", r"left_side: x has 3 corners and z 2"),
        ("kind: cylinder", "kind: cylnder", "did you mean 'cylinder'"),
        ("radius: 10 mm", "radius: 10 kg", "in kg, a quantity in m"),
        ("radius: 10 mm", "radius: -1 mm", "above 0|more than 0|greater than 0"),
    ],
)
def test_wrong_shapes_are_refused(tmp_path, old, new, message):
    path = tmp_path / "s.yaml"
    path.write_text(SYSTEM.replace("PLANE", "y").replace(old, new), encoding="utf-8")
    with pytest.raises(InputError, match=message):
        load_model(str(path))


load_kinds()
FIELDS = {
    "box": "size: [1 m, 2 m, 3 m]",
    "cylinder": "a: [0, 0, 0], b: [0, 0, 1 m], radius: 10 mm",
    "sphere": "radius: 10 mm",
    "extrusion": "x: [0 m, 1 m, 1 m], z: [0 m, 0 m, 1 m], width: 1 m",
}


@pytest.mark.parametrize("kind", kinds("shape"))
def test_every_shape_goes_with_its_body(tmp_path, kind):
    text = SYSTEM.split("mirror:", maxsplit=1)[0]
    text += f"shapes:\n  own: {{kind: {kind}, body: car, {FIELDS[kind]}}}\n"
    own = shapes(tmp_path / "s.yaml", text)["own"]
    bodies = [own[key]["body"] for key in ("at", "a", "b") if key in own]
    assert bodies and set(bodies) == {"car"}
