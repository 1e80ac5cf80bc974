"""How a language writes an expression: operators, functions, numbers, elements of arrays.

Generated kernels and exported models are written by this one printer; the operations of each
language are in :mod:`vehicledyn.codegen.printers.operations`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from vehicledyn.base.errors import MissingPartError
from vehicledyn.codegen.ir.instructions import ENTRY

ATOM, NOT, PRODUCT, SUM, COMPARISON, AND, OR, CHOICE = 100, 70, 60, 50, 40, 30, 20, 10

_CONDITIONS = ("LT", "LE", "EQ", "NE", "NOT", "AND", "OR")
_TAKES_CONDITIONS = (*_CONDITIONS, "IF_ELSE_ZERO", "ASSIGN")


class Template(NamedTuple):
    """A format of operands, how tightly it binds, and how tightly each operand must."""

    pattern: str
    precedence: int
    operands: tuple[int, ...]


class Term(NamedTuple):
    """A written expression, how tightly it binds, and whether it is a truth value."""

    text: str
    precedence: int = ATOM
    is_condition: bool = False


@dataclass(frozen=True)
class Language:
    """What differs between languages; ``templates`` are those of its operations.

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
        return Term(name, ATOM, is_condition)

    def number(self, value: float) -> Term:
        """Return a literal that reads back as the same number."""
        if math.isnan(value):
            return Term(self.not_a_number)
        text = self.infinity if math.isinf(value) else repr(abs(float(value)))
        negative = math.copysign(1.0, value) < 0.0
        return Term(f"-{text}", SUM) if negative else Term(text)

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

    def has(self, operation: str) -> bool:
        """Return whether an operation is written as an expression."""
        return operation in self.templates

    def apply(self, operation: str, terms: list[Term]) -> Term:
        """Return an operation on written expressions.

        Raises
        ------
        MissingPartError
            If the language has no such operation.
        """
        template = self.templates.get(operation)
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
    return Term(f"1.0 * {_held(term, PRODUCT + 1)}", PRODUCT) if term.is_condition else term
