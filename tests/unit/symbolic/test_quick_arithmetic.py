"""Quick operators of expressions: the same expressions as CasADi's own, and only meanwhile."""

import operator

import casadi as ca
import numpy as np
import pytest

from vehicledyn.symbolic.quick_arithmetic import quick_arithmetic

OPERATIONS = (operator.add, operator.sub, operator.mul, operator.truediv)
X, V = ca.SX.sym("x"), ca.SX.sym("v", 3)
SPARSE = ca.SX(3, 1)
SPARSE[1] = X
OTHERS = (X, V, SPARSE, 2.5, 1.0, 0.0, 3, ca.DM([1.0, 2.0, 3.0]), ca.SX(0.0), np.float64(0.3))


@pytest.mark.parametrize("operation", OPERATIONS)
def test_expressions_are_the_same(operation):
    pairs = [(own, other) for own in (X, V, SPARSE) for other in OTHERS]
    pairs += [(other, own) for own, other in pairs]
    usual = [operation(a, b) for a, b in pairs]
    with quick_arithmetic():
        quick = [operation(a, b) for a, b in pairs]
    for one, two in zip(usual, quick, strict=True):
        assert one.sparsity() == two.sparsity()
        assert ca.is_equal(one, two, 3)


def test_operators_are_given_back():
    before = ca.SX.__mul__
    with pytest.raises(KeyError), quick_arithmetic():
        assert ca.SX.__mul__ is not before
        with quick_arithmetic():
            assert ca.is_equal(X * 1.0, X)
        raise KeyError
    assert ca.SX.__mul__ is before


def test_other_operands_are_refused_as_usual():
    with quick_arithmetic(), pytest.raises(TypeError):
        X * object()
