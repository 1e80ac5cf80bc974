"""Symbols stay themselves when a value travels as bytes."""

import casadi as ca
import numpy as np
import pytest

from vehicledyn.symbolic.pickled import UNPICKLABLE, modules_of, packed, unpacked


def test_a_symbol_that_occurs_twice_is_one_symbol_afterwards():
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    found = unpacked(packed({"value": ca.sin(x) * y, "x": x, "rest": [x, (y, 2.0)]}))
    assert ca.is_equal(found["x"], found["rest"][0])
    slope = ca.jacobian(found["value"], found["x"])
    assert str(ca.jacobian(slope, found["rest"][1][0])) == "cos(x)"


def test_what_cannot_travel_is_refused_and_modules_are_named():
    with pytest.raises(UNPICKLABLE):
        packed([ca.SX.sym("x"), lambda: None])
    assert modules_of(packed([ca.SX.sym("x"), np.mean])) == {"numpy"}
