"""System files with mistakes: each is told with its line, before anything runs."""

import pytest
from system_texts import load, problems

from vehicledyn.base.errors import InputError
from vehicledyn.files.expressions.algebra import NUMBERS, ExpressionError
from vehicledyn.files.expressions.dimensions import MEASURES
from vehicledyn.files.expressions.expressions import DEEPEST, read_expression

ARM = "title: t\nbodies:\n  a: {joints: [R2 q], mass: 1 kg, com: [0, 0, 1 m]}\n"


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ("  b: {parent: a, joints: [R2 q]}\n  c: {parent: b, at: [0, 0, 1 m]}\n",
         ["4:6: bodies.b: has no mass and nothing with mass hangs on it: nothing resists 'b.q'; "
          "give it a mass, or drive or drop the coordinate"]),
        ("  b: {parent: b, joints: [R2 q], mass: 1 kg, com: [0, 0, 1 m]}\n",
         ["4:15: bodies.b.parent: the bodies hang on each other: b -> b"]),
        ("  b: {joints: R2 q, mass: 1 kg}\n",
         ["4:15: bodies.b.joints: expected a list of joints, such as [R2 angle], found 'R2 q'"]),
        ("sensors: {a.q: {kind: point, body: a}}\n",
         ["4:16: sensors.a.q: the name is taken: a coordinate or its rate is 'a.q'"]),
        ("links: {a.q_rate: {a: ground, b: a, law: {kind: constant, amount: 1 N}}}\n",
         ["4:19: links.a.q_rate: the name is taken: a coordinate or its rate is 'a.q_rate'"]),
        ("cuts: {c: {kind: ball, a: a, b: a}}\n",
         ["4:11: cuts.c: both places are on 'a', which nothing can move against itself; a cut "
          "joins two bodies"]),
        ("constraints: {c: {kind: expression, zero: 1 m + 2 m}}\n",
         ["4:43: constraints.c.zero: names no coordinate, rate or point of a body that could "
          "make it zero"]),
        ("constraints: {c: {kind: rate_expression, zero: sin(time / 1 s)}}\n",
         ["4:48: constraints.c.zero: names no coordinate, rate or point of a body that could "
          "make it zero"]),
        ("initial: {a.q: 1e17 rad, a.q_rate: 1e308 rad/s}\n",
         ["4:16: initial.a.q: 1e+17 rad is too large to start from: neighbouring numbers of that "
          "size are 16 rad apart; stay below 6.7e+07 rad",
          "4:36: initial.a.q_rate: 1e+308 rad/s is too large to start from: neighbouring numbers "
          "of that size are 2e+292 rad/s apart; stay below 6.7e+07 rad/s"]),
        ("  b: {parent: a, joints: [{kind: R2, name: p, start: -1e9 rad}], mass: 1 kg, "
         "com: [0, 0, 1 m]}\n",
         ["4:54: bodies.b.joints[0].start: -1e+09 rad is too large to start from: neighbouring "
          "numbers of that size are 1.2e-07 rad apart; stay below 6.7e+07 rad"]),
        ("initial: {a: {q: 1 rad}, a.q: 2 rad}\n", ["4:26: initial.a.q: 'a.q' is given twice"]),
        ("parameters: {l: 1 m, k: l**(20 / 2)}\n",
         ["4:25: parameters.k: a parameter needs a unit that can be written: 'm^10' is not a "
          "unit: the exponent 10 is too large"]),
        ("parameters: {m: 1" + "0" * 5000 + "}\n",
         ["4:17: parameters.m: '1" + "0" * 39 + "...' is too long a number"]),
        ("repeat: [{for: {i: {from: 1, to: 1000000000}}, bodies: {'r{i}': {mass: 1 kg}}}]\n",
         ["4:10: repeat[0]: makes more than 10000 copies"]),
        (f"repeat: [{{for: {{i: [a, {'b' * 300}]}}, bodies: {{'r{{i}}': {{mass: 1 kg}}}}}}]\n",
         ["4:24: repeat[0].for.i[1]: a text of 300 characters; names take 200 of an index"]),
        ("repeat: [{for: {i: {from: 1, to: 9999}, j: {from: 1, to: 9999}, "
         "k: {from: 1, to: 9999}}, bodies: {'r{i}_{j}_{k}': {mass: 1 kg}}}]\n",
         ["4:10: repeat[0]: makes more than 10000 copies"]),
    ],
)  # fmt: skip
def test_each_mistake_has_its_line(tmp_path, more, told):
    assert problems(tmp_path, ARM + more) == told


@pytest.mark.parametrize(
    "more",
    [
        "  b: {parent: a, at: [0, 0, 1 m], joints: [R2 q]}\n  c: {parent: b, mass: 1 kg, "
        "com: [0, 0, 1 m]}\n",
        "  b: {joints: [R2 q]}\nconstraints: {c: {kind: gears, driving: a.q, driven: b.q, "
        "ratio: 2}}\n",
        "drives: {a.q: {coordinate: a.q, law: {kind: constant_rate, rate: 1 rad/s}}}\n",
        "constraints: {c: {kind: expression, points: {p: a}, zero: p.x - 0.1 m}}\n",
        "parameters: {l: 1 m, area: l**(4 / 2)}\n",
    ],
)
def test_what_only_looks_like_a_mistake_is_accepted(tmp_path, more):
    assert problems(tmp_path, ARM + more) == []


def test_places_of_coordinates_parts_and_given_rates(tmp_path):
    text = ARM + "links: {a: {a: ground, b: a, law: {kind: constant, amount: 1 N}}}\n"
    text += "mirror:\n- plane: y\n  names: {left: right}\n  bodies:\n"
    text += "    m_left: {joints: [T3 z], mass: 1 kg}\ninitial: {a.q_rate: 1 rad/s}\n"
    found = load(tmp_path, text).places
    marks = {name: (place.mark.line, place.field) for name, place in found.items()}
    assert marks == {
        "a.q": (3, "bodies.a.joints[0]"),
        "a": (4, "links.a"),
        "m_left": (9, "mirror[0].bodies.m_left"),
        "m_right": (9, "mirror[0].bodies.m_left"),
        "m_left.z": (9, "mirror[0].bodies.m_left.joints[0]"),
        "m_right.z": (9, "mirror[0].bodies.m_left.joints[0]"),
        "a.q_rate": (10, "initial.a.q_rate"),
    }


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("ｌ + 1", "the character 'ｌ' (U+FF4C) has no meaning"),
        ("l\u200b", "(U+200B) has no meaning"),
        ("\u0435xp(1)", "(U+0435) has no meaning"),
        ("\u0663", "(U+0663) has no meaning"),
        ("1 # 2", "the character '#'"),
        ("(" * 900 + "1" + ")" * 900, "nested too deeply"),
        ("-" * 1900 + "1", "nested too deeply"),
        ("+".join(["1"] * (DEEPEST + 5)), "nested too deeply"),
        ("**".join(["2"] * 400), "nested too deeply"),
        ("(" * 50_000 + "1" + ")" * 50_000, "longer than 2000 characters"),
        ("9**9**9", "too large"),
        ("l[" + "0" * 200 + "1]", "..."),
        ("().__class__.__bases__", "is no name"),
        ("l.__class__", "no quantity named 'l.__class__'"),
        ("f'{l}'", "is not allowed in an expression"),
        ("getattr(l, 'real')", "no function named 'getattr'"),
        ("sin(*l)", "is not allowed in an expression"),
        ("sin(x=1)", "is not allowed in an expression"),
        ("await l", "is not allowed in an expression"),
        ("1; 2", "neither a quantity nor an expression"),
        ("l > 1", "'l > 1' is a comparison, which has its place in where("),
        ("where(l > 1, 2, l < 3)", "'l < 3' is a comparison"),
        ("2 rad/s*time", "'time' is not a known unit; to go on after a unit put blanks round the "
         "sign: rad/s * time"),
        ("0.3 m*sin(l)", "put blanks round the sign: m * sin"),
        ("1 m" + "*m" * 900 + "*l", "put blanks round the sign: m*m*"),
    ],
)  # fmt: skip
def test_no_expression_runs_code_or_the_interpreter_down(text, words):
    with pytest.raises(ExpressionError) as refused:
        read_expression(text).value({"l": 2.0}, NUMBERS)
    assert words in str(refused.value)
    assert len(str(refused.value)) < 400


def test_the_deepest_expression_has_a_value():
    text = "+".join(["1"] * DEEPEST)
    assert read_expression(text).value({}, NUMBERS) == DEEPEST
    read_expression(text).value({}, MEASURES)


def test_units_follow_calculated_exponents():
    length = read_expression("3 m").value({}, MEASURES)
    cube = read_expression("l**(1 + 2**1)").value({"l": length}, MEASURES)
    assert cube.unit == "m^3"
    for text in ("9**9**9", "0**(0 - 1)", "(0 - 8)**0.5"):
        assert read_expression(text).value({}, MEASURES).is_pure


def test_an_unknown_name_among_none(tmp_path):
    with pytest.raises(InputError, match="no quantity named 'x'; Known: none"):
        load(tmp_path, ARM.replace("1 kg", "x"))
