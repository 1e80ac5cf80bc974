"""What accelerations fulfil: nothing is missing at those that the equations of motion give."""

import casadi
import numpy as np
import pytest
from random_systems import body_loop, planar_loop, rod_loops, spatial_loop, tree

from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody import derive
from vehicledyn.symbolic.shared import inlined


@pytest.mark.parametrize(
    "make", [tree, spatial_loop, body_loop, rod_loops, planar_loop], ids=lambda f: f.__name__
)
def test_nothing_is_missing_at_the_accelerations_of_the_equations(make):
    equations = derive(make(1))
    found = equations.motion_residuals()
    kernel = compile_kernel(equations, backend="interpreted")
    x = np.array([v.start for v in equations.states])
    x += 1e-2 * np.random.default_rng(1).uniform(-1.0, 1.0, size=x.size)
    z = kernel.solve_unknowns(0.4, x, np.array([v.start for v in equations.unknowns]))
    a = kernel.rates(0.4, x, z)[list(found.rows)]
    symbols = found.time, found.state, found.algebraic, found.parameter, found.acceleration
    slopes = casadi.jacobian(inlined(found.residual), found.acceleration)
    function = casadi.Function("r", symbols, [found.residual, found.mass, slopes])
    missing, mass, by_acceleration = map(np.array, function(0.4, x, z, kernel.parameters, a))
    scale = np.abs(mass).max() * max(1.0, np.abs(a).max())
    assert len(a) == len(missing) > 0
    assert missing == pytest.approx(0.0, abs=1e-11 * scale)
    assert mass == pytest.approx(mass.T, abs=1e-12 * np.abs(mass).max())
    assert by_acceleration == pytest.approx(mass, abs=1e-11 * np.abs(mass).max())
