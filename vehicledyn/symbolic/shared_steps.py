"""Steps of a recursion, written once for all places of a system that are alike.

A long chain repeats the same few operations joint after joint. Where each joint's step is a call
of one function, generated code holds it once and stays in the processor's cache. Steps are alike
if the same entries of what they are given are numbers, equal to each other, or opposite: nothing
that is known of a place is lost.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Mat
from vehicledyn.symbolic.shared import known_function

Entry: TypeAlias = tuple[int, float]
"""What an entry is: a number (-1, value), or a symbol and its sign (place, 1 or -1)."""

Writer: TypeAlias = Callable[
    [str, Hashable, Sequence[Mat], Callable[[list[Mat]], Sequence[Mat]]], list[Mat]
]
"""How the steps of a recursion are written: :class:`Steps` or :func:`written_out`."""

_NUMBER = -1


@dataclass(frozen=True)
class _Step:
    """A step's function and, for each matrix that it returns, its shape and entries."""

    function: Any
    results: list[tuple[tuple[int, int], list[Entry]]]
    """Places count the symbols of the arguments first, then the results of the function."""


_STEPS: BoundedCache[Hashable, _Step] = BoundedCache(1024)


class Steps:
    """Writes steps as calls of functions, and counts these and the calls.

    Parameters
    ----------
    gives_numbers
        Whether numbers other than 0, 1 and -1 are given to the functions, as in a system where
        each place has its own. Else they are written into the functions, which spares operations.
    """

    def __init__(self, *, gives_numbers: bool = False) -> None:
        self._gives_numbers = gives_numbers
        self._kinds: set[Hashable] = set()
        self._calls = 0

    @property
    def are_alike(self) -> bool:
        """Whether a step is written for two places or more on average."""
        return self._calls >= 2 * len(self._kinds)

    def __call__(
        self,
        name: str,
        structure: Hashable,
        given: Sequence[Mat],
        build: Callable[[list[Mat]], Sequence[Mat]],
    ) -> list[Mat]:
        """Return matrices as results of a function that is written once for all like places.

        Parameters
        ----------
        name
            What the step is, letters and digits.
        structure
            All that ``build`` knows besides the matrices given: steps with equal name, structure
            and form of the matrices are the same function.
        given
            Matrices; entries that are numbers are written into the function.
        build
            Returns the results for given matrices; it may use nothing symbolic but these.
        """
        import casadi

        matrices = [_dense(item) for item in given]
        entries = [entry for item in matrices for entry in item.nonzeros()]
        free: list[Any] = []
        forms = _forms(entries, free, signs=True, numbers=self._gives_numbers)
        shapes = tuple(item.shape for item in matrices)
        key = (name, structure, shapes, tuple(forms))

        def written() -> _Step:
            symbols = casadi.vertsplit(casadi.SX.sym(name, len(free))) if free else []
            return _written(name, symbols, build(_filled(shapes, forms, symbols)))

        known = _STEPS.get(key, written)
        self._kinds.add(key)
        self._calls += 1
        values = list(free)
        if known.function is not None:
            values += ops.entries_of(known.function(casadi.vertcat(*free)))
        return [_filled([shape], form, values)[0] for shape, form in known.results]


def written_out(
    name: str,
    structure: Hashable,
    given: Sequence[Mat],
    build: Callable[[list[Mat]], Sequence[Mat]],
) -> list[Mat]:
    """Return the same matrices as :class:`Steps` without a function."""
    return list(build(list(given)))


def _dense(item: Mat) -> Mat:
    import casadi

    return item if type(item) is casadi.SX and item.is_dense() else casadi.densify(casadi.SX(item))


_WRITTEN = (0.0, 1.0, -1.0)


def _forms(
    entries: Sequence[Any], free: list[Any], *, signs: bool, numbers: bool = False
) -> list[Entry]:
    """Return what each entry is; ``free`` grows by those that are neither number nor known.

    With ``signs`` what an entry is the opposite of is taken in its place; else only where that
    occurs itself, so that signs of results make no other form of what they are given to. With
    ``numbers`` all but a few of these are taken as what is not known, each by itself.
    """
    parts = [(1.0, entry) if entry.is_constant() else _unsigned(entry) for entry in entries]
    known = {item.element_hash() for sign, item in parts if signs or sign > 0}
    places = {item.element_hash(): (place, 1.0) for place, item in enumerate(free)}
    forms: list[Entry] = []
    for entry, (sign, item) in zip(entries, parts, strict=True):
        if entry.is_constant():
            if numbers and float(entry) not in _WRITTEN:
                forms.append((len(free), 1.0))
                free.append(entry)
            else:
                forms.append((_NUMBER, float(entry)))
            continue
        key = item.element_hash()
        if key not in places:
            own = 1.0 if key in known else sign
            places[key] = (len(free), own)
            free.append(item if own > 0 else entry)
        place, own = places[key]
        forms.append((place, sign * own))
    return forms


def _unsigned(entry: Any) -> tuple[float, Any]:
    """Return the sign of an entry and what it stands before."""
    import casadi

    sign = 1.0
    while not entry.is_symbolic() and entry.op() == casadi.OP_NEG:
        sign, entry = -sign, entry.dep(0)
    return sign, entry


def _filled(
    shapes: Sequence[tuple[int, int]], forms: Sequence[Entry], values: Sequence[Any]
) -> list[Mat]:
    """Return matrices of these shapes from what their entries are."""
    matrices, first = [], 0
    for rows, columns in shapes:
        entries = [
            sign if place == _NUMBER else values[place] if sign > 0 else -values[place]
            for place, sign in forms[first : first + rows * columns]
        ]
        first += rows * columns
        matrices.append(ops.filled(rows, columns, entries))
    return matrices


def _written(name: str, symbols: list[Any], results: Sequence[Mat]) -> _Step:
    """Return the function of a step; results that are given or known are not among its own."""
    import casadi

    dense = [casadi.densify(casadi.SX(item)) for item in results]
    column = casadi.cse(casadi.vertcat(*[casadi.vec(item) for item in dense]))
    values = list(symbols)
    forms = _forms(column.nonzeros(), values, signs=False)
    own = values[len(symbols) :]
    function = known_function(name, casadi.vertcat(*symbols), casadi.vertcat(*own)) if own else None
    found, first = [], 0
    for item in dense:
        found.append((item.shape, forms[first : first + item.numel()]))
        first += item.numel()
    return _Step(function, found)
