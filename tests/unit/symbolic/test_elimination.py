import casadi as ca
import numpy as np
import pytest

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import (
    solve_in_order,
    solve_symmetric,
    transpose,
    triangular_blocks,
)

SEEDS = range(8)


def sparse_matrix(rng, n, share=0.35):
    """A well-conditioned matrix with random zeros and a strong diagonal, rows shuffled."""
    a = np.where(rng.random((n, n)) < share, rng.normal(size=(n, n)), 0.0)
    return a + np.diag(rng.choice([-1.0, 1.0], n) * (2.0 + np.abs(a).sum(axis=1)))


def symbolic(matrix):
    """Rows of symbols for the nonzeros, with a function that puts the numbers back."""
    rows, symbols, values = [], [], []
    for row in matrix:
        entries = {int(j): ops.symbol("a") for j in np.flatnonzero(row)}
        rows.append(entries)
        symbols += entries.values()
        values += [row[j] for j in entries]
    return rows, ops.column(symbols), np.array(values)


@pytest.mark.parametrize("seed", SEEDS)
def test_solve_in_order(seed):
    rng = np.random.default_rng(seed)
    a, b = sparse_matrix(rng, 7), rng.normal(size=(7, 3))
    shuffled = rng.permutation(7)
    a, b = a[shuffled], b[shuffled]
    rows, symbols, values = symbolic(a)
    order = [(k, int(shuffled[k])) for k in rng.permutation(7)]
    right = [{k: ops.scalar(v) for k, v in enumerate(row)} for row in b]
    x = solve_in_order(rows, right, order)
    found = ops.numeric([symbols], ops.column([x[i][k] for i in range(7) for k in range(3)]))
    expected = np.linalg.solve(a, b)
    assert found(values)[:, 0].reshape(7, 3) == pytest.approx(expected, rel=1e-12, abs=1e-13)


@pytest.mark.parametrize("seed", SEEDS)
def test_solve_symmetric(seed):
    rng = np.random.default_rng(seed)
    half = np.tril(sparse_matrix(rng, 8, 0.2))
    a, b = half @ half.T, rng.normal(size=8)
    rows, symbols, values = symbolic(a)
    found = ops.numeric([symbols], ops.column(solve_symmetric(rows, [ops.scalar(v) for v in b])))
    assert found(values)[:, 0] == pytest.approx(np.linalg.solve(a, b), rel=1e-11, abs=1e-12)


def test_solve_symmetric_makes_no_fill_in_on_an_arrow():
    """Leaves are eliminated before the root that couples them."""
    n = 12
    rows = [{0: ops.symbol("b"), k: ops.symbol("d")} for k in range(n)]
    rows[0] = {0: ops.symbol("root"), **{k: rows[k][0] for k in range(1, n)}}
    x = solve_symmetric(rows, [ops.symbol("r") for _ in range(n)])
    operations = ca.Function("f", ca.symvar(ops.column(x)), [ca.cse(ops.column(x))]).n_nodes()
    assert operations < 20 * n


def test_transpose():
    assert transpose([{0: 1.0, 2: 2.0}, {1: 3.0}], 3) == [{0: 1.0}, {1: 3.0}, {0: 2.0}]


@pytest.mark.parametrize("seed", SEEDS)
def test_triangular_blocks_are_the_mutually_reachable_sets(seed):
    rng = np.random.default_rng(seed)
    n = 9
    pattern = [{int(j) for j in np.flatnonzero(rng.random(n) < 0.15)} | {i} for i in range(n)]
    reach = np.zeros((n, n), bool)
    for i, row in enumerate(pattern):
        reach[i, list(row)] = True
    for k in range(n):
        reach |= np.outer(reach[:, k], reach[k])
    blocks = triangular_blocks(pattern)
    assert sorted(i for block in blocks for i in block) == list(range(n))
    done = set()
    for block in blocks:
        done |= set(block)
        for i in block:
            assert {j for j in range(n) if reach[i, j] and reach[j, i]} == set(block)
            assert {j for j in range(n) if reach[i, j]} <= done


def test_triangular_blocks_of_a_chain_come_in_the_order_of_solution():
    assert triangular_blocks([{0, 1}, {1, 2}, {2}]) == [[2], [1], [0]]
