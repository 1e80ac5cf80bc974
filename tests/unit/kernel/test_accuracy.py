"""Right-hand sides of compiled and interpreted kernels beside the same equations in 40 digits."""

from decimal import Decimal, getcontext, localcontext
from pathlib import Path

import numpy as np
import pytest

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.codegen.ir.instructions import CELL, CONST, ENTRY, INPUT, KNOT, read_expressions
from vehicledyn.files.scenario import load_scenario
from vehicledyn.kernel.make_kernel import compile_kernel

SCENARIOS = Path(__file__).parents[3] / "scenarios"
DIGITS = 40
PI = Decimal("3.14159265358979323846264338327950288419716939937510582")
TIME = 0.71234567  # not at a knot of a track, where rounding chooses the cell


def sine(x):
    """The sine by its series, of the angle less whole turns."""
    x %= 2 * PI
    term = total = x
    k = 1
    while abs(term) > Decimal(10) ** -(DIGITS + 5):
        k += 2
        term *= -x * x / (k * (k - 1))
        total += term
    return total


def arc_tangent(x):
    """Twice the arc tangent of half the angle's tangent, until the series is short."""
    halvings = 0
    while abs(x) > Decimal("0.1"):
        x /= 1 + (1 + x * x).sqrt()
        halvings += 1
    power = total = x
    k = 1
    while abs(power) > Decimal(10) ** -(DIGITS + 5):
        k += 2
        power *= -x * x
        total += power / k
    return total * 2**halvings


def angle_of(y, x):
    if x > 0:
        return arc_tangent(y / x)
    if y == 0:
        return PI if x < 0 else Decimal(0)
    return (PI / 2).copy_sign(y) - arc_tangent(x / y)


def root(x):
    return x.sqrt()


OPERATIONS = {
    "ADD": lambda a, b: a + b,
    "SUB": lambda a, b: a - b,
    "MUL": lambda a, b: a * b,
    "DIV": lambda a, b: a / b,
    "NEG": lambda a: -a,
    "SQ": lambda a: a * a,
    "TWICE": lambda a: 2 * a,
    "INV": lambda a: 1 / a,
    "SQRT": root,
    "SIN": sine,
    "COS": lambda a: sine(a + PI / 2),
    "TAN": lambda a: sine(a) / sine(a + PI / 2),
    "ATAN": arc_tangent,
    "ATAN2": angle_of,
    "ASIN": lambda a: angle_of(a, root(1 - a * a)),
    "ACOS": lambda a: angle_of(root(1 - a * a), a),
    "EXP": lambda a: a.exp(),
    "LOG": lambda a: a.ln(),
    "TANH": lambda a: 1 - 2 / ((2 * a).exp() + 1),
    "CONSTPOW": lambda a, b: a**b,
    "POW": lambda a, b: a**b,
    "FABS": abs,
    "FMIN": min,
    "FMAX": max,
    "SIGN": lambda a: Decimal((a > 0) - (a < 0)),
    "LT": lambda a, b: Decimal(a < b),
    "LE": lambda a, b: Decimal(a <= b),
    "EQ": lambda a, b: Decimal(a == b),
    "NE": lambda a, b: Decimal(a != b),
    "NOT": lambda a: Decimal(a == 0),
    "AND": lambda a, b: Decimal(a != 0 and b != 0),
    "OR": lambda a, b: Decimal(a != 0 or b != 0),
    "IF_ELSE_ZERO": lambda a, b: b if a != 0 else Decimal(0),
}


def value_of(item, values, inputs, tables):
    given = [values[k] for k in item.operands]
    if item.operation == INPUT:
        return inputs[item.source[0]][item.source[1]]
    if item.operation == CONST:
        return Decimal(item.number)
    if item.operation in (CELL, KNOT, ENTRY):
        table = tables[item.source[0]]
        origin, step = Decimal(table.origin), Decimal(table.step)
        if item.operation == CELL:
            place = (given[0] - origin) / step
            return Decimal(int(min(max(place, Decimal(0)), Decimal(len(table.cells) - 1))))
        if item.operation == KNOT:
            return origin + step * given[0]
        return Decimal(float(table.cells[int(given[0]), item.source[1]]))
    return OPERATIONS[item.operation](*given)


def exact_rates(equations, *points):
    """The rates of the states from exactly these doubles, shared functions written out."""
    symbols = [equations.time, equations.state, equations.algebraic, equations.parameter]
    rates = [equations.rate[k] for k in range(len(equations.states))]
    program = read_expressions(symbols, rates, equations.tables)
    inputs = [[Decimal(float(v)) for v in np.atleast_1d(point)] for point in points]
    values = []
    with localcontext() as context:
        context.prec = DIGITS
        for item in program.instructions:
            values.append(value_of(item, values, inputs, equations.tables))
    return [values[value] for _, _, value in sorted(program.results)]


def error_of(rates, exact):
    """The largest error, of the largest rate."""
    errors = [abs(Decimal(float(rate)) - true) for rate, true in zip(rates, exact, strict=True)]
    return float(max(errors) / max(map(abs, exact)))


def test_the_functions_of_the_reference_are_exact():
    getcontext().prec = DIGITS
    third = Decimal(1) / 3
    assert abs(sine(third) ** 2 + sine(third + PI / 2) ** 2 - 1) < Decimal(10) ** -35
    assert abs(sine(PI / 6) - Decimal("0.5")) < Decimal(10) ** -35
    assert abs(4 * arc_tangent(Decimal(1)) - PI) < Decimal(10) ** -35
    for x, y in ((3, 4), (-3, 4), (-3, -4), (3, -4)):
        assert float(angle_of(Decimal(y), Decimal(x))) == pytest.approx(np.arctan2(y, x), rel=1e-15)


@pytest.mark.parametrize(
    "name",
    [
        "iltis_slalom",
        "iltis_bump_in_phase",
        pytest.param("wheelset_limit_cycle", marks=pytest.mark.long),
        "systems/five_link_suspension",
        "systems/rolling_disk",
    ],
)
def test_compiled_rates_are_as_exact_as_interpreted_ones(name, needs_compiler):
    loaded = load_scenario(SCENARIOS / f"{name}.yaml")
    prepared, start = prepare_run(loaded, backend="compiled", progress=lambda *_: None)
    equations, compiled = prepared.equations, prepared.kernel
    interpreted = compile_kernel(equations, backend="interpreted")
    rng = np.random.default_rng(5)
    scale = np.maximum(np.abs(start.state), 1e-3)
    errors = []
    for _ in range(2):
        state = start.state + 1e-3 * scale * rng.normal(size=start.state.size)
        unknowns = start.unknowns
        if unknowns.size:
            unknowns = compiled.solve_unknowns(TIME, state, unknowns)
        exact = exact_rates(equations, TIME, state, unknowns, compiled.parameters)
        errors.append(
            [error_of(k.rates(TIME, state, unknowns), exact) for k in (compiled, interpreted)]
        )
    one, other = np.max(errors, axis=0)
    assert one <= 1e-12
    assert one <= 4.0 * other + 1e-15
