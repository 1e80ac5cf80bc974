"""Loops that stand far from the origin of the body that carries them lose no digits."""

import numpy as np
import pytest

from vehicledyn.multibody import GROUND, BallCut, Body, Joint, ParameterTable, RodCut, System
from vehicledyn.multibody.equations.derivation import derive
from vehicledyn.symbolic import ops

FAR, EXACT = 1024.0, 3e-15
SOLID = {"mass": 1.0, "com": (0.3, 0.0, 0.0), "inertia": (0.1, 0.1, 0.1)}


def linkage(place, *, as_parameter):
    """A crank, and a rocker that a ball cut or a rod ties to it, at a distance from the origin."""
    table = ParameterTable()
    x = table.add("place", place, "m", "Place") if as_parameter else place
    crank = Body("crank", GROUND, (x, 0.0, 0.0), (Joint("R3", "crank.angle", 1.3),), **SOLID)
    bar = Body("bar", "crank", (0.5, 0.0, 0.0), (Joint("R3", "bar.angle", -0.9),), **SOLID)
    joints = (Joint("T2", "rocker.y", 0.02), Joint("R3", "rocker.angle", 1.8))
    rocker = Body("rocker", GROUND, (x + 0.75, 0.1, 0.0), joints, **SOLID)
    cuts = (
        BallCut("pin", "bar", (0.6, 0.0, 0.0), "rocker", (0.6, 0.0, 0.0)),
        RodCut("rod", "crank", (0.5, 0.2, 0.0), "rocker", (0.3, 0.0, 0.1), 0.6),
    )
    return derive(System("linkage", table, (crank, bar, rocker), cuts, gravity=(0.0, -9.81, 0.0)))


@pytest.mark.parametrize("as_parameter", [False, True])
def test_residuals_and_rates_are_those_at_the_origin(as_parameter):
    """Counted from the ground's origin, gaps would be lost in 1e-13 m, the rounding of 1 km."""
    near, far = (linkage(place, as_parameter=as_parameter) for place in (0.0, FAR))
    rng = np.random.default_rng(4)
    for _ in range(20):
        x = [s.start + rng.uniform(-0.1, 0.1) for s in near.states]
        z = [u.start + rng.uniform(-0.1, 0.1) for u in near.unknowns]
        found = []
        for e in (near, far):
            inputs = [e.time, e.state, e.algebraic, e.parameter]
            column = ops.stacked(e.residual, e.rate)
            values = [p.value for p in e.parameters]
            found.append(ops.numeric(inputs, column)(0.0, x, z, values)[:, 0])
        gap = slice(0, len(near.unknowns))
        assert found[1][gap] == pytest.approx(found[0][gap], rel=0.0, abs=EXACT)
