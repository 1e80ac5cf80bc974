"""Looks of systems: found for every example, as files hold them, and of the right sizes."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.base.registry import kinds
from vehicledyn.base.shapes import (
    Anchor,
    Ball,
    Box,
    Coil,
    Extrusion,
    Force,
    Hull,
    Plane,
    Tube,
    Wheel,
    as_plain,
)
from vehicledyn.files.scenario import load_model
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, PointForce, System
from vehicledyn.multibody.elements.point_forces import Attachment
from vehicledyn.multibody.equations.system_shapes import appearance
from vehicledyn.results.store.animation_stage import read_stage

ROOT = Path(__file__).parents[3]
SYSTEMS = sorted(path.name for path in (ROOT / "systems").glob("*.yaml"))


def values_of(system):
    return [entry.value for entry in system.table.entries]


@pytest.mark.parametrize("name", [*SYSTEMS, *kinds("model")])
def test_every_system_has_a_look(name):
    place = str(ROOT / "systems" / name) if name in SYSTEMS else name
    subject = build_subject(load_model(place))
    look = appearance(subject.system, values_of(subject.system), subject.shapes())
    stage = read_stage(json.loads(json.dumps({k: look[k] for k in ("bodies", "shapes")})))
    assert len(stage.shapes) == len(look["shapes"]) > 0
    shown = [body.name for body in subject.system.bodies if not body.is_abstract]
    assert [body["name"] for body in stage.bodies] == shown


def box(table, size, mass=3.0):
    a, b, c = size
    m = table.add("mass", mass, "kg", "Mass")
    inertia = tuple(m * (p * p + q * q) / 12.0 for p, q in ((b, c), (a, c), (a, b)))
    return {"mass": m, "inertia": inertia}


def test_box_of_mass_and_inertia():
    table, size = ParameterTable(), (1.2, 0.7, 0.4)
    body = Body("block", GROUND, joints=(Joint("T3", "block.z"),), **box(table, size))
    (found, *_) = appearance(System("s", table, (body,)), values_of(System("s", table, ())))[
        "shapes"
    ]
    assert found["kind"] == "box"
    assert found["size"] == pytest.approx(size)


def test_box_of_a_turned_inertia():
    """A block whose axes are turned by 30° about z has products of inertia."""
    size, angle = np.array([2.0, 0.5, 1.0]), np.radians(30.0)
    principal = 3.0 / 12.0 * (np.sum(size**2) - size**2)
    turn = Rotation.from_euler("z", angle).as_matrix()
    i = turn @ np.diag(principal) @ turn.T
    inertia = (i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2])
    body = Body("block", GROUND, joints=(Joint("T3", "block.z"),), mass=3.0, inertia=inertia)
    (found, *_) = appearance(System("s", ParameterTable(), (body,)), [])["shapes"]
    axes = np.array(found["rotation"])
    assert np.linalg.det(axes) == pytest.approx(1.0)
    longest = axes[:, int(np.argmax(found["size"]))]
    assert max(found["size"]) == pytest.approx(2.0)
    assert abs(longest @ turn[:, 0]) == pytest.approx(1.0)


def test_bars_lead_to_where_others_hold_on():
    table = ParameterTable()
    length = table.add("length", 0.8, "m", "Length")
    crank = Body("crank", GROUND, joints=(Joint("R2", "crank.angle"),), **box(table, (1, 1, 1)))
    rod = Body("rod", "crank", (0.0, 0.0, -length), (Joint("R2", "rod.angle"),), mass=1.0)
    spring = PointForce(
        "spring", Attachment("crank", (0.3, 0.0, 0.0)), Attachment(GROUND, (0.0, 1.0, 0.0)),
        lambda z, v: z,
    )  # fmt: skip
    system = System("s", table, (crank, rod), parts=(spring,))
    shapes = appearance(system, [2.0, *values_of(system)[1:]])["shapes"]
    bars = [s["b"]["point"] for s in shapes if s.get("style") == "arm" and s["name"] == "crank"]
    assert sorted(bars) == [[0.0, 0.0, -2.0], [0.3, 0.0, 0.0]]
    (pin,) = (s for s in shapes if s.get("style") == "pin" and s["name"] == "rod")
    assert pin["a"]["point"][0] == pin["a"]["point"][2] == 0.0 != pin["a"]["point"][1]
    assert [s["name"] for s in shapes if s["kind"] == "coil"] == ["spring"]


def test_all_kinds_of_shapes_are_read():
    """What parts can offer and what files are read for are the same."""
    a, b = Anchor("body", (0.0, 0.0, 0.0)), Anchor("ground", (1.0, 0.0, 0.0))
    shapes = [
        Box("box", a, (1.0, 1.0, 1.0)),
        Extrusion("side", a, ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0)), 2.0),
        Ball("ball", a, 0.1),
        Tube("tube", a, b, 0.1),
        Coil("coil", a, b, 0.1, direction=(0.0, 0.0, 1.0)),
        Wheel("wheel", a, (0.0, 1.0, 0.0), 0.3, 0.2),
        Hull("hull", "body", ((1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)), 0.0, 1.0),
        Plane("plane", (0.0, 0.0, 0.0)),
        Force("force", a, ("a.x", None, "a.z"), axes="body"),
        Force("force", ("a.x", "a.y", "a.z"), ("a.x", None, None), body="body", camber="a.c"),
    ]
    assert {type(shape) for shape in shapes} == set(type(shapes[0]).__mro__[1].__subclasses__())
    body = {"name": "body", "axis": 0, "axes_spin": True}
    plain = json.loads(json.dumps({"bodies": [body], "shapes": as_plain(shapes)}))
    assert len(read_stage(plain).shapes) == len(shapes)
    for shape in plain["shapes"]:
        for key in (
            "at",
            "a",
            "radius",
            "size",
            "axis",
            "outline",
            "profile",
            "point",
            "components",
        ):
            if key in shape:
                with pytest.raises(ValueError, match=key):
                    read_stage({"bodies": [body], "shapes": [{**shape, key: {"body": 3}}]})
