"""Patterns of iteration matrices: nothing is left out, and factors fill in as foreseen."""

import numpy as np
import pytest
from chain_examples import chain
from solve_examples import double_pendulum, slider_crank, starts

from vehicledyn.integrate.newmark.matrix_pattern import eliminated, pattern_of, rates_by_states
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.multibody import derive


def four_bars():
    return derive(chain(3, method="partitioning"))


@pytest.mark.parametrize("make", [slider_crank, double_pendulum, four_bars])
def test_all_entries_are_foreseen(make):
    equations, rng = make(), np.random.default_rng(2)
    depends = rates_by_states(equations)
    derivatives = Derivatives(equations, outputs=False)
    values = np.array([p.value for p in equations.parameters])
    state, unknowns = (np.asarray(item) for item in starts(equations))
    for _ in range(3):
        moved = [item + 0.1 * rng.normal(size=len(item)) for item in (state, unknowns)]
        found = derivatives.total(0.3, *moved, values).rates
        assert not (found[~depends] != 0.0).any()
        assert (found != 0.0).sum() > 0.5 * depends.sum()


def test_loops_couple_what_they_join():
    equations = slider_crank()
    assert rates_by_states(equations).tolist() == [[False, True], [True, True]]


@pytest.mark.parametrize("seed", range(5))
def test_factors_fill_in_as_foreseen(seed):
    rng, n = np.random.default_rng(seed), 14
    matrix = (rng.random((n, n)) < 0.12) | np.eye(n, dtype=bool)
    order, below = eliminated(matrix)
    assert sorted(order) == list(range(n))
    full = np.where(matrix, rng.normal(size=(n, n)), 0.0) + 20.0 * np.eye(n)
    own = full[np.ix_(order, order)]
    foreseen = np.eye(n, dtype=bool)
    for j, rows in enumerate(below):
        foreseen[rows, j] = foreseen[j, rows] = True
    for j in range(n):
        own[j + 1 :, j] /= own[j, j]
        own[j + 1 :, j + 1 :] -= np.outer(own[j + 1 :, j], own[j, j + 1 :])
    assert not (own[~foreseen] != 0.0).any()


def test_a_star_is_eliminated_from_its_ends():
    star = np.eye(9, dtype=bool)
    star[0], star[:, 0] = True, True
    order, below = eliminated(star)
    assert order[-1] == 0 or order[-2] == 0
    assert [len(rows) for rows in below] == [1] * 8 + [0]


def test_columns_of_a_colour_share_no_row():
    equations = derive(chain(3, method="partitioning"))
    pattern = pattern_of(equations, rates_by_states(equations))
    for first, last in zip(pattern.colour_starts, pattern.colour_starts[1:], strict=False):
        columns = pattern.colour_columns[first:last]
        rows = np.concatenate([pattern.rows[pattern.columns == k] for k in columns])
        assert len(set(rows)) == len(rows) > 0
    assert len(set(pattern.places)) == len(
        {(r, int(p)) for r, p in zip(pattern.rows, pattern.places, strict=True)}
    )


def test_no_states_have_no_pattern():
    order, below = eliminated(np.zeros((0, 0), dtype=bool))
    assert (len(order), below) == (0, [])
