"""Numbers of grids that stay out of the code: one code for all of them, each with its own."""

import casadi
import numpy as np
import pytest

from vehicledyn.codegen.toolchain.fingerprint import function_text
from vehicledyn.symbolic.grids.bicubic_grid import BicubicGrid
from vehicledyn.symbolic.grids.grid_table import GridTable
from vehicledyn.symbolic.table_calls import tables_in

RANDOM = np.random.default_rng(7)


def rounded(start, step, right, count):
    across = right + 0.7 * np.arange(4)
    return GridTable("g", start, step, across, RANDOM.normal(size=(count, 4)), rounding=0.05)


def bicubic(start, step, right, count):
    return BicubicGrid("g", start, right, step, RANDOM.normal(size=(count, 4)))


def written(grid):
    """Return the function of a grid's height and slopes, and the text that it is compiled by."""
    place = casadi.SX.sym("place", 2)
    results = casadi.vertcat(grid.value(place[0], place[1]), *grid.slopes(place[0], place[1]))
    function = casadi.Function("ground", [place], [casadi.cse(results)])
    return function, function_text(function, tables_in([results]))


@pytest.mark.parametrize("make", [rounded, bicubic])
def test_grids_of_other_sizes_share_their_code_and_keep_their_heights(make):
    texts = set()
    for grid in (make(0.0, 0.5, -1.0, 9), make(3.0, 0.2, 0.25, 30)):
        function, text = written(grid)
        texts.add(text)
        for u, v in RANDOM.uniform((-2.0, -2.0), (11.0, 4.0), size=(40, 2)):
            plain = [grid.value(u, v), *grid.slopes(u, v)]
            assert function([u, v]).full()[:, 0] == pytest.approx(plain, rel=1e-13, abs=1e-13)
    assert len(texts) == 1
