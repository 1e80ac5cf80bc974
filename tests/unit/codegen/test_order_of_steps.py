"""Sums written as chains of fused products, and the order of the last steps of a function."""

from collections import Counter
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest
from exact_programs import evaluated

from vehicledyn.codegen.ir.instructions import CONST, INPUT, read_function
from vehicledyn.codegen.passes.fma_chains import chain_products
from vehicledyn.codegen.passes.lowering import fuse, lower
from vehicledyn.codegen.passes.scheduling import computed_by, needed_values, operands_of
from vehicledyn.codegen.passes.tail_scheduling import order_tail

N_INPUT = 12


def program_of(expressions, x):
    return read_function(ca.Function("sums", [x], [ca.vertcat(*expressions)]))


def chained(program):
    needed = needed_values(program.instructions, program.results)
    return chain_products(program.instructions, needed, program.results)


def operations(expression, x):
    lowered = lower(program_of([expression], x))
    return Counter(lowered.values[step].operation for step in lowered.steps)


@pytest.mark.parametrize(
    ("write", "expected"),
    [
        (lambda p, a: (p[0] + p[1]) + (p[2] + p[3]), {"MUL": 1, "FMA": 3}),
        (lambda p, a: (p[0] - p[1]) - (p[2] - p[3]), {"MUL": 1, "FMS": 1, "FNMA": 1, "FMA": 1}),
        (lambda p, a: (p[0] - p[1]) - (a - p[2]), {"FMS": 1, "FNMA": 1, "FMA": 1}),
        (lambda p, a: a - (p[0] + p[1]), {"FNMA": 2}),
        (lambda p, a: (a + p[0]) + (1.5 - p[1]), {"FMA": 1, "FNMA": 1, "ADD": 1}),
    ],
)
def test_every_product_but_one_joins_a_sum(write, expected):
    x = ca.SX.sym("x", N_INPUT)
    products = [x[2 * k] * x[2 * k + 1] for k in range(4)]
    assert operations(write(products, x[8]), x) == expected


def a_sum(rng, x, depth):
    """Return a random tree of sums over products, inputs and what is used twice."""
    if depth == 0:
        a, b = (x[int(k)] for k in rng.integers(0, N_INPUT, 2))
        return [a * b, a, a * b + x[0] * x[1]][rng.choice(3, p=[0.7, 0.2, 0.1])]
    left, right = (a_sum(rng, x, depth - 1 - rng.integers(depth)) for _ in range(2))
    return left + right if rng.uniform() < 0.5 else left - right


def test_chains_are_the_same_sums_with_fewer_operations():
    rng = np.random.default_rng(3)
    given = [Fraction(int(k), 7) for k in rng.integers(-50, 50, N_INPUT)]
    spared = 0
    for _ in range(40):
        x = ca.SX.sym("x", N_INPUT)
        program = program_of([a_sum(rng, x, 7) for _ in range(4)], x)
        values, results = chained(program)
        before = evaluated(program.instructions, program.results, given)
        assert evaluated(values, results, given) == before
        assert all(k < place for place, item in enumerate(values) for k in item.operands)
        plain = fused_count(program.instructions, program.results)
        short = fused_count(values, results)
        assert short <= plain
        spared += plain - short
    assert spared > 0


def fused_count(values, results):
    """Operations once products and sums are fused."""
    fused = fuse(list(values), results)
    needed = needed_values(fused, results)
    return sum(n and v.operation not in (INPUT, CONST) for n, v in zip(needed, fused, strict=True))


def a_long_function():
    """Many sums that wait for nothing, then a chain of which each waits for the one before."""
    x = ca.SX.sym("x", N_INPUT)
    free = [(x[k % 5] + k) * x[k % 7] for k in range(700)]
    chain = x[0]
    for k in range(8):
        chain = chain / (x[k % N_INPUT] + 2.0)
    return lower(read_function(ca.Function("f", [x], [ca.vertcat(*free, chain)]))), 8


def test_the_end_of_a_function_waits_for_as_little_as_it_can():
    lowered, divisions = a_long_function()
    steps = order_tail(lowered.values, lowered.steps)
    assert sorted(steps) == sorted(lowered.steps)
    there = {k for k, item in enumerate(lowered.values) if item.operation in (INPUT, CONST)}
    for step in steps:
        assert there.issuperset(operands_of(lowered.values, step))
        there.update(computed_by(step))

    def behind(order):
        """Return how many steps come after the first division."""
        places = [k for k, s in enumerate(order) if lowered.values[s].operation == "DIV"]
        assert len(places) == divisions
        return len(order) - places[0]

    assert behind(lowered.steps) < 30
    assert behind(steps) > 200


def test_short_functions_keep_their_order():
    x = ca.SX.sym("x", N_INPUT)
    lowered = lower(program_of([ca.sin(x[0]) / x[1] + x[2] * x[3], x[4] + x[5]], x))
    assert order_tail(lowered.values, lowered.steps) == lowered.steps
