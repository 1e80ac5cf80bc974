"""Operations on numbers alone: what CasADi computes, without it."""

import itertools
import math

import casadi
import pytest

from vehicledyn.symbolic import ops

NUMBERS = (0.0, -0.0, 1.0, -1.0, 0.3, -2.7, 1e-9, 800.0, math.inf, -math.inf, math.nan)
UNARY = {
    ops.tan: casadi.tan,
    ops.atan: casadi.atan,
    ops.asin: casadi.asin,
    ops.exp: casadi.exp,
    ops.log: casadi.log,
    ops.tanh: casadi.tanh,
    ops.sqrt: casadi.sqrt,
    ops.absolute: casadi.fabs,
    ops.sign: casadi.sign,
}


def same(found, expected):
    """Whether two numbers are equal, signs of zeros and no numbers included."""
    assert type(found) is float
    if math.isnan(expected):
        return math.isnan(found)
    return found == pytest.approx(expected, rel=1e-15, abs=0.0) and (
        math.copysign(1.0, found) == math.copysign(1.0, expected)
    )


@pytest.mark.parametrize("operation", UNARY, ids=lambda item: item.__name__)
def test_one_number(operation):
    for x in NUMBERS:
        assert same(operation(x), UNARY[operation](x)), x


@pytest.mark.parametrize(
    ("operation", "expected"), [(ops.minimum, casadi.fmin), (ops.maximum, casadi.fmax)]
)
def test_two_numbers(operation, expected):
    for x, y in itertools.product(NUMBERS, NUMBERS):
        assert same(operation(x, y), expected(x, y)), (x, y)


@pytest.mark.parametrize("condition", [True, False, 0.0, 2.0, math.nan])
def test_a_choice(condition):
    for yes, no in itertools.product(NUMBERS, NUMBERS):
        assert same(ops.where(condition, yes, no), float(casadi.if_else(condition, yes, no)))
