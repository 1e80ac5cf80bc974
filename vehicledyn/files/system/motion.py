"""Motions that a scenario prescribes for the coordinates of a system: laws and expressions."""

from __future__ import annotations

from collections import ChainMap
from typing import Any

from pydantic import ValidationError

from vehicledyn.base.errors import unknown_name
from vehicledyn.base.parameters import read_part
from vehicledyn.base.problems import Place
from vehicledyn.base.validation_messages import words_of
from vehicledyn.files.expressions.algebra import ExpressionError
from vehicledyn.files.expressions.dimensions import MEASURES
from vehicledyn.files.expressions.parameters import Parameters
from vehicledyn.files.system.checks.references import unfit
from vehicledyn.files.system.checks.variables import Variables
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.laws import TimeLaw
from vehicledyn.files.system.sets import DriveSet, SystemFile
from vehicledyn.files.system.walk import NameUse, walk

Problems = list[tuple[Place, str]]


def read_motion(
    given: Any, coordinates: dict[str, Coordinate], parameters: Parameters
) -> tuple[dict[str, TimeLaw], Problems]:
    """Return the law of each coordinate, and what is wrong with those that have none.

    Parameters
    ----------
    given
        The section "motion" of a scenario: a law or an expression of time by coordinate; a text
        names a table and gives no law.
    coordinates, parameters
        Those of the system.
    """
    laws: dict[str, TimeLaw] = {}
    problems: Problems = []
    variables = Variables(coordinates)
    for name, item in given.items() if isinstance(given, dict) else ():
        place: Place = ("motion", name)
        if name not in coordinates:
            problems.append((place, unknown_name("coordinate", str(name), coordinates)))
            continue
        law, wrong = _law(item)
        problems += [((*place, *below), words) for below, words in wrong]
        if law is not None:
            found = _wrong_units(name, law, coordinates, variables, parameters)
            problems += [(place, words) for words in found]
            laws[name] = law
    return laws, problems


def _law(item: Any) -> tuple[TimeLaw | None, Problems]:
    written = item if isinstance(item, dict) else {"kind": "expression", "position": item}
    try:
        law = read_part("time_law", written)
    except ValidationError as error:
        return None, [
            (tuple(line["loc"]) if isinstance(item, dict) else (), words_of(line))
            for line in error.errors()
        ]
    return (law, []) if isinstance(law, TimeLaw) else (None, [((), "is no law of time")])


def _wrong_units(
    name: str,
    law: TimeLaw,
    coordinates: dict[str, Coordinate],
    variables: Variables,
    parameters: Parameters,
) -> list[str]:
    file = SystemFile(title="", drives={"motion": DriveSet(coordinate=name, law=law)})
    problems = []
    for item in walk(file, coordinates):
        if isinstance(item, NameUse) or item.place[0] != "drives":
            continue
        extra = variables.of(item.variables, item.length, item.points)
        try:
            found = item.expression.value(ChainMap(extra, parameters.measures), MEASURES)
        except ExpressionError as error:
            problems.append(str(error))
            continue
        problems += [words for _, words in unfit(found, item.unit, is_vector=item.is_vector)]
    return problems
