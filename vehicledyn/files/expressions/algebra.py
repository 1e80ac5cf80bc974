"""What expressions are made of: quantities, functions, and how numbers and symbols obey them."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from vehicledyn.base.numbers import quarter_turns
from vehicledyn.base.units import Unit
from vehicledyn.symbolic import ops

Algebra = Mapping[str, Callable[..., Any]]
"""Functions on scalars by name; "number" makes a scalar of a :class:`WrittenNumber`."""


class ExpressionError(ValueError):
    """An expression cannot be read or has no value; its text says why."""


@dataclass(frozen=True)
class WrittenNumber:
    """A number as written, with its unit's text and meaning, both absent for a bare number."""

    value: float
    unit: str = ""
    given: Unit | None = None

    @property
    def si(self) -> float:
        """The number in SI."""
        return self.value * self.given.factor if self.given else self.value

    def __str__(self) -> str:
        """Return the quantity as it is written."""
        number = f"{self.value:.17g}" if float(f"{self.value:.15g}") != self.value else None
        return f"{number or f'{self.value:.15g}'} {self.unit}".strip()


FUNCTIONS = {
    **dict.fromkeys(("sin", "cos", "tan", "asin", "acos", "atan", "tanh", "exp", "log"), 1),
    **dict.fromkeys(("sqrt", "abs", "sign", "norm", "unit"), 1),
    **dict.fromkeys(("mirror_x", "mirror_y", "mirror_z"), 1),
    **dict.fromkeys(("atan2", "min", "max", "dot", "cross"), 2),
    "where": 3,
}
"""Functions that an expression may call, with the number of their arguments."""

_VECTORS: dict[str, Callable[..., Any]] = {}


def apply(function: str, arguments: list[Any], algebra: Algebra) -> Any:
    """Return a function or operator of scalars and vectors (tuples of three).

    Raises
    ------
    ExpressionError
        If the arguments do not suit it.
    """
    if function in _VECTORS:
        return _VECTORS[function](algebra, *arguments)
    if not any(isinstance(item, tuple) for item in arguments):
        return _scalar(function, arguments, algebra)
    vectors = [isinstance(item, tuple) for item in arguments]
    if function in ("+", "-") and all(vectors):
        pairs = zip(*arguments, strict=True)
        return tuple(algebra[function](a, b) for a, b in pairs)
    if function == "negative":
        return tuple(algebra["negative"](a) for a in arguments[0])
    if function == "*" and sum(vectors) == 1:
        vector, scalar = arguments if vectors[0] else reversed(arguments)
        return tuple(algebra["*"](scalar, a) for a in vector)
    if function == "/" and vectors == [True, False]:
        return tuple(algebra["/"](a, arguments[1]) for a in arguments[0])
    hint = "; use dot() or cross()" if function == "*" else ""
    raise ExpressionError(f"'{function}' does not go with a vector here{hint}")


def _scalar(function: str, arguments: list[Any], algebra: Algebra) -> Any:
    try:
        return algebra[function](*arguments)
    except ZeroDivisionError:
        raise ExpressionError("divides by zero") from None
    except OverflowError:
        raise ExpressionError("the number is too large") from None
    except ExpressionError:
        raise
    except ValueError:
        shown = ", ".join(f"{a:g}" for a in arguments)
        raise ExpressionError(f"{function} is not defined at {shown}") from None


def _vector_function(function: Callable[..., Any]) -> Callable[..., Any]:
    """Enter a function of vectors under its name, less the underscore in front."""
    name = function.__name__.strip("_")

    def checked(algebra: Algebra, *arguments: Any) -> Any:
        if not all(isinstance(item, tuple) for item in arguments):
            raise ExpressionError(f"{name}() needs vectors")
        return function(algebra, *arguments)

    _VECTORS[name] = checked
    return checked


@_vector_function
def _dot(algebra: Algebra, a: tuple[Any, ...], b: tuple[Any, ...]) -> Any:
    times, plus = algebra["*"], algebra["+"]
    return plus(plus(times(a[0], b[0]), times(a[1], b[1])), times(a[2], b[2]))


@_vector_function
def _cross(algebra: Algebra, a: tuple[Any, ...], b: tuple[Any, ...]) -> Any:
    times, minus = algebra["*"], algebra["-"]
    pairs = ((1, 2), (2, 0), (0, 1))
    return tuple(minus(times(a[i], b[j]), times(a[j], b[i])) for i, j in pairs)


@_vector_function
def _norm(algebra: Algebra, a: tuple[Any, ...]) -> Any:
    return _scalar("sqrt", [_VECTORS["dot"](algebra, a, a)], algebra)


@_vector_function
def _unit(algebra: Algebra, a: tuple[Any, ...]) -> Any:
    length = _VECTORS["norm"](algebra, a)
    return tuple(_scalar("/", [component, length], algebra) for component in a)


@_vector_function
def _mirror_x(algebra: Algebra, a: tuple[Any, ...]) -> Any:
    return (algebra["negative"](a[0]), a[1], a[2])


@_vector_function
def _mirror_y(algebra: Algebra, a: tuple[Any, ...]) -> Any:
    return (a[0], algebra["negative"](a[1]), a[2])


@_vector_function
def _mirror_z(algebra: Algebra, a: tuple[Any, ...]) -> Any:
    return (a[0], a[1], algebra["negative"](a[2]))


def _vector(_: Algebra, *components: Any) -> Any:
    if any(isinstance(item, tuple) for item in components):
        raise ExpressionError("a component of a vector is itself a vector")
    return components


_VECTORS["vector"] = _vector


def _power(base: float, exponent: float) -> float:
    if base < 0.0 and not float(exponent).is_integer():
        raise ExpressionError(f"{base:g} has no power {exponent:g}")
    return float(base**exponent)


_OPERATORS: dict[str, Callable[..., Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "negative": operator.neg,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "pi": lambda: math.pi,
    "number": lambda quantity: quantity.si,
}

NUMBERS: Algebra = {
    **_OPERATORS,
    "sin": quarter_turns.sine,
    "cos": quarter_turns.cosine,
    **{name: getattr(math, name) for name in ("tan", "asin", "acos", "atan")},
    **{name: getattr(math, name) for name in ("atan2", "tanh", "exp", "log", "sqrt")},
    "**": _power,
    "abs": abs,
    "min": min,
    "max": max,
    "sign": lambda x: float((x > 0.0) - (x < 0.0)),
    "where": lambda condition, yes, no: yes if condition else no,
}
"""Arithmetic of floats."""

SYMBOLS: Algebra = {
    **_OPERATORS,
    **{name: getattr(ops, name) for name in ("sin", "cos", "tan", "asin", "atan", "atan2")},
    **{name: getattr(ops, name) for name in ("tanh", "exp", "log", "sqrt", "sign", "where")},
    "**": operator.pow,
    "acos": lambda x: 0.5 * math.pi - ops.asin(x),
    "abs": ops.absolute,
    "min": ops.minimum,
    "max": ops.maximum,
}
"""Arithmetic of floats and CasADi expressions alike."""
