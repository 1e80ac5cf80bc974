"""Saddle-point systems: unrolled and by a sparse call, against a dense solution."""

import numpy as np
import pytest

from vehicledyn.symbolic import kkt, ops
from vehicledyn.symbolic.kkt import SaddlePoint


@pytest.mark.parametrize("limit", [10_000, 0])
def test_solution_is_that_of_the_dense_system(limit, monkeypatch):
    monkeypatch.setattr(kkt, "MOST_UNROLLED", limit)
    random = np.random.default_rng(4)
    n, m = 7, 4
    root = random.normal(size=(n, n))
    mass, jacobian = root @ root.T + np.eye(n), random.normal(size=(m, n))
    right = random.normal(size=n + m)
    x = ops.symbol("x")
    rows = [{j: x * float(v) for j, v in enumerate(row)} for row in mass]
    saddle = SaddlePoint(
        rows, [{j: ops.scalar(float(v)) for j, v in enumerate(r)} for r in jacobian]
    )
    assert saddle.is_unrolled == (limit > 0)
    solution = ops.column(saddle.solve([ops.scalar(float(v)) for v in right]))
    found = ops.numeric([x], solution)(2.0)[:, 0]
    whole = np.block([[2.0 * mass, jacobian.T], [jacobian, np.zeros((m, m))]])
    assert found == pytest.approx(np.linalg.solve(whole, right), abs=1e-11)
