"""Parameters of a system file: flat names, in an order in which each rests on earlier ones."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Place, dotted
from vehicledyn.base.units import describe, parse_unit
from vehicledyn.files.expressions.algebra import FUNCTIONS, NUMBERS, ExpressionError
from vehicledyn.files.expressions.dimensions import MEASURES, Measure, misfit
from vehicledyn.files.expressions.expressions import Expression, read_expression

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_BOUNDS = ("above", "least")
_LONG = {"value", "description", *_BOUNDS}
RESERVED = {*FUNCTIONS, "pi", "time"}


@dataclass(frozen=True)
class ParameterEntry:
    """One parameter: what the file gives, what it is measured in and its value in SI."""

    name: str
    expression: Expression
    description: str
    measure: Any
    value: Any

    @property
    def components(self) -> list[tuple[str, Expression, Measure, float]]:
        """Scalars that it consists of, by dotted name."""
        if not isinstance(self.value, tuple):
            return [(self.name, self.expression, self.measure, self.value)]
        parts = self.expression.root.arguments
        whole = self.expression.root.function == "vector"
        return [
            (
                f"{self.name}.{axis}",
                Expression(parts[k]) if whole else self.expression,
                self.measure[k],
                self.value[k],
            )
            for k, axis in enumerate(("x", "y", "z"))
        ]


@dataclass
class Parameters:
    """All parameters of a system, and what is wrong with them by place in the file."""

    entries: list[ParameterEntry] = field(default_factory=list)
    problems: list[tuple[Place, str]] = field(default_factory=list)
    declared: set[str] = field(default_factory=set)

    @property
    def values(self) -> dict[str, Any]:
        """Values in SI by name, tuples for vectors."""
        return {entry.name: entry.value for entry in self.entries}

    @property
    def measures(self) -> dict[str, Any]:
        """Measures by name, tuples for vectors."""
        return {entry.name: entry.measure for entry in self.entries}

    @property
    def units(self) -> dict[str, str]:
        """SI units of all scalars by dotted name."""
        return {name: m.unit for e in self.entries for name, _, m, _ in e.components}


@dataclass(frozen=True)
class _Declared:
    expression: Expression
    description: str
    place: Place
    bounds: tuple[tuple[str, Expression], ...] = ()


def read_parameters(data: Any, before: Parameters | None = None) -> Parameters:
    """Return the parameters that a file's mapping declares.

    Parameters
    ----------
    data
        Nested mapping of names to values, expressions, lists of three, mappings with ``value``,
        ``description`` and bounds (``above``, ``least``), or groups of these.
    before
        The same parameters with other values, whose units are kept where they fit: a change to
        N m s leaves a damping in N m s/rad.
    """
    found = Parameters()
    declared: dict[str, _Declared] = {}
    for name, item in _declared(data, ("parameters",), found.problems):
        declared[name] = item
    wrong = {dotted(place[1:]) for place, _ in found.problems}
    found.declared = set(declared) | wrong
    _resolve(declared, found, before.measures if before else {})
    return found


def is_long(value: Any) -> bool:
    """Return whether a mapping is a parameter in long form, not a group."""
    return isinstance(value, dict) and "value" in value


def _declared(
    data: Any, place: Place, problems: list[tuple[Place, str]]
) -> Iterator[tuple[str, _Declared]]:
    if not isinstance(data, dict):
        if data is not None:
            problems.append((place, f"expected a mapping, found {describe(data)}"))
        return
    for name, item in data.items():
        here = (*place, name)
        if not is_name(name):
            hint = "; decimals have a point, no comma" if name[:1].isdigit() else ""
            problems.append((here, f"'{name}' cannot be a name; use letters, digits and _{hint}"))
        elif name in RESERVED:
            problems.append((here, f"'{name}' has a meaning in expressions; take another name"))
        elif isinstance(item, dict) and not is_long(item):
            yield from _declared(item, here, problems)
        else:
            long = item if isinstance(item, dict) else {"value": item}
            for key in set(long) - _LONG:
                words = f"unknown key. Known: {', '.join(sorted(_LONG))}; quote texts with commas"
                problems.append(((*here, key), words))
            try:
                expression = read_expression(long["value"])
                bounds = tuple((k, read_expression(long[k])) for k in _BOUNDS if k in long)
            except ExpressionError as error:
                problems.append((here, str(error)))
            else:
                words = str(long.get("description") or name.replace("_", " ").capitalize())
                yield dotted(here[1:]), _Declared(expression, words, here, bounds)


def is_name(name: str) -> bool:
    """Return whether a text can name a part or parameter."""
    return _NAME.fullmatch(name) is not None and not keyword.iskeyword(name)


def _resolve(declared: dict[str, _Declared], found: Parameters, before: Mapping[str, Any]) -> None:
    """Enter the declared parameters, each after those it rests on."""
    values: dict[str, Any] = {}
    measures: dict[str, Any] = {}
    failed: set[str] = set()
    wrong = found.declared - set(declared)

    def visit(name: str, path: tuple[str, ...]) -> None:
        if name in values or name in failed:
            return
        item = declared[name]
        if name in path:
            circle = " -> ".join([*path[path.index(name) :], name])
            found.problems.append((item.place, f"rests on itself: {circle}"))
            failed.add(name)
            return
        if any(n in wrong or n.rpartition(".")[0] in wrong for n in item.expression.names):
            failed.add(name)
            return
        needed = [_owner(used, declared) for used in item.expression.names]
        for used in needed:
            if used is not None:
                visit(used, (*path, name))
        if name in failed or failed & set(filter(None, needed)):
            failed.add(name)
            return
        try:
            measure = _settled(item.expression.value(measures, MEASURES))
            measure = _kept(measure, before.get(name))
            _check_unit(measure)
            value = item.expression.value(values, NUMBERS)
            _check_bounds(item, value, measure)
        except ExpressionError as error:
            found.problems.append((item.place, str(error)))
            failed.add(name)
            return
        values[name], measures[name] = value, measure
        found.entries.append(
            ParameterEntry(name, item.expression, item.description, measure, value)
        )

    for name in declared:
        visit(name, ())


def _kept(measure: Any, before: Any) -> Any:
    """Return what a value was measured in before where the new measure fits, else the new one."""
    if isinstance(measure, tuple):
        if not isinstance(before, tuple) or len(before) != len(measure):
            return measure
        return tuple(_kept(new, old) for new, old in zip(measure, before, strict=True))
    is_one = isinstance(before, Measure) and measure.replaces(before)
    return before if is_one and measure.exact == before.exact else measure


def _owner(used: str, declared: dict[str, _Declared]) -> str | None:
    if used in declared:
        return used
    whole = used.rpartition(".")[0]
    return whole if whole in declared else None


def _check_unit(measure: Any) -> None:
    """Refuse what is measured in something that no unit names, such as m^400."""
    for part in measure if isinstance(measure, tuple) else (measure,):
        try:
            parse_unit(part.unit)
        except InputError as error:
            raise ExpressionError(
                f"a parameter needs a unit that can be written: {error}"
            ) from None


def _check_bounds(item: _Declared, value: Any, measure: Any) -> None:
    """Refuse a number outside of the bounds that its declaration gives."""
    for word, expression in item.bounds:
        bound, of = expression.value({}, NUMBERS), _settled(expression.value({}, MEASURES))
        if isinstance(value, tuple) or isinstance(bound, tuple):
            raise ExpressionError(f"{word}: only one number has a bound")
        if bound != 0.0 and not of.fits(measure.unit):
            raise ExpressionError(f"{word}: {misfit(of, measure.unit)}")
        if not (value > bound if word == "above" else value >= bound):
            limit = "greater than" if word == "above" else "at least"
            unit = "" if measure.unit == "1" else f" {measure.unit}"
            raise ExpressionError(f"must be {limit} {bound:g}{unit}, is {value:g}")


def _settled(measure: Any) -> Any:
    """Return the measure of a named quantity: no longer bare, exact if nothing was calculated.

    Zeros among the components of a vector take the unit that others have.

    Raises
    ------
    ExpressionError
        If another number without unit stands beside components with one.
    """
    if isinstance(measure, tuple):
        known = next((m for m in measure if m.bare is None), measure[0])
        for part in measure:
            if part.bare is not None and known.bare is None and not part.fits(known.unit):
                raise ExpressionError(misfit(part, known.unit))
        return tuple(_settled(known if m.bare is not None else m) for m in measure)
    return Measure(measure.powers, exact=measure.exact)
