"""Print operations on single values as C expressions, in terms of real.h."""

from __future__ import annotations

import math
from collections.abc import Sequence

from vehicledyn.codegen.ir.instructions import CELL, ENTRY, KNOT

_TEMPLATES = {
    "ASSIGN": "{0}",
    "ADD": "{0} + {1}",
    "SUB": "{0} - {1}",
    "MUL": "{0} * {1}",
    "DIV": "{0} / {1}",
    "NEG": "-{0}",
    "SQ": "{0} * {0}",
    "TWICE": "{0} + {0}",
    "INV": "1.0 / {0}",
    "FMA": "vd_fma({0}, {1}, {2})",
    "FMS": "vd_fms({0}, {1}, {2})",
    "FNMA": "vd_fnma({0}, {1}, {2})",
    "FNMS": "vd_fnms({0}, {1}, {2})",
    "NEGADD": "-{0} - {1}",
    "LT": "vd_lt({0}, {1})",
    "LE": "vd_le({0}, {1})",
    "EQ": "vd_eq({0}, {1})",
    "NE": "vd_ne({0}, {1})",
    "NOT": "vd_not({0})",
    "AND": "vd_and({0}, {1})",
    "OR": "vd_or({0}, {1})",
    "IF_ELSE_ZERO": "vd_only({0}, {1})",
    "SELECT": "vd_select({0}, {1}, {2})",
    "FABS": "vd_abs({0})",
    "SQRT": "vd_sqrt({0})",
    "FMIN": "vd_min({0}, {1})",
    "FMAX": "vd_max({0}, {1})",
    "SIGN": "vd_sign({0})",
    CELL: "vd_cell({0}, {table})",
    KNOT: "vd_knot({0}, {table})",
    ENTRY: "vd_entry({0}, {table}, {width}, {power})",
}

_BOUNDED = {"FMIN": "vd_lesser({0}, {1})", "FMAX": "vd_larger({0}, {1})"}
"""The same where the second operand is surely a number."""

CONDITIONAL = {"NOT": (0,), "AND": (0, 1), "OR": (0, 1), "IF_ELSE_ZERO": (0,), "SELECT": (0,)}
"""Operands that are conditions."""


def has_template(operation: str) -> bool:
    """Return whether an operation is printed as an expression."""
    return operation in _TEMPLATES


def expression(
    operation: str,
    names: Sequence[str],
    is_number: Sequence[bool],
    table: dict[str, str | int],
) -> str:
    """Return the expression of an operation.

    Parameters
    ----------
    operation
        One that has a template.
    names
        Expressions of its operands.
    is_number
        Whether each operand is surely a number.
    table
        What a look-up asks for: ``table``, ``width`` and ``power``; empty otherwise.
    """
    if operation in _BOUNDED:
        bounds = [k for k, is_bound in enumerate(is_number) if is_bound]
        if bounds:
            return _BOUNDED[operation].format(names[1 - bounds[-1]], names[bounds[-1]])
    return _TEMPLATES[operation].format(*names, **table)


def literal(value: float) -> str:
    """Return a number as C writes it."""
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))
