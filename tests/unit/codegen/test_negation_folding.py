"""Fused sums of the opposite signs in place of negatives, with the same signs of zeros in lanes."""

from fractions import Fraction
from itertools import product

import casadi as ca
import numpy as np
import pytest
from exact_programs import RULES, evaluated
from solve_examples import build, symbols

from vehicledyn.codegen.ir.instructions import INPUT, Instruction, read_function
from vehicledyn.codegen.passes.lowering import fuse, lower
from vehicledyn.codegen.passes.negation_folding import turn_negated
from vehicledyn.codegen.passes.scheduling import needed_values
from vehicledyn.kernel.lanes import compile_lanes
from vehicledyn.kernel.make_kernel import compile_kernel

N_INPUT = 6


def operations(values, results):
    needed = needed_values(values, results)
    return [v for v, n in zip(values, needed, strict=True) if n and v.operation in RULES]


def an_expression(rng, leaves, size):
    """Return a random expression of products, sums and negatives."""
    pool = list(leaves)
    for _ in range(size):
        a, b, c = (pool[int(k)] for k in rng.integers(0, len(pool), 3))
        pool.append([a * b + c, a * b - c, c - a * b, -a, a - b][int(rng.integers(5))])
    return [*pool[-3:], -pool[-2]]


def test_turned_sums_have_the_same_values():
    rng = np.random.default_rng(1)
    given = [Fraction(int(k), 7) for k in rng.integers(-9, 9, N_INPUT)]
    spared = 0
    for _ in range(60):
        x = ca.SX.sym("x", N_INPUT)
        leaves = [x[k] for k in range(N_INPUT)]
        results = an_expression(rng, leaves, 12)
        program = read_function(ca.Function("f", [x], [ca.vertcat(*results)]))
        fused = fuse(list(program.instructions), program.results)
        values, places = turn_negated(fused, needed_values(fused, program.results), program.results)
        expected = evaluated(fused, program.results, given)
        assert evaluated(values, places, given) == expected
        before, after = operations(fused, program.results), operations(values, places)
        assert len(after) <= len(before)
        spared += len(before) - len(after)
    assert spared > 0


@pytest.mark.parametrize(("user", "place"), [("FMS", 2), ("FNMA", 0), ("FNMS", 0), ("FNMS", 2)])
def test_sums_taken_with_the_other_sign_are_turned(user, place):
    operands = [0, 1, 2]
    operands[place] = 3
    values = [*(Instruction(INPUT, source=(0, k)) for k in range(3)), Instruction("FMA", (0, 1, 2))]
    values.append(Instruction(user, tuple(operands)))
    results = [(0, 0, 4)]
    turned, places = turn_negated(values, [True] * 5, results)
    assert turned[3].operation == "FNMS"
    given = [Fraction(3), Fraction(5), Fraction(7)]
    assert evaluated(turned, places, given) == evaluated(values, results, given)


def test_what_is_needed_itself_stays():
    x = ca.SX.sym("x", N_INPUT)
    total = x[0] * x[1] + x[2]
    function = ca.Function("f", [x], [ca.vertcat(total, -total, -(x[3] * x[4] - x[5]))])
    lowered = lower(read_function(function))
    names = sorted(lowered.values[step].operation for step in lowered.steps)
    assert names == ["FMA", "FNMA", "NEG"]


def test_signs_of_zeros_are_those_of_lanes(needs_compiler, lanes):
    """A sum that cancels and its negative, by which a direction turns by half a turn."""
    t, a, b, c, d = symbols("t", "a", "b", "c", "d")
    total = a * b + c * d
    equations = build(
        "signs",
        time=t,
        states=[(symbol, 0.0) for symbol in (a, b, c, d)],
        rates=[-total, a * d - total, ca.atan2(-total, -1.0), c - (a * d + b) * b],
        parameters=[],
        outputs=[],
    )
    kernel = compile_kernel(equations, backend="compiled")
    engine, _ = compile_lanes(equations, kernel.key, lanes)
    states = np.array(list(product((0.0, -0.0, 1.0, -1.0), repeat=4)))
    for group in states.reshape(-1, lanes, 4):
        rates, _ = engine.rates(0.0, engine.spread(group), engine.room(0), engine.room(0))
        alone = [kernel.rates(0.0, state, np.zeros(0)) for state in group]
        assert np.array(alone).T.tobytes() == rates.tobytes()
