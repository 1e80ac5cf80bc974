"""The operations of expressions in the C of kernels, in C99, Python and MATLAB."""

from __future__ import annotations

from collections.abc import Sequence

from vehicledyn.codegen.ir.instructions import CELL, ENTRY, KNOT
from vehicledyn.codegen.printers.languages import (
    AND,
    ATOM,
    CHOICE,
    COMPARISON,
    NOT,
    OR,
    PRODUCT,
    SUM,
    Language,
    Template,
)


def _between(symbol: str, precedence: int) -> Template:
    """Return an operator whose chains are evaluated from the left."""
    return Template(f"{{0}} {symbol} {{1}}", precedence, (precedence, precedence + 1))


def _call(name: str, operands: int = 1) -> Template:
    """Return a function of one or two operands."""
    arguments = ", ".join(f"{{{k}}}" for k in range(operands))
    return Template(f"{name}({arguments})", ATOM, (0,) * operands)


def _comparison(symbol: str) -> Template:
    return Template(f"{{0}} {symbol} {{1}}", COMPARISON, (COMPARISON + 1,) * 2)


_ARITHMETIC = {
    "ADD": _between("+", SUM),
    "SUB": _between("-", SUM),
    "MUL": _between("*", PRODUCT),
    "DIV": _between("/", PRODUCT),
    "NEG": Template("-{0}", SUM, (PRODUCT,)),
    "SQ": Template("{0} * {0}", PRODUCT, (ATOM,)),
    "TWICE": Template("2.0 * {0}", PRODUCT, (PRODUCT + 1,)),
    "INV": Template("1.0 / {0}", PRODUCT, (PRODUCT + 1,)),
    "ASSIGN": Template("{0}", ATOM, (ATOM,)),
}
"""What all languages write alike."""

_COMPARISONS = {
    "LT": _comparison("<"),
    "LE": _comparison("<="),
    "EQ": _comparison("=="),
}

CONDITIONAL = {"NOT": (0,), "AND": (0, 1), "OR": (0, 1), "IF_ELSE_ZERO": (0,), "SELECT": (0,)}
"""Operands of the operations of kernels that are conditions."""

KERNEL = Language(
    name="C",
    comment="//",
    templates={
        **_ARITHMETIC,
        "TWICE": _between("+", SUM)._replace(pattern="{0} + {0}", operands=(SUM,)),
        "NEGADD": Template("-{0} - {1}", SUM, (PRODUCT, SUM + 1)),
        **{name: _call(f"vd_{name.lower()}", 3) for name in ("FMA", "FMS", "FNMA", "FNMS")},
        **{name: _call(f"vd_{name.lower()}", 2) for name in ("LT", "LE", "EQ", "NE", "AND", "OR")},
        "NOT": _call("vd_not"),
        "IF_ELSE_ZERO": _call("vd_only", 2),
        "SELECT": _call("vd_select", 3),
        "FABS": _call("vd_abs"),
        "SQRT": _call("vd_sqrt"),
        "FMIN": _call("vd_min", 2),
        "FMAX": _call("vd_max", 2),
        "SIGN": _call("vd_sign"),
        CELL: Template("vd_cell({0}, {table})", ATOM, (0,)),
        KNOT: Template("vd_knot({0}, {table})", ATOM, (0,)),
        ENTRY: Template("vd_entry({0}, {table}, {width}, {power})", ATOM, (0,)),
    },
    infinity="INFINITY",
    not_a_number="NAN",
    brackets="[][]",
    first=0,
    member="->",
)
"""C in terms of real.h, for one lane or many; what elementary.c computes is called in packs."""

_BOUNDED = {"FMIN": _call("vd_lesser", 2), "FMAX": _call("vd_larger", 2)}
"""The same where the second operand is surely a number."""


def kernel_expression(
    operation: str,
    names: Sequence[str],
    is_number: Sequence[bool],
    table: dict[str, str | int],
) -> str:
    """Return the expression of an operation of a kernel.

    Parameters
    ----------
    operation
        One that has a template.
    names
        Its operands, which bind as tightly as names.
    is_number
        Whether each operand is surely a number.
    table
        What a look-up asks for: ``table``, ``width`` and ``power``; empty otherwise.
    """
    if operation in _BOUNDED:
        bounds = [k for k, is_bound in enumerate(is_number) if is_bound]
        if bounds:
            bound = bounds[-1]
            return _BOUNDED[operation].pattern.format(names[1 - bound], names[bound])
    return KERNEL.templates[operation].pattern.format(*names, **table)


_UNARY = (
    *("exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"),
    *("asinh", "acosh", "atanh", "floor", "ceil", "erf", "expm1", "log1p"),
)
_BINARY = ("atan2", "fmod", "remainder", "copysign", "hypot", "pow", "fmin", "fmax")
_SYMBOLS = {
    "NOT": Template("!{0}", NOT, (NOT + 1,)),
    "AND": _between("&&", AND),
    "OR": Template("{0} || {1}", OR, (COMPARISON,) * 2),
    "NE": _comparison("!="),
}

C = Language(
    name="C",
    comment="//",
    templates={
        **_ARITHMETIC,
        **_COMPARISONS,
        **{name.upper(): _call(name) for name in (*_UNARY, "fabs")},
        **{name.upper(): _call(name, 2) for name in _BINARY},
        "CONSTPOW": _call("pow", 2),
        "SIGN": _call("sign_of"),
        "IF_ELSE_ZERO": Template("{0} ? {1} : 0.0", CHOICE, (CHOICE + 1,) * 2),
        **_SYMBOLS,
    },
    infinity="INFINITY",
    not_a_number="NAN",
    brackets="[][]",
    first=0,
    member="->",
)

_NUMPY = {
    **{"asin": "arcsin", "acos": "arccos", "atan": "arctan", "atan2": "arctan2"},
    **{"asinh": "arcsinh", "acosh": "arccosh", "atanh": "arctanh", "pow": "power"},
}

PYTHON = Language(
    name="Python",
    comment="#",
    templates={
        **_ARITHMETIC,
        **_COMPARISONS,
        **{n.upper(): _call(f"np.{_NUMPY.get(n, n)}") for n in (*_UNARY, "fabs", "sign")},
        **{n.upper(): _call(f"np.{_NUMPY.get(n, n)}", 2) for n in _BINARY},
        "CONSTPOW": _call("np.power", 2),
        "ERF": _call("math.erf"),
        "REMAINDER": _call("math.remainder", 2),
        "IF_ELSE_ZERO": Template("{1} if {0} else 0.0", CHOICE, (CHOICE + 1,) * 2),
        "NOT": _call("np.logical_not"),
        "AND": _call("np.logical_and", 2),
        "OR": _call("np.logical_or", 2),
        "NE": _comparison("!="),
    },
    infinity="np.inf",
    not_a_number="np.nan",
    brackets="[]",
    first=0,
    member=".",
)

MATLAB = Language(
    name="MATLAB",
    comment="%",
    templates={
        **_ARITHMETIC,
        **_COMPARISONS,
        **{name.upper(): _call(name) for name in (*_UNARY, "sign")},
        **{name.upper(): _call(name, 2) for name in ("atan2", "hypot")},
        "FABS": _call("abs"),
        "FMOD": _call("rem", 2),
        "REMAINDER": _call("remainder_of", 2),
        "COPYSIGN": _call("copy_sign", 2),
        "POW": _call("power", 2),
        "CONSTPOW": _call("power", 2),
        "FMIN": _call("min", 2),
        "FMAX": _call("max", 2),
        "IF_ELSE_ZERO": _call("if_else_zero", 2),
        "NOT": Template("~{0}", NOT, (NOT + 1,)),
        "AND": _between("&", AND),
        "OR": Template("{0} | {1}", OR, (COMPARISON,) * 2),
        "NE": _comparison("~="),
    },
    infinity="Inf",
    not_a_number="NaN",
    brackets="()",
    first=1,
    member=".",
)
