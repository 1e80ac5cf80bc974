"""Print rows: operations on four places of one case, in terms of fours.h."""

from __future__ import annotations

from collections.abc import Sequence

from vehicledyn.codegen.passes.slp_rows import PackedRow

_TEMPLATES = {
    "MUL": "{0} * {1}",
    "DIV": "{0} / {1}",
    "NEG": "-{0}",
    "SQ": "{0} * {0}",
    "TWICE": "{0} + {0}",
    "INV": "1.0 / {0}",
    "LT": "vd4_lt({0}, {1})",
    "LE": "vd4_le({0}, {1})",
    "EQ": "vd4_eq({0}, {1})",
    "NE": "vd4_ne({0}, {1})",
    "NOT": "vd4_not({0})",
    "AND": "vd4_and({0}, {1})",
    "OR": "vd4_or({0}, {1})",
    "IF_ELSE_ZERO": "vd4_only({0}, {1})",
    "SELECT": "vd4_select({0}, {1}, {2})",
    "FABS": "vd4_abs({0})",
    "SQRT": "vd4_sqrt({0})",
    "FMIN": "vd4_min({0}, {1})",
    "FMAX": "vd4_max({0}, {1})",
    "SIGN": "vd4_sign({0})",
}
_BOUNDED = {"FMIN": "vd4_lesser({0}, {1})", "FMAX": "vd4_larger({0}, {1})"}
"""The same where the second operand is surely a number."""

_SUMS = {
    (1, 1): ("{0} + {1}", "vd4_fma({0}, {1}, {2})"),
    (1, -1): ("{0} - {1}", "vd4_fms({0}, {1}, {2})"),
    (-1, 1): ("{1} - {0}", "vd4_fnma({0}, {1}, {2})"),
    (-1, -1): ("-{0} - {1}", "vd4_fnms({0}, {1}, {2})"),
}
"""Sums of two terms with the same signs in all places, and fused sums of a product and a term."""


def row_expression(row: PackedRow, given: Sequence[str], is_number: Sequence[bool]) -> str:
    """Return the expression of a row.

    Parameters
    ----------
    row
        The operation in its places.
    given
        Expressions of its operands.
    is_number
        Whether each operand is surely a number.
    """
    if row.operation in ("ADD", "FMA"):
        return _sum(row, given)
    if row.operation in _BOUNDED and any(is_number):
        bound = 1 if is_number[1] else 0
        return _BOUNDED[row.operation].format(given[1 - bound], given[bound])
    return _TEMPLATES[row.operation].format(*given)


def _sum(row: PackedRow, given: Sequence[str]) -> str:
    is_fused = row.operation == "FMA"
    alike = set(zip(*row.signs, strict=True))
    if len(alike) == 1 and (pair := alike.pop()) in _SUMS:
        return _SUMS[pair][is_fused].format(*given)
    terms = list(given)
    for term, signs in zip((0, 2) if is_fused else (0, 1), row.signs, strict=True):
        if -1 in signs:
            places = ", ".join(str(int(sign < 0)) for sign in signs)
            terms[term] = f"vd4_turn({terms[term]}, {places})"
    return _SUMS[1, 1][is_fused].format(*terms)


class Copies:
    """Numbers of an array that code wants side by side, laid out behind the array once.

    ``first`` is the place of the first copy.
    """

    def __init__(self, first: int) -> None:
        """Begin without copies."""
        self._first = first
        self._known: dict[tuple[int, ...], int] = {}

    def place(self, elements: tuple[int, ...]) -> int:
        """Return where some elements of the array lie side by side."""
        if elements not in self._known:
            self._known[elements] = self._first + sum(map(len, self._known))
        return self._known[elements]

    @property
    def text(self) -> str:
        """The C text of the function that lays the copies out, and of their number."""
        lines = [
            f"  c[{place + k}] = c[{element}];"
            for elements, place in self._known.items()
            for k, element in enumerate(elements)
        ]
        body = "\n".join(["static void lay_out(real *c) {", *lines, "}"])
        return f"{body}\nVD_EXPORT const int vd_copies = {sum(map(len, self._known))};\n"
