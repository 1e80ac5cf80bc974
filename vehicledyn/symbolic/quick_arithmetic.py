"""Sums and products of expressions without CasADi's search for a fitting overload.

``casadi.plus(a, b)`` and its like try their overloads for numbers, ``DM`` and ``SX`` one after the
other, which takes ten times as long as the operation itself. All of them end in ``SX.binary``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

_OPERATIONS = {"add": "OP_ADD", "sub": "OP_SUB", "mul": "OP_MUL", "truediv": "OP_DIV"}


@contextmanager
def quick_arithmetic() -> Iterator[None]:
    """Let the operators of ``casadi.SX`` take the short way for expressions and floats.

    The expressions are the same; other operands go CasADi's own way. May be nested.
    """
    import casadi

    made = {}
    for word, code in _OPERATIONS.items():
        for name, is_swapped in ((f"__{word}__", False), (f"__r{word}__", True)):
            usual = getattr(casadi.SX, name)
            made[name] = (usual, _operator(getattr(casadi, code), usual, is_swapped=is_swapped))
    for name, (_, quick) in made.items():
        setattr(casadi.SX, name, quick)
    try:
        yield
    finally:
        for name, (usual, _) in made.items():
            setattr(casadi.SX, name, usual)


def _operator(
    code: int, usual: Callable[[Any, Any], Any], *, is_swapped: bool
) -> Callable[[Any, Any], Any]:
    """Return an operator of SX by an operation's code."""
    import casadi

    expression, binary = casadi.SX, casadi.SX.binary

    def operate(x: Any, y: Any) -> Any:
        kind = type(y)
        if kind is not expression and kind is not float:
            return usual(x, y)
        return binary(code, y, x) if is_swapped else binary(code, x, y)

    return operate
