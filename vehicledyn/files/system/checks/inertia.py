"""Checks of inertias: moments that a body can have, and something that resists each motion."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator

from vehicledyn.base.problems import Place
from vehicledyn.files.expressions.algebra import NUMBERS, ExpressionError
from vehicledyn.files.expressions.parameters import Parameters
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.sets import BodySet, SystemFile

Problems = Iterator[tuple[Place, str]]
_ROUNDING = 1e-9


def inertia_problems(
    file: SystemFile, parameters: Parameters, driven: set[str], carriers: Collection[str] = ()
) -> Problems:
    """Yield what is wrong with the inertias of bodies, with places.

    Parameters
    ----------
    file
        The file, repetition and mirror images carried out.
    parameters
        The parameters, those without mistakes.
    driven
        Names of the coordinates that drives move.
    carriers
        Names of the bodies that bodies of elements hang on.
    """
    yield from _inertias(file, parameters)
    yield from _spins(file)
    yield from _massless_ends(file, parameters, driven, carriers)


def _inertias(file: SystemFile, parameters: Parameters) -> Problems:
    for name, body in file.bodies.items():
        if body.inertia is None:
            continue
        try:
            values = [float(e.value(parameters.values, NUMBERS)) for e in body.inertia]
        except (ExpressionError, TypeError):
            continue
        largest, total = max(values[:3]), sum(values[:3])
        excused = body.apparent_inertia or total - largest <= _ROUNDING * largest
        place = ("bodies", name, "inertia")
        if min(values[:3]) < 0.0:
            yield place, "no moment of inertia may be negative"
        elif not any(values[3:]) and not excused and 2.0 * largest > total * (1.0 + _ROUNDING):
            yield (
                place,
                f"the moments {', '.join(f'{v:g}' for v in values[:3])} kg m² break the triangle "
                "inequality: the largest exceeds the sum of the other two; where they were "
                "identified or hold motors and gears, say 'apparent_inertia: true'",
            )


def _spins(file: SystemFile) -> Problems:
    for name, body in file.bodies.items():
        axis = body.spins_about
        last = body.joints[-1].coordinates(name) if body.joints else []
        if axis is not None and (not last or last[-1].type.turns_about != axis):
            yield ("bodies", name, "spins_about"), f"its last joint must be R{axis}"
        parent = file.bodies.get(body.parent)
        if parent is not None and parent.spins_about is not None:
            words = "whose axes do not spin with it (spins_about); hang it on the body before"
            yield ("bodies", name, "parent"), f"hangs on '{body.parent}', {words}"


def _massless_ends(
    file: SystemFile, parameters: Parameters, driven: set[str], carriers: Collection[str]
) -> Problems:
    """Yield bodies at the end of a chain that can move but resist with no inertia."""
    named = _named(str(item) for item in (*file.cuts.values(), *file.constraints.values()))
    held = _holding(file, named, carriers)
    for name, body in file.bodies.items():
        moving = [c for c in body.coordinates(name) if c.name not in driven and c.role != "driven"]
        if not moving or name in held or _mentioned(name, body, named):
            continue
        last = moving[-1]
        if last.reflected_inertia is not None:
            continue
        if body.mass is None:
            hanging = any(other.parent == name for other in file.bodies.values())
            what = "nothing with mass" if hanging else "nothing"
            words = f"has no mass and {what} hangs on it: nothing resists '{last.name}'"
            yield ("bodies", name), f"{words}; give it a mass, or drive or drop the coordinate"
        elif last == body.coordinates(name)[-1] and _turns_freely(body, last, parameters):
            words = f"has no inertia about its last axis: nothing resists '{last.name}'"
            yield ("bodies", name), f"{words}; give it an inertia, or drive or drop the coordinate"


def _holding(file: SystemFile, named: set[str], carriers: Collection[str]) -> set[str]:
    """Return the bodies that carry one that has mass, is part of a loop or could move itself."""
    holding: set[str] = set()
    for name in carriers:
        carrier = name
        while carrier in file.bodies and carrier not in holding:
            holding.add(carrier)
            carrier = file.bodies[carrier].parent
    for name, body in file.bodies.items():
        alone = body.mass is None and not _mentioned(name, body, named)
        if alone and not body.coordinates(name):
            continue
        carrier = body.parent
        while carrier in file.bodies and carrier not in holding:
            holding.add(carrier)
            carrier = file.bodies[carrier].parent
    return holding


def _mentioned(name: str, body: BodySet, named: set[str]) -> bool:
    """Return whether cuts or constraints name a body or one of its coordinates."""
    return name in named or any(c.name in named for c in body.coordinates(name))


def _named(texts: Iterable[str]) -> set[str]:
    """Return what texts may name: their dotted words and each run of the pieces of these."""
    found: set[str] = set()
    for word in {word for text in texts for word in re.findall(r"\w+(?:\.\w+)*", text)}:
        pieces = word.split(".")
        ends = range(1, len(pieces) + 1)
        found |= {".".join(pieces[start:end]) for end in ends for start in range(end)}
    return found


def _turns_freely(body: BodySet, last: Coordinate, parameters: Parameters) -> bool:
    """Return whether a body has no inertia about the axis of its last joint, a turn."""
    turning = last.type.turns_about
    if turning is None or not body.joints[-1].coordinates("b"):
        return False
    axis = turning - 1
    about = () if body.inertia is None else body.inertia[axis : axis + 1]
    try:
        com = body.com.value(parameters.values, NUMBERS)
        inertias = [e.value(parameters.values, NUMBERS) for e in about]
    except ExpressionError:
        return False
    if not isinstance(com, tuple):
        return False
    return not any(inertias) and not any(c for k, c in enumerate(com) if k != axis)
