"""Impacts that would give energy are refused: coefficients of restitution are from 0 to 1."""

import pytest

from vehicledyn.base.errors import InputError
from vehicledyn.files.system.read import read_system
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.elements.contacts.body_contacts import BodyImpact
from vehicledyn.multibody.elements.contacts.body_shapes import Capsule, FlatPlane

FILE = """\
title: a ball that bounces higher
parameters: {rebound: 1.5}
bodies: {ball: {joints: [T3 z], mass: 1 kg}}
elements:
  floor: {kind: body_impact, body_a: ground, body_b: ball, plane: {}, ball: {radius: 0.1 m},
    restitution: REBOUND}
"""


@pytest.mark.parametrize(
    ("rebound", "words"),
    [
        ("1.0000001", "must be at most 1, is 1"),
        ("rebound", "must be at most 1, is 1.5"),
        ("2 * 0.8", "must be at most 1, is 1.6"),
        ("-0.1", "must be at least 0, is -0.1"),
    ],
)
def test_in_files(rebound, words, tmp_path):
    path = tmp_path / "ball.yaml"
    path.write_text(FILE.replace("REBOUND", rebound))
    _, found = read_system(path)
    wanted = f"{path}:6:18: elements.floor.restitution: {words}"
    assert [str(item) for item in found] == [wanted]


def test_in_python():
    floor = BodyImpact(
        "floor", body_a=GROUND, body_b="ball", plane=FlatPlane(), ball=Capsule(radius=0.1),
        restitution=1.2,
    )  # fmt: skip
    ball = Body("ball", GROUND, joints=(Joint("T3", "z"),), mass=1.0)
    with pytest.raises(InputError, match=r"floor: restitution: must be at most 1, is 1\.2"):
        derive(System("bouncing", ParameterTable(), (ball,), parts=(floor,)))
