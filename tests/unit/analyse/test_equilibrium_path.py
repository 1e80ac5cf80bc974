"""Equilibria that no direct search finds are followed from where one does."""

import casadi as ca
import numpy as np
import pytest
from solve_examples import build, starts, symbols

from vehicledyn.analyse.equilibrium import EquilibriumPoint, find_equilibrium
from vehicledyn.analyse.equilibrium_path import follow_equilibrium
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.kernel.make_kernel import compile_kernel

PAIRS = {"free": [0], "balanced": [1]}


def held(place):
    """A mass that a saturating force holds at a place that time moves."""
    t, x, rate = symbols("t", "x", "rate")
    return build(
        "held",
        time=t,
        states=[(x, 0.0), (rate, 0.0)],
        rates=[rate, -ca.tanh(20.0 * (x - place(t)))],
        parameters=[],
        outputs=[("x", x)],
    )


def followed(equations):
    kernel = compile_kernel(equations, backend="interpreted")
    state, unknowns = starts(equations)
    with pytest.raises(NumericalError):
        find_equilibrium(
            equations, kernel, time=4.0, state=state, unknowns=unknowns, tolerance=1e-9, **PAIRS
        )
    return follow_equilibrium(
        equations,
        kernel,
        EquilibriumPoint(np.asarray(state, dtype=float), np.asarray(unknowns), 0.0, 0),
        times=(0.0, 4.0),
        tolerance=1e-9,
        derivatives=Derivatives(equations),
        settling=1e-2,
        **PAIRS,
    )


@pytest.mark.parametrize("jump", [0.0, 1.5])
def test_a_place_that_moves_or_jumps_is_followed(jump):
    found = followed(held(lambda t: 0.5 * t + jump * (t > 1.3)))
    assert found.state == pytest.approx([2.0 + jump, 0.0], abs=1e-9)
    assert found.residual <= 1e-9


def test_a_path_that_ends_says_where():
    equations = held(lambda t: 0.5 * t + ca.if_else(t > 3.0, 1e6, 0.0))
    with pytest.raises(NumericalError, match=r"no equilibrium at t = 3\.\d+ s"):
        followed(equations)
