"""Equations that were written as a text are the same: values, derivatives, tables, functions."""

import json
from dataclasses import replace
from weakref import WeakValueDictionary

import casadi as ca
import numpy as np
import pytest

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.symbolic import ops, shared, tables
from vehicledyn.symbolic.cached_equations import expressions_of, facts_of, whole_equations
from vehicledyn.symbolic.equations import (
    Attitude,
    Channel,
    Equations,
    Event,
    ParameterValue,
    Seam,
    Variable,
    with_tables,
)
from vehicledyn.symbolic.table_calls import tables_in

CURVE = tables.CurveTable.through("curve", 0.0, 0.1, np.sin(np.linspace(0.0, 1.0, 11)))


def model():
    """Return equations that look a table up, by themselves and in a shared function."""
    time, x, p = ca.SX.sym("t"), ca.SX.sym("x", 2), ca.SX.sym("p")

    def body(given):
        return [CURVE.value(given[0] * given[1]) * given[0], CURVE.slope(given[0] + given[1])]

    found = shared.shared("pair", [x[0], x[1]], body)
    rate = ca.vertcat(CURVE.value(x[0] * x[1]) + found[0] * found[1], p * found[1] - time)
    handed = ca.SX.sym("s")
    whole = with_tables(
        Equations(
            name="pair",
            time=time,
            state=x,
            algebraic=ca.SX(0, 1),
            parameter=p,
            rate=rate,
            residual=ca.SX(0, 1),
            output=x[0] * p,
            event=x[1],
            states=tuple(Variable(name, "m", name) for name in "ab"),
            unknowns=(),
            parameters=(ParameterValue("p", "1", "p", 0.7),),
            channels=(Channel("y", "m", "y"),),
            events=(Event("zero", 0, resets=((0, 0),)),),
            attitudes=(Attitude((0, 1, 0, 1), (0, 1, 0)),),
            reset=2.0 * x[0],
        )
    )
    opened = replace(whole, rate=rate + handed)
    return replace(whole, seam=Seam(("s",), handed, p * x, ("driver",), opened))


def read_again(equations):
    """Return equations by way of JSON."""
    text = json.dumps([facts_of(equations), expressions_of(equations)])
    return whole_equations(*json.loads(text), None)


def numbers(e):
    """Return rates and their derivatives of the first three orders as numbers."""
    direction = ca.SX([0.3, -0.8])
    slope = ops.jacobian(e.rate, e.state)
    bend = ops.jacobian(ops.jacobian(e.rate[0], e.state), e.state)
    along = ops.jacobian(ca.dot(e.rate, ops.derivative(e.rate, e.state, direction)), e.state)
    third = ops.derivative(bend, e.state, direction)
    values = [e.rate, slope, bend, along, third, e.output, e.event, e.reset, e.seam.values]
    function = ca.Function("numbers", [e.time, e.state, e.parameter], values)
    return [np.array(item) for item in function(0.1, [0.3, 0.7], 1.3)]


def test_values_and_derivatives_are_the_same():
    before = model()
    after = read_again(before)
    assert (after.states, after.events, after.attitudes, after.parameters) == (
        before.states,
        before.events,
        before.attitudes,
        before.parameters,
    )
    assert (after.seam.names, after.seam.parts) == (("s",), ("driver",))
    opened = ca.Function("opened", [after.seam.symbols], [after.seam.opened.rate - after.rate])
    assert np.array_equal(np.array(opened(0.25)).ravel(), [0.25, 0.25])
    assert after.slopes is None
    for found, expected in zip(numbers(after), numbers(before), strict=True):
        assert np.isfinite(found).all()
        np.testing.assert_array_equal(found, expected)


def test_tables_and_shared_functions_are_known_where_none_was_made(monkeypatch):
    """As in the next process: functions are written out and tables found all the same."""
    before = model()
    text = json.dumps([facts_of(before), expressions_of(before)])
    monkeypatch.setattr(tables, "_CALLS", WeakValueDictionary())
    monkeypatch.setattr(shared, "_FUNCTIONS", BoundedCache(8))
    monkeypatch.setattr(shared, "_BODIES", BoundedCache(8))
    after = whole_equations(*json.loads(text), None)
    assert [table.name for table in tables_in([after.rate])] == ["curve"]
    plain = shared.inlined(after.rate)
    called = ca.Function("f", [after.time, after.state, after.parameter], [plain]).get_function()
    assert called
    assert not any(shared.is_shared(name) for name in called)


def test_bytes_that_are_no_expressions_are_refused():
    facts, expressions = facts_of(model()), expressions_of(model())
    with pytest.raises((RuntimeError, ValueError, ArithmeticError, LookupError)):
        whole_equations(facts, expressions | {"content": "AAAA"}, None)
