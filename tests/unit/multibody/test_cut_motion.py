"""Derivatives of cuts along the tree against those of the expanded residuals."""

import numpy as np
import pytest

from vehicledyn.multibody.loops.cut_motion import moving_residuals
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.cuts import BallCut, BodyCut, RodCut
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.symbols import declare
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.parameters import ParameterTable

PLACES = ("left", (0.1, -0.2, 0.3), "right", (-0.4, 0.2, 0.1))
CUTS = (
    BallCut("ball", *PLACES),
    RodCut("rod", *PLACES, length=0.7),
    BodyCut("clamp", *PLACES),
    BallCut("to_carrier", "carrier", (0.2, 0.1, 0.0), "right", (0.3, 0.0, 0.1)),
    BodyCut("to_ground", "ground", (0.2, 0.1, 0.0), "left", (0.3, 0.0, 0.1)),
)


def chain(*kinds, turn):
    return (Turn(rotations.turn(2, turn)), *(Joint(kind, f"{kind}_{turn}") for kind in kinds))


def body(name, parent, joints):
    return Body(name, parent, (0.3, -0.1, 0.5), joints, mass=1.0, inertia=(0.1, 0.1, 0.1))


def some_system():
    return System(
        "two arms",
        ParameterTable(),
        bodies=(
            body("carrier", "ground", chain("T3", "R1", "R3", turn=0.1)),
            body("left", "carrier", chain("R2", "T1", "R3", turn=0.4)),
            body("elbow", "carrier", chain("R1", "R2", turn=-0.3)),
            body("right", "elbow", chain("T2", "R3", turn=0.7)),
        ),
    )


@pytest.mark.parametrize("cut", CUTS, ids=lambda cut: cut.name)
def test_slopes_and_quadratic_term_are_those_of_the_expanded_residual(cut):
    system = some_system()
    tree, symbols = unfold(system.bodies), declare(system)
    q, qd = symbols.coordinate_column, symbols.rate_column
    kinematics = Kinematics(tree, symbols.coordinates, symbols.rates)
    moving = moving_residuals(cut, kinematics)
    h = ops.column([m.residual.expression for m in moving])
    first = ops.derivative(h, q, qd)
    names = [joint.name for joint in symbols.joints]
    zero = ops.scalar(0.0)
    found = ops.column(
        [m.slopes.get(name, zero) for name in names for m in moving] + [m.quadratic for m in moving]
    )
    expected = ops.stacked(ops.flat(ops.jacobian(h, q)), ops.derivative(first, q, qd))
    rng = np.random.default_rng(7)
    for _ in range(5):
        at = rng.normal(size=(2, len(names)))
        values = ops.numeric([q, qd], found)(*at)
        assert np.abs(values).max() > 0.1
        np.testing.assert_allclose(
            values, ops.numeric([q, qd], expected)(*at), rtol=1e-10, atol=1e-12
        )
