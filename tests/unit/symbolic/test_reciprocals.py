"""Reciprocals of several values: right, and of one division where code is generated."""

import casadi as ca
import numpy as np
import pytest

from vehicledyn.codegen.ir.instructions import read_function
from vehicledyn.codegen.passes.kernel_functions import apart_from_parameters
from vehicledyn.symbolic import ops


@pytest.mark.parametrize("n", [1, 2, 3, 4, 7])
def test_of_symbols(n):
    x, p = ca.SX.sym("x", n), ca.SX.sym("p")
    values = [x[k] for k in range(n)]
    _, function = apart_from_parameters([x, p], [ca.vertcat(*ops.reciprocals(*values))])
    operations = [item.operation for item in read_function(function).instructions]
    assert operations.count("DIV") + operations.count("INV") == 1
    place = np.random.default_rng(n).uniform(0.2, 5.0, n) * (-1.0) ** np.arange(n)
    found = np.array(function(place, [])).ravel()
    assert found == pytest.approx(1.0 / place, rel=2e-15)


def test_plain_numbers_take_no_part():
    x = ca.SX.sym("x")
    found = ops.reciprocals(4.0, x, 1.0)
    assert found[0] == 0.25
    assert found[2] == 1.0
    assert ca.is_equal(found[1], 1.0 / x, 2)
