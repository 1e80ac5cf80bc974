"""One constant read in place of two that are equal but for their sign, to the same bits."""

import math
from fractions import Fraction

import casadi as ca
import numpy as np
from solve_examples import build, symbols

from vehicledyn.codegen.ir.instructions import CONST, INPUT, read_function
from vehicledyn.codegen.passes.kernel_functions import derive_functions
from vehicledyn.codegen.passes.lowering import fuse
from vehicledyn.codegen.passes.scheduling import needed_values
from vehicledyn.codegen.passes.signed_constants import mirrored_constants, read_mirrored
from vehicledyn.kernel.lanes import compile_lanes
from vehicledyn.kernel.make_kernel import compile_kernel

N_PARAMETER = 3


def rounded(product, addend):
    """A fused sum: exact, then rounded once."""
    return float(product + addend)


RULES = {
    "ADD": lambda a, b: a + b,
    "SUB": lambda a, b: a - b,
    "NEGADD": lambda a, b: -a - b,
    "MUL": lambda a, b: a * b,
    "SQ": lambda a: a * a,
    "NEG": lambda a: -a,
    "SIN": math.sin,
    "SQRT": math.sqrt,
    "FMA": lambda a, b, c: rounded(Fraction(a) * Fraction(b), Fraction(c)),
    "FMS": lambda a, b, c: rounded(Fraction(a) * Fraction(b), -Fraction(c)),
    "FNMA": lambda a, b, c: rounded(-Fraction(a) * Fraction(b), Fraction(c)),
    "FNMS": lambda a, b, c: rounded(-Fraction(a) * Fraction(b), -Fraction(c)),
}


def constants_of(p):
    """Constants of a left and a right side, and some that only look alike."""
    a, b, c = p[0], p[1], p[2]
    left = [a * b, a - b, a / c, (a + b) * c, ca.sqrt(a * c), a * b - c]
    right = [-(b * a), b - a, -a / c, (-b - a) * c, ca.sqrt(c * a), c - b * a]
    return [*left, *right, ca.fabs(a), a, a + b, c - a, a * a, ca.sin(a), ca.sin(-a)]


def prepared():
    p = ca.SX.sym("p", N_PARAMETER)
    return ca.Function("prepare", [p], [ca.vertcat(*constants_of(p))])


def test_opposite_constants_are_found_and_no_others():
    prepare = prepared()
    found = mirrored_constants(read_function(prepare))
    assert found == {6: (0, -1), 7: (1, -1), 8: (2, -1), 9: (3, -1), 10: (4, 1), 11: (5, -1)}
    for values in np.random.default_rng(1).uniform(0.5, 2.0, (5, N_PARAMETER)):
        constants = np.array(prepare(values)).ravel()
        for element, (other, sign) in found.items():
            assert constants[element] == sign * constants[other]


def evaluated(values, results, inputs):
    found = []
    for item in values:
        if item.operation == INPUT:
            found.append(inputs[item.source[0]][item.source[1]])
        elif item.operation == CONST:
            found.append(item.number)
        else:
            found.append(RULES[item.operation](*(found[k] for k in item.operands)))
    return [found[value] for _, _, value in sorted(results)]


def side(x, c, first):
    """Forces of a side: products in sums, in products, in roots, alone and taken twice."""
    k = [c[first + n] for n in range(6)]
    lever = x[0] * k[0] + x[1]
    height = k[1] * x[2] - k[2] * x[3] - (x[1] - x[4] * k[3])
    pushed = (x[2] * k[0]) * x[4] + (x[3] * k[1]) * (x[0] * k[2])
    bent = ca.sin(x[1] * k[5]) * k[4] + x[0] * k[3] * x[1]
    both = k[2] * x[1]
    return [lever, height, pushed, bent, both, both - k[1], k[0] - both, -k[5] - x[0] * k[1]]


def constants_read(values, results):
    """Elements of the second input that a function needs."""
    needed = needed_values(values, results)
    pairs = zip(values, needed, strict=True)
    return {v.source[1] for v, n in pairs if n and v.operation == INPUT and v.source[0] == 1}


def test_kept_constants_give_the_same_bits():
    rng = np.random.default_rng(2)
    x, c = ca.SX.sym("x", 5), ca.SX.sym("c", 19)
    function = ca.Function("f", [x, c], [ca.vertcat(*side(x, c, 0), *side(x, c, 6))])
    program = read_function(function)
    fused = fuse(list(program.instructions), program.results)
    constants = mirrored_constants(read_function(prepared()))
    turned = read_mirrored(fused, program.results, constants, 1)
    for _ in range(20):
        known = np.array(prepared()(rng.uniform(0.5, 2.0, N_PARAMETER))).ravel().tolist()
        given = [rng.normal(size=5).tolist(), known]
        expected = evaluated(fused, program.results, given)
        assert evaluated(turned, program.results, given) == expected
    names = {item.operation for item in turned}
    assert {"FNMA", "FNMS"} <= names
    before, after = (constants_read(values, program.results) for values in (fused, turned))
    assert len(before) == 12
    # A result and a sine need those as they are that stay.
    assert after == before - {6, 7, 9, 10}


def two_sides():
    """Rates of a left and a right side, whose constants are opposite sums of two products."""
    t, x, y, *p = symbols("t", "x", "y", "a", "b", "c", "d")
    a, b, c, d = p
    left, right = (a - b) * c + (c - d) * a, (d - c) * a + (b - a) * c
    return build(
        "two sides",
        time=t,
        states=[(x, 0.0), (y, 0.0)],
        rates=[left * x + y, right * y - x],
        parameters=[(symbol, 1.0) for symbol in p],
        outputs=[],
    )


def test_opposite_constants_are_opposite_to_the_last_bit(needs_compiler, lanes):
    """Though a sum of two products is rounded otherwise when the other product is fused."""
    equations = two_sides()
    kernel = compile_kernel(equations, backend="compiled")
    engine, _ = compile_lanes(equations, kernel.key, lanes)
    opposite = mirrored_constants(read_function(derive_functions(equations).prepare))
    assert sorted(sign for _, sign in opposite.values()) == [-1]
    rng = np.random.default_rng(4)
    for _ in range(50):
        values, states = rng.uniform(0.5, 2.0, (lanes, 4)), rng.normal(size=(lanes, 2))
        states[0] = 0.0, -0.0
        constants = engine.prepare(engine.spread(values))
        for element, (other, sign) in opposite.items():
            assert np.array_equal(constants[element], sign * constants[other])
        rates, _ = engine.rates(0.0, engine.spread(states), engine.room(0), constants)
        for lane in range(lanes):
            alone = kernel.with_parameters(values[lane]).rates(0.0, states[lane], np.zeros(0))
            assert alone.tobytes() == rates[:, lane].tobytes()
