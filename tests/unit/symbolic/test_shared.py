"""Shared functions: equal to the same expressions written out, in every form they take."""

import casadi as ca
import numpy as np
import pytest

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.symbolic import ops
from vehicledyn.symbolic import shared as shared_functions
from vehicledyn.symbolic.shared import inlined, shared
from vehicledyn.symbolic.tables import CurveTable

TABLE = CurveTable.through("curve", -1.0, 0.25, np.sin(3.0 * np.arange(12)))


def law(values):
    x, y, gain = values
    bent = ops.where(x < 0.3, ops.sin(x) * y, x * x + gain / (1.0 + y * y))
    return [gain * bent + TABLE.value(x), ops.sqrt(1.0 + x * x) * ops.maximum(y, 0.1)]


def both(x):
    """Return the same matrix with shared functions and written out."""
    places = [(x[0], x[1], 2.0), (x[1], x[0] * x[2], 2.0), (x[2], x[1], x[0])]
    with_calls = [item for place in places for item in shared("law", place, law)]
    written = [item for place in places for item in law(list(place))]
    return ca.vertcat(*with_calls), ca.vertcat(*written)


@pytest.fixture
def x():
    return ca.SX.sym("x", 3)


POINTS = [[0.2, 0.7, -0.4], [-0.9, 0.05, 1.2], [0.31, -0.6, 0.8]]


@pytest.mark.parametrize("point", POINTS)
def test_values_and_derivatives_are_those_of_the_written_form(x, point):
    calls, written = both(x)
    pairs = [(calls, written), (ops.jacobian(calls, x), ops.jacobian(written, x))]
    pairs.append((ops.derivative(calls, x, x * x), ops.derivative(written, x, x * x)))
    pairs.append((inlined(calls), written))
    for one, two in pairs:
        found, expected = (np.array(ca.Function("f", [x], [e])(point)) for e in (one, two))
        assert found == pytest.approx(expected, rel=1e-13, abs=1e-14)


def test_equal_places_call_one_function(x):
    calls, _ = both(x)
    functions = ca.Function("f", [x], [calls]).get_function()
    laws = [name for name in functions if name.startswith("shared_")]
    assert len(laws) == 2  # that with the gain 2.0 written into it, and that with a gain given
    assert not [n for n in ca.Function("f", [x], [inlined(calls)]).get_function() if "law" in n]


def test_numbers_alone_need_no_function():
    found = shared("law", (0.2, 0.7, 2.0), law)
    expected = law([0.2, 0.7, 2.0])
    assert [float(item) for item in found] == pytest.approx([float(item) for item in expected])


def test_an_argument_that_is_kept_is_one_function_for_numbers_and_symbols(x):
    """As the rail's own motion is, which widening gives to one of both rails only."""

    def called(place, kept):
        found = shared("law", place, law, kept)
        function = found[0].dep(0).which_function().name()
        return function, ca.Function("f", [x], found)(POINTS[0])

    number, symbol = (x[0], x[1], 2.0), (x[2], x[1], x[0])
    assert called(number, ())[0] != called(symbol, ())[0]
    assert called(number, (2,))[0] == called(symbol, (2,))[0]
    for first, second in zip(called(number, ())[1], called(number, (2,))[1], strict=True):
        assert float(first) == pytest.approx(float(second), rel=1e-15)


def test_what_is_built_for_equal_numbers_is_built_once(x):
    asked, built = [], {}

    def told(values):
        asked.append(values[2])
        return law(values)

    places = [(x[0], x[1], 2.0), (x[1], x[2], 2.0), (0.2, 0.7, 2.0), (x[0], x[1], 3.0)]
    kept = [item for place in places * 2 for item in shared("law", place, told, (), built)]
    fresh = [item for place in places * 2 for item in shared("law", place, law)]
    found, expected = (ca.Function("f", [x], [ca.vertcat(*e)])(POINTS[0]) for e in (kept, fresh))
    assert np.array(found).tolist() == np.array(expected).tolist()
    assert asked == [2.0, 2.0, 3.0]


def test_functions_that_are_kept_no_longer_are_written_out_all_the_same(x, monkeypatch):
    calls, _ = both(x)
    kept = inlined(calls)
    for cache in ("_BODIES", "_FUNCTIONS"):
        monkeypatch.setattr(shared_functions, cache, BoundedCache(1))
    assert not inlined(calls).is_constant()
    again, _ = both(x)  # the same functions anew, in one expression with those of before
    values = [ca.Function("f", [x], [item]) for item in (kept, inlined(calls), again, calls)]
    together = ca.Function("f", [x], [inlined(calls + again) / 2.0])
    assert not [name for name in together.get_function() if "law" in name]
    for point in POINTS:
        found = [np.array(f(point)) for f in (*values, together)]
        assert all(np.array_equal(found[0], other) for other in found[1:])
    assert len(shared_functions._FUNCTIONS) == 1
