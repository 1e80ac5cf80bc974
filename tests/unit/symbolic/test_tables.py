"""Tables evaluate, differentiate and continue like the spline they come from."""

import gc

import casadi as ca
import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.table_calls import settled, tables_in
from vehicledyn.symbolic.tables import CurveTable

START, STEP = -0.7, 0.13
KNOTS = START + STEP * np.arange(12)
VALUES = np.random.default_rng(4).normal(size=12)
TABLE = CurveTable.through("profile", START, STEP, VALUES)
SPLINE = CubicSpline(KNOTS, VALUES)
INSIDE = np.random.default_rng(5).uniform(KNOTS[0], KNOTS[-1], 40)


def evaluated(expression, symbol, places):
    function = ca.Function("f", [symbol], [expression])
    return np.array([float(function(place)) for place in places])


@pytest.mark.parametrize("derivative", range(3))
def test_floats_arrays_and_expressions_agree_with_the_spline(derivative):
    x = ops.symbol("x")
    method = (TABLE.value, TABLE.slope, TABLE.curvature)[derivative]
    expected = SPLINE(INSIDE, derivative)
    scale = np.abs(expected).max()
    assert method(INSIDE) == pytest.approx(expected, abs=1e-12 * scale)
    assert [method(float(place)) for place in INSIDE] == list(method(INSIDE))
    assert evaluated(method(x), x, INSIDE) == pytest.approx(expected, abs=1e-12 * scale)


@pytest.mark.parametrize("make", ["forward", "backward", "jacobian"])
def test_derivatives_of_expressions_are_exact(make):
    """Up to the third, by each mode, with the place itself an expression and used twice."""
    x = ops.symbol("x")
    modes = {
        "forward": lambda e: ca.jtimes(e, x, 1.0),
        "backward": lambda e: ca.jtimes(e, x, 1.0, True),
        "jacobian": lambda e: ops.jacobian(e, x),
    }
    e = TABLE.value(2.0 * x - 0.3)
    places = (INSIDE + 0.3) / 2.0
    for derivative in range(1, 4):
        e = modes[make](e)
        expected = 2.0**derivative * SPLINE(INSIDE, derivative)
        scale = np.abs(expected).max()
        assert evaluated(e, x, places) == pytest.approx(expected, abs=1e-12 * scale)


def test_derivatives_among_many_values_keep_their_places():
    """CasADi leaves the slope of a call without one as it was left by an earlier value."""
    x, y = ops.symbol("x"), ops.symbol("y")
    other = CurveTable.through("other", 0.0, 0.5, [0.0, 2.0, 1.0, 5.0, 3.0])
    value = ops.sin(x * y) * TABLE.value(0.2 * x * y) + other.value(x + y) * TABLE.value(0.2 * y)
    both = ca.vertcat(x, y)
    point, direction = np.array([1.1, 0.4]), np.array([0.7, -1.3])
    u, v = point
    sine, cosine = np.sin(u * v), np.cos(u * v)
    a, da = SPLINE(0.2 * u * v), 0.2 * SPLINE(0.2 * u * v, 1)
    b, db = SPLINE(0.2 * v), 0.2 * SPLINE(0.2 * v, 1)
    c, dc = other.value(u + v), other.slope(u + v)
    by_u = (cosine * a + sine * da) * v + dc * b
    by_v = (cosine * a + sine * da) * u + dc * b + c * db
    expected = by_u * direction[0] + by_v * direction[1]
    for slope in (
        ca.jtimes(value, both, ca.DM(direction)),
        ops.derivative(value, both, ca.DM(direction)),
        ca.dot(ops.jacobian(value, both), ca.DM(direction).T),
    ):
        assert float(ca.Function("f", [both], [slope])(point)) == pytest.approx(expected, rel=1e-12)


def test_settled_derivatives_call_nothing_but_cells():
    x = ops.symbol("x")
    raw = ca.jtimes(ca.jtimes(TABLE.value(x * x), x, 1.0), x, 1.0)
    kept = settled(raw)
    names = {name[:7] for name in ca.Function("f", [x], [kept]).get_function()}
    assert names == {"cell_of"}
    assert ca.n_nodes(kept) < ca.n_nodes(raw)
    assert evaluated(kept, x, [0.3]) == pytest.approx(evaluated(raw, x, [0.3]), rel=1e-13)


@pytest.mark.parametrize("side", [0, -1])
def test_curve_goes_on_straight_beyond_its_ends(side):
    x = ops.symbol("x")
    edge, outward = KNOTS[side], (-1.0, 1.0)[side]
    slope = SPLINE(edge, 1)
    for far in (1e-9, 0.05, 40.0):
        place, expected = edge + outward * far, SPLINE(edge) + slope * outward * far
        for value in (TABLE.value(place), *evaluated(TABLE.value(x), x, [place])):
            assert value == pytest.approx(expected, rel=1e-12, abs=1e-12)
        assert evaluated(TABLE.slope(x), x, [place])[0] == pytest.approx(slope, rel=1e-12)
        assert TABLE.curvature(place) == 0.0


def test_places_that_are_no_numbers_give_none():
    x = ops.symbol("x")
    assert np.isnan(TABLE.value(np.nan))
    assert np.isnan(evaluated(TABLE.value(x), x, [np.nan])).all()


def test_polynomials_of_any_order():
    """One cell of order five, given in its own coordinate."""
    coefficients = [[1.0, -2.0, 0.5, 3.0, -1.0, 0.25]]
    table = CurveTable("quintic", 2.0, 0.5, coefficients)
    u = (2.2 - 2.0) / 0.5
    polynomial = np.polynomial.Polynomial(coefficients[0])
    x = ops.symbol("x")
    assert table.value(2.2) == pytest.approx(polynomial(u), rel=1e-14)
    assert evaluated(table.slope(x), x, [2.2])[0] == pytest.approx(
        polynomial.deriv()(u) / 0.5, rel=1e-14
    )
    assert table.stop == 2.5
    assert CurveTable("line", 0.0, 2.0, [[1.0, 4.0]]).curvature(np.zeros(2)).tolist() == [0, 0]


def test_cubics_come_out_exactly():
    places = 0.3 + 0.2 * np.arange(5)
    table = CurveTable.through("cubic", 0.3, 0.2, places**3)
    assert table.value(0.555) == pytest.approx(0.555**3, rel=1e-12)


def test_tables_of_expressions_are_found_once_and_kept_alive_by_themselves():
    x = ops.symbol("x")
    first = CurveTable.through("a", 0.0, 1.0, [0.0, 1.0, 4.0])
    twin = CurveTable.through("a", 0.0, 1.0, [0.0, 1.0, 4.0])
    e = first.value(x) + twin.value(2.0 * x) + TABLE.value(x)
    assert [table.name for table in tables_in([e])] == ["a", "profile"]
    del first
    gc.collect()
    assert tables_in([e])[0].value(2.0) == twin.value(2.0)
    del twin
    gc.collect()
    with pytest.raises(ValueError, match="keep it as long as its expressions"):
        tables_in([e])


@pytest.mark.parametrize(
    ("start", "step", "coefficients", "message"),
    [
        (0.0, 1.0, [1.0, 2.0], "shape"),
        (0.0, 1.0, [[1.0]], "shape"),
        (0.0, 0.0, [[1.0, 2.0]], "positive step"),
        (0.0, 1.0, [[1.0, np.inf]], "finite"),
    ],
)
def test_impossible_tables_are_refused(start, step, coefficients, message):
    with pytest.raises(ValueError, match=message):
        CurveTable("bad", start, step, coefficients)
