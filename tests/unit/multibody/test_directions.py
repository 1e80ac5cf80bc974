"""Directions of any length: a contact with a plane weighs what the ball weighs."""

import casadi as ca
import numpy as np
import pytest

from vehicledyn.analyse.equilibrium import find_equilibrium
from vehicledyn.base.errors import InputError
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import GROUND, Body, Joint, ParameterTable, System, derive
from vehicledyn.multibody.elements.contacts.body_contacts import BodyContact
from vehicledyn.multibody.elements.contacts.body_shapes import Capsule, FlatPlane
from vehicledyn.symbolic import rotations


def normal_force(normal):
    """Return what a ball of 1 kg presses with on a plane of this normal."""
    ball = Body("ball", GROUND, joints=(Joint("T3", "z", start=0.0999),), mass=1.0)
    touch = BodyContact(
        "touch", body_a=GROUND, body_b="ball", ball=Capsule(radius=0.1),
        plane=FlatPlane(normal=normal), stiffness=1e5, exponent=1.0,
    )  # fmt: skip
    equations = derive(System("ball", ParameterTable(), (ball,), parts=(touch,)))
    kernel = compile_kernel(equations, backend="interpreted")
    found = find_equilibrium(
        equations, kernel, time=0.0, state=[0.0999, 0.0], unknowns=[], free=[0], balanced=[1],
        tolerance=1e-9,
    )  # fmt: skip
    names = [channel.name for channel in equations.channels]
    values = kernel.outputs(0.0, found.state, found.unknowns)
    return values[names.index("touch.normal_force")]


@pytest.mark.parametrize("normal", [(0.0, 0.0, 1.0), (0.0, 0.0, 2.0)])
def test_the_length_of_a_normal_does_not_matter(normal):
    assert normal_force(normal) == pytest.approx(9.81, rel=1e-9)


def test_directions():
    exact = (0.6, 0.0, 0.8)
    assert [rotations.direction(exact)[k] for k in range(3)] == list(exact)
    symbol = ca.SX.sym("s")
    found = ca.Function("f", [symbol], [rotations.direction((symbol, 3.0, 0.0))])(4.0)
    assert np.array(found).ravel() == pytest.approx([0.8, 0.6, 0.0])
    with pytest.raises(InputError, match="points somewhere"):
        rotations.direction((0.0, 0.0, 0.0))
