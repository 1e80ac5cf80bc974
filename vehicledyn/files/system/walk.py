"""Walk through the parts of a system file: every expression and name with its place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.problems import Place
from vehicledyn.files.expressions.expressions import Expression
from vehicledyn.files.expressions.fields import SystemSet, expressions, fact
from vehicledyn.files.system.declared_sets import DeclaredSet, coordinate_names
from vehicledyn.files.system.joints import Coordinate, JointSet
from vehicledyn.files.system.sets import BodySet, SystemFile

_VECTORS = ("polar", "axial", "sectional", "diagonal")


@dataclass(frozen=True)
class PlacedExpression:
    """An expression of a file: where it stands and what it must be.

    ``unit`` is empty where any will do; ``variables`` is what it may use besides parameters,
    ``length`` the unit of the coordinate it is about, ``points`` names of points it may use.
    """

    place: Place
    expression: Expression
    unit: str
    is_vector: bool
    variables: str
    least: float | None
    above: float | None
    length: str
    points: tuple[str, ...]
    most: float | None = None


@dataclass(frozen=True)
class NameUse:
    """A name of a body or coordinate that a part gives, and where."""

    place: Place
    what: str
    name: str


@dataclass(frozen=True)
class _Units:
    """What ``{length}``, ``{force}`` and ``{inertia}`` stand for, and the points that may be named.

    ``known`` is false where that cannot be said, as the coordinate in question is not known.
    """

    length: str = "m"
    force: str = "N"
    points: tuple[str, ...] = ()
    known: bool = True

    def put_into(self, unit: str) -> str:
        """Return a unit with what its placeholders stand for; empty if that is not known."""
        if "{" in unit and not self.known:
            return ""
        inertia = "kg*m^2" if self.length == "rad" else "kg"
        return unit.format(length=self.length, force=self.force, inertia=inertia)


def walk(
    file: SystemFile, coordinates: dict[str, Coordinate]
) -> Iterator[PlacedExpression | NameUse]:
    """Yield all expressions and references of a file but those of parameters and starts."""
    for field in type(file).model_fields:
        value = getattr(file, field)
        if field == "mirror":
            continue
        if isinstance(value, dict) and field not in ("parameters", "initial"):
            for name, item in value.items():
                units = _units_of(item, coordinates)
                yield from _walk(item, (field, name), name, units)
        elif isinstance(value, SystemSet):
            yield from _walk(value, (field,), "", _Units())
        else:
            yield from _expressions(file, field, (field,), _Units())


def _walk(
    item: ParameterSet, place: Place, body: str, units: _Units
) -> Iterator[PlacedExpression | NameUse]:
    if not isinstance(item, SystemSet):
        return
    for name in type(item).model_fields:
        value, here = getattr(item, name), (*place, name)
        what = fact(type(item), name, "names")
        if what is not None and value is not None:
            yield NameUse(here, what, value)
        yield from _expressions(item, name, here, units)
        if isinstance(value, SystemSet):
            yield from _walk(value, here, body, units)
        elif isinstance(value, dict):
            for key, entry in value.items():
                yield from _walk(entry, (*here, key), body, units)
        elif isinstance(item, BodySet) and name == "joints":
            for number, joint in enumerate(value):
                yield from _walk(joint, (*here, number), body, _units_of_joint(joint, body))


def _expressions(
    item: ParameterSet, name: str, place: Place, units: _Units
) -> Iterator[PlacedExpression]:
    unit = fact(type(item), name, "measure")
    if unit is None:
        return
    for index, expression in expressions(item, name):
        k = index[0] + 1 if index else 0
        yield PlacedExpression(
            (*place, *index),
            expression,
            units.put_into(unit.replace("{k}", str(k))),
            fact(type(item), name, "nature") in _VECTORS,
            str(fact(type(item), name, "variables") or ""),
            fact(type(item), name, "least"),
            fact(type(item), name, "above"),
            units.length,
            units.points,
            fact(type(item), name, "most"),
        )


def _units_of(item: Any, coordinates: dict[str, Coordinate]) -> _Units:
    named = getattr(item, "coordinate", None)
    if isinstance(item, DeclaredSet):
        named = next(iter(coordinate_names(item)), None)
    points = tuple(getattr(item, "points", ()))
    if named is None:
        return _Units(points=points)
    found = coordinates.get(str(named))
    if found is None:
        return _Units(points=points, known=False)
    return _Units(found.unit, found.force_unit, points)


def _units_of_joint(joint: JointSet, body: str) -> _Units:
    own = joint.coordinates(body)
    return _Units(own[0].unit, own[0].force_unit) if own else _Units()
