"""Expressions of system files: arithmetic on named quantities, read without running any code.

An expression is a number, a quantity with a unit, or arithmetic on these and on names::

    2 * radius + 30 mm        norm(outer - inner)        where(rate < 0, 800 N*s/m, 0) * rate

A unit follows its number after a blank and has no blanks inside. Whatever is not listed in
:mod:`vehicledyn.files.expressions.algebra` is refused; nothing is ever evaluated by Python itself.
"""

from __future__ import annotations

import ast
import math
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.units import UNITS, describe, parse_unit
from vehicledyn.files.expressions.algebra import (
    FUNCTIONS,
    Algebra,
    ExpressionError,
    WrittenNumber,
    apply,
)
from vehicledyn.files.expressions.nodes import Node

LONGEST, DEEPEST = 2000, 150
"""Characters and nested operations of the longest and the deepest expression that is read."""

_UNIT_SIGNS = frozenset("µ°·⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_MOST_SHOWN = 60

_OPERATORS = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Pow: "**"}
_COMPARISONS = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">="}
_NUMBER = r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
_ALONE = re.compile(rf"([+-]?{_NUMBER})\s*([A-Za-zµ°%(1].*)?", re.DOTALL)
_INSIDE = re.compile(
    rf"(?<![\w.])({_NUMBER})\s+((?:1/)?[A-Za-zµ°%]+(?:\^-?\d+)?(?:[*/][A-Za-zµ°%]+(?:\^-?\d+)?)*)"
)
_SPACED_OPERATOR = re.compile(r"\s[-+*/]|[-+*/]\s|\*\*")
_HELD = "quantity_"
_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Expression:
    """An expression read from a file; ``root`` is its last step."""

    root: Node

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: Any) -> Any:
        """Say that a field takes any expression as it is, which spares looking into all steps."""
        from pydantic_core import core_schema

        return core_schema.is_instance_schema(cls)

    def __str__(self) -> str:
        """Return the expression as text."""
        return str(self.root)

    @property
    def plain(self) -> Any:
        """The expression as YAML holds it: a number, a text or a list of three."""
        return _plain(self.root)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names in the order they occur."""
        return tuple(_names(self.root, {}))

    def replaced(self, names: Mapping[str, Expression]) -> Expression:
        """Return the expression with some names replaced by expressions."""
        return Expression(_replaced(self.root, names))

    def mirrored(self, axis: int, sign: float = 1.0) -> Expression:
        """Return a vector with component ``axis`` (1 to 3) turned round, all times ``sign``."""
        signs = [sign * (-1.0 if k == axis else 1.0) for k in (1, 2, 3)]
        if self.root.function == "vector":
            parts = [_signed(n, s) for n, s in zip(self.root.arguments, signs, strict=True)]
            return Expression(Node(function="vector", arguments=tuple(parts)))
        flipped = Node(function=f"mirror_{_AXES[axis - 1]}", arguments=(self.root,))
        return Expression(_signed(flipped, sign))

    def negated(self) -> Expression:
        """Return the expression times -1."""
        return Expression(_signed(self.root, -1.0))

    def value(self, names: Mapping[str, Any], algebra: Algebra) -> Any:
        """Return what the expression is worth, a scalar or a tuple of three.

        Parameters
        ----------
        names
            Value of each name; of a vector a tuple, whose components are ``name.x`` and so on.
        algebra
            How to calculate: with numbers, symbols or units.

        Raises
        ------
        ExpressionError
            If a name is not known or the arithmetic is impossible.
        """
        return _value(self.root, names, algebra)


def read_expression(value: object) -> Expression:
    """Return the expression that a number, a text or a list of three stands for.

    Raises
    ------
    ExpressionError
        If it is no expression; the text says what is allowed.
    """
    if isinstance(value, Expression):
        return value
    if isinstance(value, bool) or value is None or isinstance(value, dict):
        shown = str(value).lower() if isinstance(value, bool) else describe(value)
        raise ExpressionError(f"expected a quantity or an expression, found {shown}")
    if isinstance(value, int | float):
        return Expression(Node(quantity=_bare(value)))
    if isinstance(value, list | tuple):
        if len(value) != len(_AXES):
            raise ExpressionError(f"expected 3 components, found {len(value)}")
        parts = tuple(read_expression(item).root for item in value)
        return Expression(Node(function="vector", arguments=parts))
    return Expression(_read_text(str(value)))


def named(name: str, *, sign: float = 1.0) -> Expression:
    """Return a name, or its negative."""
    return Expression(_signed(Node(name=name), sign))


def zero() -> Expression:
    """Return the number zero."""
    return Expression(Node(quantity=WrittenNumber(0.0)))


def origin() -> Expression:
    """Return the vector of three zeros."""
    return read_expression([0, 0, 0])


def _read_text(text: str) -> Node:
    if len(text) > LONGEST:
        raise ExpressionError(f"longer than {LONGEST} characters")
    strange = next((c for c in text if not (c.isascii() or c in _UNIT_SIGNS) or c == "#"), None)
    if strange is not None:
        raise ExpressionError(
            f"the character '{strange}' (U+{ord(strange):04X}) has no meaning in an expression"
        )
    alone = _alone(text)
    if alone is not None:
        return Node(quantity=alone)
    held: list[WrittenNumber] = []

    def hold(match: re.Match[str]) -> str:
        held.append(_quantity(match[1], match[2]))
        return f"{_HELD}{len(held) - 1}"

    code = _INSIDE.sub(hold, text).strip()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(code, mode="eval")
        root = _converted(tree.body, held)
        _refuse_comparison(root)
        return root
    except (SyntaxError, ValueError, MemoryError) as error:
        if isinstance(error, ExpressionError):
            raise
        if "nested" in str(error):
            raise ExpressionError("nested too deeply") from None
        raise ExpressionError(f"'{_shown(text)}' is neither a quantity nor an expression") from None
    except RecursionError:
        raise ExpressionError("nested too deeply") from None


def _refuse_comparison(node: Node) -> None:
    """Refuse comparisons outside the conditions of where(): they are no quantities."""
    if node.function in _COMPARISONS.values():
        raise ExpressionError(
            f"'{_shown(str(node))}' is a comparison, which has its place in where(condition, yes, "
            "no); what passes zero is a difference of its sides"
        )
    for inner in node.arguments[1 if node.function == "where" else 0 :]:
        _refuse_comparison(inner)


def _alone(text: str) -> WrittenNumber | None:
    """Return a number with or without unit, or None if the text is more than that."""
    match = _ALONE.fullmatch(text.strip())
    if match is None or _SPACED_OPERATOR.search(match[2] or ""):
        return None
    return _quantity(match[1], match[2] or "")


def _quantity(number: str, unit: str) -> WrittenNumber:
    try:
        given = parse_unit(unit) if unit else None
    except InputError as error:
        raise ExpressionError(f"{error}{_split_hint(unit)}") from None
    solid = unit if "(" in unit else re.sub(r"\s*([*/·])\s*|\s+", lambda m: m[1] or "*", unit)
    return replace(_bare(number), unit=solid, given=given)


def _split_hint(unit: str) -> str:
    """Return how to end a unit where a name follows it without a blank, as in "2 rad/s*time"."""
    for sign in reversed(list(re.finditer(r"[*/]", unit))):
        head, name = unit[: sign.start()], unit[sign.end() :]
        if _is_unit(head):
            split = _shown(f"{head} {sign[0]} {name}")
            return f"; to go on after a unit put blanks round the sign: {split}"
    return ""


def _is_unit(text: str) -> bool:
    try:
        parse_unit(text)
    except InputError:
        return False
    return bool(text)


def _bare(number: str | float) -> WrittenNumber:
    try:
        value = float(number)
    except OverflowError:
        value = math.inf
    if not math.isfinite(value):
        raise ExpressionError(f"expected a finite number, found '{_shown(str(number))}'")
    return WrittenNumber(value)


def _shown(text: str) -> str:
    """Return a text, only its beginning if it is long."""
    return text if len(text) <= _MOST_SHOWN else f"{text[:_MOST_SHOWN]}..."


def _converted(tree: ast.expr, held: list[WrittenNumber], depth: int = 0) -> Node:
    if depth > DEEPEST:
        raise ExpressionError("nested too deeply")
    if isinstance(tree, ast.Name | ast.Attribute):
        return _named(tree, held)
    if isinstance(tree, ast.Constant) and type(tree.value) in (int, float):
        return Node(quantity=_bare(ast.unparse(tree)))
    function, parts = _operation(tree)
    arguments = tuple(_converted(part, held, depth + 1) for part in parts)
    return Node(function=function, arguments=arguments) if function else arguments[0]


def _operation(tree: ast.expr) -> tuple[str, list[ast.expr]]:
    """Return the function of a step, empty for none, and what it is applied to."""
    match tree:
        case ast.BinOp() if type(tree.op) in _OPERATORS:
            found = _OPERATORS[type(tree.op)], [tree.left, tree.right]
        case ast.BinOp(op=ast.BitXor()):
            raise ExpressionError("write ** for a power")
        case ast.UnaryOp(op=ast.UAdd()):
            found = "", [tree.operand]
        case ast.UnaryOp(op=ast.USub()):
            found = "negative", [tree.operand]
        case ast.Compare(ops=[op]) if type(op) in _COMPARISONS:
            found = _COMPARISONS[type(op)], [tree.left, tree.comparators[0]]
        case ast.List() | ast.Tuple() if len(tree.elts) == len(_AXES):
            found = "vector", tree.elts
        case ast.Call(func=ast.Name(id=name), keywords=[]):
            found = _function(name, len(tree.args)), tree.args
        case _:
            known, given = ", ".join(sorted(FUNCTIONS)), _shown(ast.unparse(tree))
            raise ExpressionError(
                f"'{given}' is not allowed in an expression; only numbers, names, "
                f"+ - * / ** and functions are. Functions: {known}"
            )
    return found


def _named(tree: ast.expr, held: list[WrittenNumber]) -> Node:
    parts: list[str] = []
    while isinstance(tree, ast.Attribute):
        parts.append(tree.attr)
        tree = tree.value
    if not isinstance(tree, ast.Name):
        raise ExpressionError(f"'{ast.unparse(tree)}' is no name")
    name = ".".join([tree.id, *reversed(parts)])
    if name.startswith(_HELD) and name[len(_HELD) :].isdecimal():
        index = int(name[len(_HELD) :])
        if index < len(held):
            return Node(quantity=held[index])
    return Node(name=name)


def _function(name: str, count: int) -> str:
    if name not in FUNCTIONS:
        hint = " (put an operator between a name and a bracket)" if name in UNITS else ""
        raise ExpressionError(unknown_name("function", name, FUNCTIONS) + hint)
    wanted = FUNCTIONS[name]
    if count != wanted:
        raise ExpressionError(f"{name}() takes {wanted} argument(s), found {count}")
    return name


def _value(node: Node, names: Mapping[str, Any], algebra: Algebra) -> Any:
    if node.quantity is not None:
        return algebra["number"](node.quantity)
    if node.name:
        return _lookup(node.name, names, algebra)
    return apply(node.function, [_value(n, names, algebra) for n in node.arguments], algebra)


def _lookup(name: str, names: Mapping[str, Any], algebra: Algebra) -> Any:
    if name in names:
        return names[name]
    if name == "pi":
        return algebra["pi"]()
    whole, _, component = name.rpartition(".")
    vector = names.get(whole)
    if isinstance(vector, tuple) and component in _AXES:
        return vector[_AXES.index(component)]
    raise ExpressionError(unknown_name("quantity", name, names))


def _names(node: Node, found: dict[str, None]) -> dict[str, None]:
    if node.name and node.name != "pi":
        found[node.name] = None
    for inner in node.arguments:
        _names(inner, found)
    return found


def _replaced(node: Node, names: Mapping[str, Expression]) -> Node:
    if node.name:
        return names[node.name].root if node.name in names else node
    parts = tuple(_replaced(n, names) for n in node.arguments)
    return replace(node, arguments=parts) if parts else node


def _signed(node: Node, sign: float) -> Node:
    if sign > 0.0:
        return node
    if node.function == "negative":
        return node.arguments[0]
    if node.quantity is not None:
        value = node.quantity.value
        return Node(quantity=replace(node.quantity, value=-value if value else 0.0))
    return Node(function="negative", arguments=(node,))


def _plain(node: Node) -> Any:
    if node.function == "vector":
        return [_plain(inner) for inner in node.arguments]
    if node.quantity is not None and not node.quantity.unit:
        return node.quantity.value
    return str(node)
