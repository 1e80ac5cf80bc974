"""Expressions that several places share: written once, called with the arguments of each place.

Eight wheels on rails, or four tyres, have the same equations for different numbers. As a call of
one function they stay short: generated code holds the function once, which keeps it in the
processor's cache, and compiling it takes a part of the time. CasADi evaluates and differentiates
calls as they are; :func:`inlined` writes them out where a form without calls is needed.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Sequence
from typing import Any

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.table_calls import call_with, rewritten, walk_calls

_PREFIX = "shared_"


_MOST = 1024

_FUNCTIONS: BoundedCache[str, Any] = BoundedCache(_MOST)
"""Functions that are called, by their names, which tell their content."""
_BODIES: BoundedCache[str, Any] = BoundedCache(_MOST)
"""The same functions as CasADi inlines them."""


def shared(
    name: str,
    arguments: Sequence[Scalar],
    build: Callable[[list[Scalar]], Sequence[Scalar]],
    kept: Collection[int] = (),
    built: dict[tuple[float | None, ...], Any] | None = None,
) -> list[Scalar]:
    """Return scalars as results of a function that is written once for all equal places.

    Parameters
    ----------
    name
        What the function is, letters and digits.
    arguments
        What differs from place to place; those that are plain numbers are written into the
        function, as is all else that ``build`` uses.
    build
        Returns the results for given arguments; it may use nothing symbolic but these.
    kept
        Which of the arguments stay arguments even where they are plain numbers, since at another
        place they are none.
    built
        Where functions are kept for the next place, of a ``build`` whose results differ with the
        arguments alone.
    """
    import casadi

    given = [casadi.SX(item) for item in arguments]
    free = [k for k, item in enumerate(given) if k in kept or not item.is_constant()]
    numbers = tuple(None if k in free else float(item) for k, item in enumerate(given))
    known = {} if built is None else built
    if numbers not in known:
        known[numbers] = _written(name, numbers, build)
    call = known[numbers]
    found = call(casadi.vertcat(*[given[k] for k in free])) if free else call
    return [found[k] for k in range(found.numel())]


def _written(
    name: str,
    numbers: Sequence[float | None],
    build: Callable[[list[Scalar]], Sequence[Scalar]],
) -> Any:
    """Return the shared function of the arguments that are no numbers; without any, its results."""
    import casadi

    free = [k for k, item in enumerate(numbers) if item is None]
    symbols = casadi.SX.sym(name, len(free))
    values: list[Any] = list(numbers)
    for number, k in enumerate(free):
        values[k] = symbols[number]
    results = casadi.vertcat(*[casadi.SX(item) for item in build(values)])
    results = casadi.cse(casadi.densify(results))
    return known_function(name, symbols, results) if free else results


def inlined(expression: Any) -> Any:
    """Return an SX matrix with all shared functions written out."""
    if not len(_FUNCTIONS):
        return expression

    def written(function: Any, scalars: list[Any]) -> list[Any]:
        return call_with(body_of(function) if is_shared(function.name()) else function, scalars)

    return walk_calls(expression, is_shared, written)


def is_shared(name: str) -> bool:
    """Return whether a name is that of a shared function."""
    return name.startswith(_PREFIX)


def know_shared(expressions: Sequence[Any]) -> None:
    """Note the shared functions in SX matrices that were read from a file."""
    import casadi

    symbols = casadi.symvar(casadi.veccat(*expressions))
    whole = casadi.Function("known", symbols, list(expressions))
    for name in filter(is_shared, whole.get_function()):
        _FUNCTIONS.get(name, lambda name=name: whole.get_function(name))  # type: ignore[misc]


def body_of(function: Any) -> Any:
    """Return a shared function as CasADi writes it out where it is called."""
    import casadi

    def built() -> Any:
        symbols = casadi.SX.sym("a", function.numel_in(0))
        results = rewritten(function, [casadi.vertsplit(symbols)], call_with)
        return casadi.Function(function.name(), [symbols], [results])

    return _BODIES.get(function.name(), built)


def known_function(name: str, symbols: Any, results: Any) -> Any:
    """Return the shared function of a column of symbols that gives a column of results."""
    import casadi

    body = casadi.Function(name, [symbols], [results])
    digest = hashlib.sha256(body.serialize().encode()).hexdigest()
    full = f"{_PREFIX}{digest[:16]}_{name}"
    _BODIES.get(full, lambda: body)
    return _FUNCTIONS.get(
        full, lambda: casadi.Function(full, [symbols], [results], {"never_inline": True})
    )


def count_operations(expression: Scalar) -> int:
    """Return the number of different operations of an SX matrix, its symbols not counted.

    Those of shared functions count at each call.
    """
    import casadi

    written = inlined(expression)
    return int(casadi.n_nodes(written)) - len(casadi.symvar(written))
