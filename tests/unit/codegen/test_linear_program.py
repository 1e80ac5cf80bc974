"""Linear programs of derivatives: their rows, their order, and slopes of single operations."""

import casadi
import numpy as np
import pytest

from vehicledyn.codegen.passes.kernel_functions import as_written
from vehicledyn.codegen.passes.linear_program import Writer
from vehicledyn.codegen.passes.local_slopes import local_slope
from vehicledyn.codegen.passes.row_order import by_parts
from vehicledyn.codegen.passes.vertex_elimination import LinearRows


def jacobian_of(rows):
    """Return the derivatives of the targets by the sources."""
    columns = [*np.eye(rows.n_sources)]
    for k in range(len(rows.starts) - 1):
        own = range(rows.starts[k], rows.starts[k + 1])
        columns.append(sum(rows.weights[i] * columns[rows.columns[i]] for i in own))
    return np.array([columns[k] for k in rows.targets])


def test_rows_of_a_part_follow_each_other():
    """Two chains, mixed, that meet in a sum; a row that nothing needs is left out."""
    entries = [[0], [1], [2], [3], [4], [5], [0, 1], [6, 7]]
    starts = [0, *map(int, np.cumsum([len(own) for own in entries]))]
    columns = [column for own in entries for column in own]
    weights = [1.5 + k for k in range(len(columns))]
    before = LinearRows(2, starts, columns, weights, [9, 0])
    after = by_parts(before)
    assert after.columns == [0, 2, 3, 1, 5, 6, 4, 7]
    assert jacobian_of(after) == pytest.approx(jacobian_of(before), rel=1e-15)


@pytest.mark.parametrize("values", [(1.0, 2.0), (2.0, 1.0), (1.5, 1.5)])
def test_the_lesser_and_the_larger_have_slopes_as_casadi_has_them(values):
    """One, zero, and a half where both are equal."""
    a, b = casadi.SX.sym("a"), casadi.SX.sym("b")
    for code, result in ((casadi.OP_FMIN, casadi.fmin(a, b)), (casadi.OP_FMAX, casadi.fmax(a, b))):
        exact = casadi.Function("f", [a, b], [casadi.jacobian(result, casadi.vertcat(a, b))])
        own = [local_slope(code, place, [a, b], result) for place in range(2)]
        found = casadi.Function("g", [a, b], [casadi.horzcat(*own)])
        assert np.array(found(*values)) == pytest.approx(np.array(exact(*values)), abs=0.0)


def test_a_quotient_is_divided_once():
    """Value and slopes of a / b take one division."""
    a, b, c = (casadi.SX.sym(name) for name in "abc")
    writer = Writer(3)
    targets, values = writer.written(a / b, [a, b, c], {0: [0], 1: [1], 2: [2]})
    with as_written():
        results = casadi.cse([values, *writer.weights.expressions])
    function = casadi.Function("all", [a, b, c], results)
    codes = [function.instruction_id(k) for k in range(function.n_instructions())]
    assert sum(code in (casadi.OP_DIV, casadi.OP_INV) for code in codes) == 1
    assert len(targets) == 1
    assert [float(item) for item in function(3.0, 4.0, 0.0)] == pytest.approx(
        [0.75, 0.25, -0.1875], rel=1e-15
    )
