"""Checks of a whole system file: names, units, bounds, the tree and what drives it."""

from __future__ import annotations

import math
from collections import ChainMap
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from vehicledyn.base.errors import unknown_name
from vehicledyn.base.numbers.start_sizes import COARSEST_START, LARGEST_START
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.problems import Place
from vehicledyn.files.expressions.algebra import NUMBERS, ExpressionError
from vehicledyn.files.expressions.dimensions import MEASURES, measure_of, misfit
from vehicledyn.files.expressions.expressions import Expression
from vehicledyn.files.expressions.parameters import Parameters, is_name
from vehicledyn.files.system.checks.inertia import inertia_problems
from vehicledyn.files.system.checks.structure import structure_problems
from vehicledyn.files.system.checks.variables import Unknown, Variables
from vehicledyn.files.system.events import EventSet
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.places import Place as PointOfBody
from vehicledyn.files.system.sets import BodySet, Sections, SystemFile
from vehicledyn.files.system.track_frame import track_frame_problems
from vehicledyn.files.system.walk import NameUse, PlacedExpression, walk
from vehicledyn.multibody.model.ground import GROUND

Problems = Iterator[tuple[Place, str]]
_MOST_IN_CIRCLE = 20
_PARTS = tuple(name for name in Sections.model_fields if name not in ("bodies", "initial"))


def check(
    file: SystemFile,
    coordinates: dict[str, Coordinate],
    parameters: Parameters,
    brought: Iterable[str] = (),
    carriers: Collection[str] = (),
) -> Problems:
    """Yield what is wrong in a file whose parts are well formed, with places.

    Parameters
    ----------
    file
        The file, repetition and mirror images carried out.
    coordinates
        All coordinates by name.
    parameters
        The parameters, those without mistakes.
    brought
        Names of the bodies that elements bring.
    carriers
        Names of the bodies that these hang on.
    """
    yield from _names(file)
    if file.wheels and "speed" in parameters.declared:
        words = "'speed' is the forward speed of what has wheels; take another name"
        yield ("parameters", "speed"), words
    yield from _coordinates_twice(file)
    yield from tree_problems(file.bodies)
    known = _Known(file, coordinates, parameters, brought)
    for item in walk(file, coordinates):
        if isinstance(item, NameUse):
            yield from _reference(item, known)
        else:
            yield from _expression(item, known)
    yield from _initial(file, known)
    yield from _drives(file, known)
    yield from inertia_problems(file, parameters, known.driven, carriers)
    yield from structure_problems(file, coordinates)
    yield from _switches(file, known)
    yield from _events(file, known)
    yield from _constraint_forces(file)
    yield from track_frame_problems(file)


class _Known:
    """Names that expressions and references may use."""

    def __init__(
        self,
        file: SystemFile,
        coordinates: dict[str, Coordinate],
        parameters: Parameters,
        brought: Iterable[str],
    ) -> None:
        self.bodies = {GROUND, *file.bodies, *brought}
        self.coordinates = coordinates
        self.variables = Variables(coordinates)
        self.constraints = [*file.cuts, *file.constraints]
        self.parameters = parameters
        self.driven = {drive.coordinate for drive in file.drives.values()}
        self.switches = dict.fromkeys(file.switches, measure_of("1"))
        self.values, self.measures = parameters.values, parameters.measures
        self._bad = parameters.declared - set(self.values)

    def failed(self, expression: Expression) -> bool:
        """Return whether an expression rests on a parameter that has been complained about."""
        bad = self._bad
        return bool(bad) and any(n in bad or n.rpartition(".")[0] in bad for n in expression.names)


def tree_problems(bodies: dict[str, BodySet]) -> Problems:
    """Yield where bodies hang on each other in a circle, once for each circle."""
    seen: set[str] = set()
    for start in bodies:
        path: dict[str, None] = {}
        name = start
        while name in bodies and name not in seen and name not in path:
            path[name] = None
            name = bodies[name].parent
        if name in path:
            members = list(path)
            circle = members[members.index(name) :]
            shown = circle if len(circle) <= _MOST_IN_CIRCLE else [*circle[:_MOST_IN_CIRCLE], "..."]
            words = f"the bodies hang on each other: {' -> '.join([*shown, name])}"
            yield ("bodies", name, "parent"), words
        seen.update(path)


def _names(file: SystemFile) -> Problems:
    seen: dict[str, str] = {}
    for section in ("bodies", *_PARTS):
        for name in getattr(file, section):
            place = (section, name)
            if not all(is_name(piece) for piece in name.split(".")):
                yield place, f"'{name}' cannot be a name; use letters, digits, _ and dots"
            if section == "bodies" and name == GROUND:
                yield place, f"'{name}' cannot be a body's name"
            if section != "bodies" and name in seen:
                yield place, f"the name is taken: {seen[name]} '{name}' has it"
            if section != "bodies":
                seen[name] = section


def _coordinates_twice(file: SystemFile) -> Problems:
    owners: dict[str, str] = {}
    for name, body in file.bodies.items():
        for number, joint in enumerate(body.joints):
            for coordinate in joint.coordinates(name):
                place = ("bodies", name, "joints", number)
                if coordinate.name in owners:
                    yield (
                        place,
                        f"coordinate '{coordinate.name}' is defined twice, first in body "
                        f"'{owners[coordinate.name]}'; give this one a name",
                    )
                if not all(is_name(piece) for piece in coordinate.name.split(".")):
                    yield place, f"'{coordinate.name}' cannot be the name of a coordinate"
                owners.setdefault(coordinate.name, name)


def _reference(item: NameUse, known: _Known) -> Problems:
    if item.what == "body" and item.name not in known.bodies:
        yield item.place, unknown_name("body", item.name, known.bodies)
    if item.what == "coordinate" and item.name not in known.coordinates:
        yield item.place, unknown_name("coordinate", item.name, known.coordinates)
    if item.what == "constraint" and item.name not in known.constraints:
        yield item.place, unknown_name("cut or constraint", item.name, known.constraints)


def _expression(item: PlacedExpression, known: _Known) -> Problems:
    if known.failed(item.expression):
        return
    extra = known.variables.of(item.variables, item.length, item.points)
    if item.variables in ("motion", "force", "event"):
        extra |= known.switches
    for name in item.expression.names:
        if name in extra and name in known.parameters.declared:
            yield item.place, f"'{name}' is also a parameter; give that another name"
            return
    try:
        found = item.expression.value(ChainMap(extra, known.measures), MEASURES)
    except ExpressionError as error:
        yield item.place, str(error)
        return
    wrong = list(unfit(found, item.unit, is_vector=item.is_vector))
    is_list = item.expression.root.function == "vector"
    for component, words in wrong if is_list else wrong[:1]:
        yield (*item.place, *component) if is_list else item.place, words
    if not wrong:
        yield from (
            _impossible(item, ChainMap(extra, known.values)) if extra else _bounds(item, known)
        )


def _impossible(item: PlacedExpression, names: Mapping[str, Any]) -> Problems:
    """Yield what has no value whatever the names are worth, such as a division by zero."""
    try:
        item.expression.value(Unknown(names), NUMBERS)
    except ExpressionError as error:
        yield item.place, str(error)


def unfit(measure: Any, unit: str, *, is_vector: bool) -> Iterator[tuple[tuple[int, ...], str]]:
    """Yield what is wrong with what an expression is measured in, with the number of a component.

    Parameters
    ----------
    measure
        What it is measured in; of a vector a tuple.
    unit
        SI unit that is needed, empty for any.
    is_vector
        Whether a vector is needed.
    """
    if isinstance(measure, tuple) != is_vector:
        yield (), f"expected {'a vector' if is_vector else 'one number'}"
        return
    for k, part in enumerate(measure if is_vector else (measure,)):
        if unit and not part.fits(unit):
            yield (k,) if is_vector else (), misfit(part, unit)


def _bounds(item: PlacedExpression, known: _Known) -> Problems:
    try:
        value = item.expression.value(known.values, NUMBERS)
    except ExpressionError as error:
        yield item.place, str(error)
        return
    unit = "" if item.unit in ("", "1") else f" {item.unit}"
    if item.above is not None and not value > item.above:
        yield item.place, f"must be greater than {item.above:g}{unit}, is {value:g}"
    if item.least is not None and not value >= item.least:
        yield item.place, f"must be at least {item.least:g}{unit}, is {value:g}"
    if item.most is not None and not value <= item.most:
        yield item.place, f"must be at most {item.most:g}{unit}, is {value:g}"
    if item.place[0] == "initial" or item.place[-1] in ("start", "start_rate"):
        yield from _vague_start(item, float(value))


def _vague_start(item: PlacedExpression, value: float) -> Problems:
    """Yield that numbers so large are too far apart to say where a motion starts."""
    apart = math.ulp(value)
    if apart > COARSEST_START:
        yield (
            item.place,
            f"{value:g} {item.unit} is too large to start from: neighbouring numbers of that size "
            f"are {apart:.2g} {item.unit} apart; stay below {LARGEST_START:.2g} {item.unit}",
        )


def _initial(file: SystemFile, known: _Known) -> Problems:
    for name, expression in file.initial.items():
        place = ("initial", name)
        rate = name not in known.coordinates and name.endswith("_rate")
        coordinate = known.coordinates.get(name.removesuffix("_rate") if rate else name)
        if coordinate is None:
            names = [*known.coordinates, *(f"{n}_rate" for n in known.coordinates)]
            yield place, unknown_name("coordinate", name, names)
            continue
        if coordinate.name in known.driven:
            yield place, f"'{coordinate.name}' is driven; its law says where it starts"
        unit = f"{coordinate.unit}/s" if rate else coordinate.unit
        found = PlacedExpression(place, expression, unit, False, "", None, None, "m", ())
        yield from _expression(found, known)


def _drives(file: SystemFile, known: _Known) -> Problems:
    owners: dict[str, str] = {}
    for name, drive in file.drives.items():
        place = ("drives", name, "coordinate")
        if drive.coordinate in owners:
            yield place, f"'{drive.coordinate}' is driven by '{owners[drive.coordinate]}' already"
        owners.setdefault(drive.coordinate, name)
        coordinate = known.coordinates.get(drive.coordinate)
        if coordinate is not None and coordinate.role in ("independent", "dependent"):
            yield place, f"'{drive.coordinate}' is declared {coordinate.role} and cannot be driven"


def _switches(file: SystemFile, known: _Known) -> Problems:
    for name, start in file.switches.items():
        place = ("switches", name)
        if name in known.coordinates or name in known.parameters.declared:
            yield place, f"'{name}' is also a coordinate or parameter; take another name"
        yield from _expression(
            PlacedExpression(place, start, "1", False, "", None, None, "m", ()), known
        )


def _events(file: SystemFile, known: _Known) -> Problems:
    for name, event in file.events.items():
        place, points = ("events", name), tuple(event.points)
        for point in points:
            if point in known.parameters.declared or point in known.coordinates:
                yield (*place, "points", point), f"'{point}' is also a parameter or coordinate"
        if event.restitution is not None:
            yield from _rebound(place, event, known)
        for key, expression in event.reset.items():
            here = (*place, "reset", key)
            coordinate = known.coordinates.get(key) or known.coordinates.get(
                key.removesuffix("_rate")
            )
            if key in known.switches:
                unit = "1"
            elif coordinate is None:
                rates = [f"{n}_rate" for n in known.coordinates]
                names = [*rates, *known.coordinates, *known.switches]
                yield here, unknown_name("rate, coordinate or switch", key, names)
                continue
            elif coordinate.name in known.driven or coordinate.role == "driven":
                yield here, f"'{coordinate.name}' is driven; its law alone moves it"
                continue
            elif key == coordinate.name and coordinate.role == "dependent":
                yield here, f"'{key}' is determined by the loops; reset independent coordinates"
                continue
            else:
                is_rate = key != coordinate.name
                unit = f"{coordinate.unit}/s" if is_rate else coordinate.unit
            item = PlacedExpression(here, expression, unit, False, "event", None, None, "m", points)
            yield from _expression(item, known)


def _rebound(place: Place, event: EventSet, known: _Known) -> Problems:
    """Yield what keeps the function of an event from going back after an impact."""
    names = set(known.variables.of("event", "m", event.points))
    names -= set(known.variables.of("geometry", "m", event.points))
    used = sorted(n for n in names if _uses(event.when, n))
    if used:
        words = "a restitution needs 'when' to be one of coordinates, points and time"
        yield (*place, "when"), f"{words}, not of '{used[0]}'"


def _uses(expression: Expression, name: str) -> bool:
    return any(n == name or n.startswith(f"{name}.") for n in expression.names)


def _constraint_forces(file: SystemFile) -> Problems:
    for name, sensor in file.sensors.items():
        constraint, place = getattr(sensor, "constraint", ""), ("sensors", name)
        acting = file.cuts.get(constraint) or file.constraints.get(constraint)
        if acting is None or not hasattr(sensor, "body"):
            continue
        bodies = [b for b in _acted_on(acting) if b != GROUND]
        if not bodies:
            words = "acts on coordinates, not on bodies; its own channels show its forces"
            yield (*place, "constraint"), f"'{constraint}' {words}"
        elif sensor.body not in bodies:
            listed = ", ".join(f"'{b}'" for b in bodies)
            yield (*place, "body"), f"'{constraint}' acts on {listed}"


def _acted_on(item: ParameterSet) -> list[str]:
    """Return the bodies that a cut or constraint of a file acts on directly."""
    places = [getattr(item, end, None) for end in ("a", "b")]
    places += getattr(item, "points", {}).values()
    bodies = [place.body for place in places if isinstance(place, PointOfBody)]
    own = getattr(item, "body", None)
    return list(dict.fromkeys([*bodies, own] if own else bodies))
