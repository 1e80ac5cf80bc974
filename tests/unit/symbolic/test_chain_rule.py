"""Jacobians through shared calls are those of the same expressions written out."""

import casadi
import numpy as np
import pytest

from vehicledyn.kernel.point_slopes import PointCode
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.chain_rule import values_and_jacobian
from vehicledyn.symbolic.shared import inlined, shared


def spring(given):
    length, rate, stiffness = given
    return [ops.sin(length) * stiffness * rate, stiffness * length, rate**3]


def nested():
    """A call whose argument is a result of another one, a result in no use, a fixed argument."""
    x, p = ops.symbols("x", 4), ops.symbols("p", 2)
    first = shared("spring", [x[0], x[1], p[0]], spring)
    second = shared("spring", [first[0] * x[2], x[1] - x[0], p[1]], spring)
    values = ops.stacked(first[0] + x[3], second[0] * second[1], x[3] ** 2 * p[1])
    return values, x, p


def test_jacobian_is_that_of_the_expressions_written_out():
    values, x, p = nested()
    moving = ops.stacked(x, p[0])
    found, slopes = values_and_jacobian(values, moving)
    wanted = inlined(values)
    either = casadi.Function(
        "either", [x, p], [found - wanted, slopes - casadi.jacobian(wanted, moving)]
    )
    at = np.random.default_rng(3).uniform(0.3, 1.2, 6)
    for difference in either(at[:4], at[4:]):
        assert np.abs(np.array(difference)).max() < 1e-13
    assert slopes.nnz() < slopes.numel()  # the third value has one derivative only


def test_whole_jacobians_are_compiled_like_directional_ones(needs_compiler):
    values, x, p = nested()
    points = np.random.default_rng(4).uniform(0.3, 1.2, (11, 4))
    both = [PointCode(values, x, p, (), index=1, often=often) for often in (False, True)]
    (one, first), (other, second) = (code.slopes(points, np.array([0.7, 1.9])) for code in both)
    assert other == pytest.approx(one, rel=1e-13)
    assert second == pytest.approx(first, rel=1e-12, abs=1e-14)
    assert np.count_nonzero(first) > 0.4 * first.size
