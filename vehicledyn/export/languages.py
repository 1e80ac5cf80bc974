"""How three languages write an expression: operators, functions, numbers, elements of arrays."""

from __future__ import annotations

import keyword
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from vehicledyn.base.errors import MissingPartError
from vehicledyn.codegen.ir.instructions import ENTRY
from vehicledyn.export.procedures import Argument

_ATOM, _NOT, _PRODUCT, _SUM, _COMPARISON, _AND, _OR, _CHOICE = 100, 70, 60, 50, 40, 30, 20, 10

_CONDITIONS = ("LT", "LE", "EQ", "NE", "NOT", "AND", "OR")
_TAKES_CONDITIONS = (*_CONDITIONS, "IF_ELSE_ZERO", "ASSIGN")
_C_KEYWORDS = """
    auto break case char const continue default do double else enum extern float for goto if inline
    int long register restrict return short signed sizeof static struct switch typedef union
    unsigned void volatile while
"""
_MATLAB_KEYWORDS = """
    break case catch classdef continue else elseif end for function global if otherwise parfor
    persistent return spmd switch try while
"""
_KEYWORDS = {*keyword.kwlist, *_C_KEYWORDS.split(), *_MATLAB_KEYWORDS.split()}


class Template(NamedTuple):
    """A format of operands, how tightly it binds, and how tightly each operand must."""

    pattern: str
    precedence: int
    operands: tuple[int, ...]


def _between(symbol: str, precedence: int) -> Template:
    """Return an operator whose chains are evaluated from the left."""
    return Template(f"{{0}} {symbol} {{1}}", precedence, (precedence, precedence + 1))


def _call(name: str, operands: int = 1) -> Template:
    """Return a function of one or two operands."""
    arguments = ", ".join(f"{{{k}}}" for k in range(operands))
    return Template(f"{name}({arguments})", _ATOM, (0,) * operands)


def _comparison(symbol: str) -> Template:
    return Template(f"{{0}} {symbol} {{1}}", _COMPARISON, (_COMPARISON + 1,) * 2)


_ALIKE = {
    "ADD": _between("+", _SUM),
    "SUB": _between("-", _SUM),
    "MUL": _between("*", _PRODUCT),
    "DIV": _between("/", _PRODUCT),
    "NEG": Template("-{0}", _SUM, (_PRODUCT,)),
    "SQ": Template("{0} * {0}", _PRODUCT, (_ATOM,)),
    "TWICE": Template("2.0 * {0}", _PRODUCT, (_PRODUCT + 1,)),
    "INV": Template("1.0 / {0}", _PRODUCT, (_PRODUCT + 1,)),
    "LT": _comparison("<"),
    "LE": _comparison("<="),
    "EQ": _comparison("=="),
    "ASSIGN": Template("{0}", _ATOM, (_ATOM,)),
}
"""What all three languages write alike."""


class Term(NamedTuple):
    """A written expression, how tightly it binds, and whether it is a truth value."""

    text: str
    precedence: int = _ATOM
    is_condition: bool = False


@dataclass(frozen=True)
class Language:
    """What differs between languages; ``templates`` are those of operations not written alike.

    ``brackets`` and ``first`` say how elements of arrays are written, ``member`` those of the
    structure of parameters.
    """

    name: str
    comment: str
    templates: dict[str, Template]
    infinity: str
    not_a_number: str
    brackets: str
    first: int
    member: str

    def variable(self, name: str, *, is_condition: bool = False) -> Term:
        """Return a reference to a variable."""
        return Term(name, _ATOM, is_condition)

    def number(self, value: float) -> Term:
        """Return a literal that reads back as the same number."""
        if math.isnan(value):
            return Term(self.not_a_number)
        text = self.infinity if math.isinf(value) else repr(abs(float(value)))
        negative = math.copysign(1.0, value) < 0.0
        return Term(f"-{text}", _SUM) if negative else Term(text)

    def element(self, argument: Argument, index: int, names: Sequence[str]) -> Term:
        """Return an element of an argument; ``names`` are those of the parameters."""
        if argument.is_scalar:
            return Term(argument.name)
        if argument.name == "p":
            return Term(f"{argument.name}{self.member}{names[index]}")
        return Term(self.at(argument.name, (index,)))

    def at(self, name: str, place: tuple[int, ...]) -> str:
        """Return the text of an element of an array, indices counted from zero."""
        indices = [str(k + self.first) for k in place]
        if self.brackets == "[][]":
            return name + "".join(f"[{k}]" for k in indices)
        return f"{name}{self.brackets[0]}{', '.join(indices)}{self.brackets[1]}"

    def look_up(self, operation: str, table: str, term: Term, power: int) -> Term:
        """Return a look-up of a table by the functions of its name; all count powers from zero."""
        arguments = [_as_number(term).text, *([str(power)] if operation == ENTRY else [])]
        return Term(f"{table}_{operation.lower()}({', '.join(arguments)})")

    def apply(self, operation: str, terms: list[Term]) -> Term:
        """Return an operation on written expressions.

        Raises
        ------
        MissingPartError
            If the language has no such operation.
        """
        template = _ALIKE.get(operation) or self.templates.get(operation)
        if template is None:
            raise MissingPartError(
                f"the operation {operation} has no translation to {self.name}; write the "
                "expression with elementary functions"
            )
        if operation not in _TAKES_CONDITIONS:
            terms = [_as_number(term) for term in terms]
        texts = [_held(term, need) for term, need in zip(terms, template.operands, strict=True)]
        text = template.pattern.format(*texts)
        return Term(text, template.precedence, operation in _CONDITIONS)


def _held(term: Term, precedence: int) -> str:
    """Return a text in parentheses if it binds less tightly than asked."""
    return term.text if term.precedence >= precedence else f"({term.text})"


def _as_number(term: Term) -> Term:
    return Term(f"1.0 * {_held(term, _PRODUCT + 1)}", _PRODUCT) if term.is_condition else term


def safe_name(name: str) -> str:
    """Return a name as an identifier of C, Python and MATLAB."""
    plain = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_") or "n"
    if plain[0].isdigit():
        plain = f"n{plain}"
    return f"{plain}_" if plain in _KEYWORDS else plain


def safe_names(names: Sequence[str]) -> list[str]:
    """Return different identifiers for different names, in their order."""
    taken: set[str] = set()
    result = []
    for name in names:
        plain = safe_name(name)
        while plain in taken:
            plain = f"{plain}_"
        taken.add(plain)
        result.append(plain)
    return result


_UNARY = (
    *("exp", "log", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh"),
    *("asinh", "acosh", "atanh", "floor", "ceil", "erf", "expm1", "log1p"),
)
_BINARY = ("atan2", "fmod", "remainder", "copysign", "hypot", "pow", "fmin", "fmax")
_SYMBOLS = {
    "NOT": Template("!{0}", _NOT, (_NOT + 1,)),
    "AND": _between("&&", _AND),
    "OR": Template("{0} || {1}", _OR, (_COMPARISON,) * 2),
    "NE": _comparison("!="),
}

C = Language(
    name="C",
    comment="//",
    templates={
        **{name.upper(): _call(name) for name in (*_UNARY, "fabs")},
        **{name.upper(): _call(name, 2) for name in _BINARY},
        "CONSTPOW": _call("pow", 2),
        "SIGN": _call("sign_of"),
        "IF_ELSE_ZERO": Template("{0} ? {1} : 0.0", _CHOICE, (_CHOICE + 1,) * 2),
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
        **{n.upper(): _call(f"np.{_NUMPY.get(n, n)}") for n in (*_UNARY, "fabs", "sign")},
        **{n.upper(): _call(f"np.{_NUMPY.get(n, n)}", 2) for n in _BINARY},
        "CONSTPOW": _call("np.power", 2),
        "ERF": _call("math.erf"),
        "REMAINDER": _call("math.remainder", 2),
        "IF_ELSE_ZERO": Template("{1} if {0} else 0.0", _CHOICE, (_CHOICE + 1,) * 2),
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
        "NOT": Template("~{0}", _NOT, (_NOT + 1,)),
        "AND": _between("&", _AND),
        "OR": Template("{0} | {1}", _OR, (_COMPARISON,) * 2),
        "NE": _comparison("~="),
    },
    infinity="Inf",
    not_a_number="NaN",
    brackets="()",
    first=1,
    member=".",
)
