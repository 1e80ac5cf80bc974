import math

import pytest
from pydantic import TypeAdapter

from vehicledyn.files.expressions.algebra import FUNCTIONS, NUMBERS, SYMBOLS, ExpressionError
from vehicledyn.files.expressions.dimensions import MEASURES, measure_of
from vehicledyn.files.expressions.expressions import read_expression
from vehicledyn.files.expressions.fields import Scalar
from vehicledyn.symbolic import ops

NAMES = {"radius": 0.1, "mass": 2.0, "hinge": (1.0, -2.0, 3.0), "x": 0.3}
UNITS = {"radius": "m", "mass": "kg", "hinge": ("m", "m", "m"), "x": "1"}
MEASURED = {
    name: tuple(map(measure_of, unit)) if isinstance(unit, tuple) else measure_of(unit)
    for name, unit in UNITS.items()
}
WORTH = [
    ("2 * radius", 0.2, "m"),
    ("30 mm", 0.03, "m"),
    ("-1.5e3", -1500.0, "1"),
    ("2 kg m^2", 2.0, "kg*m^2"),
    ("radius / 2 + 30 mm", 0.08, "m"),
    ("1000 N/m * (radius - 0.3 m)", -200.0, "N"),
    ("radius**2 * mass", 0.02, "kg*m^2"),
    ("sqrt(radius * radius)", 0.1, "m"),
    ("norm(hinge)", math.sqrt(14.0), "m"),
    ("dot(hinge, unit(hinge))", math.sqrt(14.0), "m"),
    ("hinge.z - hinge.x", 2.0, "m"),
    ("atan2(hinge.y, hinge.x)", math.atan2(-2.0, 1.0), "1"),
    ("where(x < 0.2, 1, 2) * radius", 0.2, "m"),
    ("2**3**2", 512.0, "1"),
    ("-x**2", -0.09, "1"),
    ("sin(pi / 6) + acos(x) + tanh(x) + abs(-x) + sign(-x)",
     0.5 + math.acos(0.3) + math.tanh(0.3) + 0.3 - 1.0, "1"),
    ("min(x, 1) + max(x, 1)", 1.3, "1"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "value", "unit"), WORTH)
def test_worth_in_numbers_symbols_and_units(text, value, unit):
    expression = read_expression(text)
    assert expression.value(NAMES, NUMBERS) == pytest.approx(value, rel=1e-14)
    symbols = {n: v if isinstance(v, tuple) else ops.symbol(n) for n, v in NAMES.items()}
    free = [n for n, v in symbols.items() if not isinstance(v, tuple)]
    found = ops.scalar(expression.value(symbols, SYMBOLS))
    number = ops.numeric([ops.column([symbols[n] for n in free])], found)([NAMES[n] for n in free])
    assert float(number[0, 0]) == pytest.approx(value, rel=1e-14)
    assert expression.value(MEASURED, MEASURES).fits(unit)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("2 * hinge", (2.0, -4.0, 6.0)),
        ("hinge - [1, 0, radius]", (0.0, -2.0, 2.9)),
        ("mirror_y(hinge)", (1.0, 2.0, 3.0)),
        ("cross([1, 0, 0], hinge)", (0.0, -3.0, -2.0)),
        ("-hinge / 2", (-0.5, 1.0, -1.5)),
    ],
)
def test_vectors(text, value):
    assert read_expression(text).value(NAMES, NUMBERS) == pytest.approx(value, rel=1e-15)


@pytest.mark.parametrize(
    "text",
    ["mass*radius**2/12", "-x/2", "x-(1-x)", "(x-1)-x", "x/(2*x)", "-(x+1)", "(-x)**2", "2**-x",
     "(2**x)**x", "2**x**x", "norm([x,x+1,2*x])*-2", "where(x<=1,-x,3 mm)", "-30 mm * x",
     "hinge.x*2", "-2 N s/m"],
)  # fmt: skip
def test_text_of_an_expression_reads_back_to_the_same(text):
    expression = read_expression(text)
    again = read_expression(str(expression))
    assert again.value(NAMES, NUMBERS) == expression.value(NAMES, NUMBERS)
    assert str(again) == str(expression)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("__import__('os').system('true')", "is not allowed in an expression"),
        ("exec('1')", "no function named 'exec'"),
        ("hinge.__class__()", "is not allowed in an expression"),
        ("[x for x in hinge]", "is not allowed"),
        ("lambda: x", "is not allowed"),
        ("'text'", "is not allowed"),
        ("x if x else 1", "is not allowed"),
        ("(x := 3)", "is not allowed"),
        ("hinge[0]", "is not allowed"),
        ("True", "is not allowed"),
        ("2j", "is not"),
        ("x ^ 2", "write ** for a power"),
        ("sin(x, x)", "sin() takes 1 argument(s), found 2"),
        ("sim(x)", "did you mean 'sin'?"),
        ("raduis", "did you mean 'radius'?"),
        ("1 / 0", "divides by zero"),
        ("9**9**9**9", "too large"),
        ("sqrt(0 - x)", "sqrt is not defined at -0.3"),
        ("(0 - x)**0.5", "has no power 0.5"),
        ("hinge * hinge", "use dot() or cross()"),
        ("hinge + 1", "does not go with a vector"),
        ("norm(x)", "norm() needs vectors"),
        ("3 furlong", "'furlong' is not a known unit"),
        ("((", "neither a quantity nor an expression"),
        ("", "neither a quantity nor an expression"),
        ("1e999", "expected a finite number"),
        ("(" * 500 + "x" + ")" * 500, ""),
        ("x" * 5000, "longer than"),
    ],
)
def test_what_is_no_arithmetic_is_refused(text, words):
    with pytest.raises(ExpressionError) as refused:
        read_expression(text).value(NAMES, NUMBERS)
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("radius + mass", "a quantity in m and one in kg do not go together"),
        ("sin(radius)", "must be a number or an angle, this one is in m"),
        ("x**radius", "an exponent must be a number"),
        ("radius**x", "can only be raised to a plain number"),
        ("where(x < 0, radius, mass)", "do not go together"),
    ],
)
def test_units_that_do_not_go_together(text, words):
    with pytest.raises(ExpressionError) as refused:
        read_expression(text).value(MEASURED, MEASURES)
    assert words in str(refused.value)


def test_frequencies_and_angular_velocities_are_told_apart():
    assert not read_expression("2 Hz").value({}, MEASURES).fits("rad/s")
    assert read_expression("2 * 3 1/s").value({}, MEASURES).fits("rad/s")


def test_every_function_has_a_meaning_in_all_three_algebras():
    vectors = {"norm", "unit", "dot", "cross", "mirror_x", "mirror_y", "mirror_z"}
    for algebra in (NUMBERS, SYMBOLS, MEASURES):
        assert set(FUNCTIONS) - vectors <= set(algebra)


def test_fields_look_into_no_step_of_an_expression():
    """Each field once built a schema of expressions, their steps and quantities: 40 ms a system."""
    fields = TypeAdapter(Scalar)
    assert "dataclass" not in str(fields.core_schema)
    assert fields.validate_python("2 * radius") == read_expression("2 * radius")
