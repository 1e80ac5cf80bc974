"""Residuals and determinants of the blocks at many points in one call."""

import casadi as ca
import numpy as np
import pytest
from solve_examples import build, symbols

from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.symbolic.equations import Block

SIZES = (1, 2, 4)
ALGEBRA = 1e-12


def linear_blocks():
    """Blocks A z = (t, x, x, ...) of several sizes; all matrices are parameters."""
    t, x = symbols("t", "x")
    unknowns = [symbols(*[f"z{n}{k}" for k in range(n)]) for n in SIZES]
    matrices = [symbols(*[f"a{n}{k}" for k in range(n * n)]) for n in SIZES]
    residuals, blocks, start = [], [], 0
    for n, z, a in zip(SIZES, unknowns, matrices, strict=True):
        product = ca.reshape(ca.vertcat(*a), n, n) @ ca.vertcat(*z)
        residuals += [product[k] - (x if k else t) for k in range(n)]
        blocks.append(Block(f"block_{n}", start, start + n, 1e-12))
        start += n
    return build(
        "linear blocks",
        time=t,
        states=[(x, 1.0)],
        rates=[0.0],
        parameters=[(a, 0.0) for group in matrices for a in group],
        outputs=[],
        unknowns=[(z, 0.0) for group in unknowns for z in group],
        residuals=residuals,
        blocks=tuple(blocks),
    )


@pytest.mark.parametrize("seed", range(5))
def test_survey_of_linear_blocks(backend, seed):
    rng = np.random.default_rng(seed)
    matrices = [rng.normal(size=(n, n)) for n in SIZES]
    if seed == 3:
        matrices[2][:, 0] = 0.0  # no pivot in the first column
    if seed == 4:
        matrices[2] = np.eye(4)[[1, 2, 3, 0]]  # an exchange of rows at every step
    values = np.concatenate([a.ravel(order="F") for a in matrices])
    kernel = compile_kernel(linear_blocks(), backend=backend).with_parameters(values)
    times, states = rng.normal(size=3), rng.normal(size=(3, 1))
    unknowns = rng.normal(size=(3, sum(SIZES)))
    expected = [np.linalg.det(a) for a in matrices]
    found = kernel.pivots(times, states, unknowns)
    assert found == pytest.approx(np.array([expected] * 3), rel=ALGEBRA, abs=ALGEBRA)
    residuals = kernel.engine.survey(times, states, unknowns, kernel.engine.prepare(values))[0]
    for row, (t, x, z) in enumerate(zip(times, states, unknowns, strict=True)):
        parts = [kernel.block(k, t, x, z)[0] for k in range(len(SIZES))]
        assert residuals[row] == pytest.approx([np.abs(p).max() for p in parts], rel=ALGEBRA)
