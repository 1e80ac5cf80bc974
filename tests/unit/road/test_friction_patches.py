"""Patches of other friction: where they lie, and that every tyre law feels them alike."""

import numpy as np
import pytest
from pydantic import ValidationError

import vehicledyn.road  # noqa: F401
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import find, kinds
from vehicledyn.road.surfaces.flat import Flat as FlatRoad
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.symbolic import ops

EXAMPLES = {
    "rectangle": {"friction": 0.2, "left": "0 m", "start": "10 m"},
    "chequers": {"friction": 0.3, "side": "2 m"},
}
INSIDE = {"rectangle": (12.0, -1.0), "chequers": (1.0, 1.0)}
OUTSIDE = {"rectangle": (12.0, 1.0), "chequers": (1.0, 3.0)}


def road(kind):
    return FlatRoad(patches=[{"kind": kind, **EXAMPLES[kind]}])


@pytest.mark.parametrize("kind", kinds("patch"))
def test_friction_is_that_of_the_patch_inside_and_one_outside(kind):
    ground = road(kind)
    assert float(ground.friction(*INSIDE[kind])) == pytest.approx(EXAMPLES[kind]["friction"])
    assert float(ground.friction(*OUTSIDE[kind])) == pytest.approx(1.0)
    x, y = ops.symbol("x"), ops.symbol("y")
    by_symbols = ops.numeric([x, y], ops.column([ground.friction(x, y)]))
    assert by_symbols(*INSIDE[kind]) == pytest.approx(EXAMPLES[kind]["friction"])


@pytest.mark.parametrize("kind", kinds("patch"))
def test_friction_changes_steadily(kind):
    places = np.linspace(-9.0, 21.0, 6001)
    found = np.array([float(road(kind).friction(x, -0.7 + 0.1 * x)) for x in places])
    widest = (1.0 - EXAMPLES[kind]["friction"]) / 0.1 * np.hypot(0.005, 0.0005)
    assert np.abs(np.diff(found)).max() <= 1.001 * widest


def test_plates_of_a_chessboard_alternate():
    ground = road("chequers")
    shares = [
        [float(ground.friction(1.0 + 2 * i, 1.0 + 2 * j)) for i in range(4)] for j in range(4)
    ]
    odd = np.add.outer(range(4), range(4)) % 2
    assert np.array(shares) == pytest.approx(np.where(odd, 1.0, 0.3))


def test_the_last_patch_counts():
    last = {"kind": "rectangle", "friction": 0.5, "right": "-0.5 m", "left": "0.5 m"}
    ground = FlatRoad(patches=[{"kind": "rectangle", **EXAMPLES["rectangle"]}, last])
    assert float(ground.friction(12.0, -0.2)) == pytest.approx(0.5)
    assert float(ground.friction(12.0, -1.2)) == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({}, "needs a border"),
        ({"start": "2 m", "end": "1 m"}, "end: must be larger than start"),
        ({"start": "2 m", "friction": 0.0}, "greater than 0"),
    ],
)
def test_senseless_patches_are_refused(wrong, words):
    with pytest.raises(ValidationError, match=words):
        FlatRoad(patches=[{"kind": "rectangle", "friction": 0.5, **wrong}])


def test_the_calspan_law_has_a_skid_number():
    tyre, felt = find("tyre", "calspan")(), TyreInput(4000.0, 0.0, 0.5, 0.0, 20.0)
    sliding = tyre.on_ground(0.5).forces(felt).lateral_force
    assert sliding == pytest.approx(0.5 * tyre.forces(felt).lateral_force)


def test_a_law_without_friction_says_so():
    class Plain(Tyre):
        def forces(self, contact):
            return TyreForces(0.0, 0.0, 0.0)

    assert isinstance(Plain().on_ground(1.0), Plain)
    with pytest.raises(InputError, match=r"no field 'friction'.*patches"):
        Plain().on_ground(0.3)
