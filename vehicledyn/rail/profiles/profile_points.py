"""Points of a profile as a file has them, before anything is turned or checked."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Mark, Problem, refusal
from vehicledyn.base.units import parse_unit

MILLIMETRE = 1e-3
_INCH = 0.0254
_MICROMETRE = 1e-6

NEAREST_TAPE_CIRCLE, FURTHEST_TAPE_CIRCLE = 0.02, 0.15
"""Distances between which a tape circle lies from the back of its flange [m]."""


@dataclass
class RawPoints:
    """Points as a file has them: two coordinates and their line.

    ``unit`` is that of the lengths in metres; ``stated_unit`` is false where none is given.
    ``tape_circle`` is its distance from the back of a wheel's flange, where the file says so [m].
    """

    file: str
    first: list[float] = field(default_factory=list)
    second: list[float] = field(default_factory=list)
    lines: list[int] = field(default_factory=list)
    unit: float = MILLIMETRE
    stated_unit: bool = False
    notes: list[str] = field(default_factory=list)
    tape_circle: float | None = None

    def add(self, line: int, texts: list[str]) -> None:
        """Add a point; an InputError says which text is no number."""
        if len(texts) < 2:
            raise self.refused(line, 1, "a point needs two numbers, y and z")
        values = [self._number(line, text, k) for k, text in enumerate(texts[:2])]
        self.first.append(values[0])
        self.second.append(values[1])
        self.lines.append(line)

    def shift(self, first: float, second: float) -> None:
        """Add lengths to both coordinates."""
        self.first = [value + first for value in self.first]
        self.second = [value + second for value in self.second]

    def keep(self, numbers: Sequence[int]) -> None:
        """Keep points by their number, counted from zero, and leave out the others."""
        for name in ("first", "second", "lines"):
            values = getattr(self, name)
            setattr(self, name, [values[k] for k in numbers])

    def refused(self, line: int, column: int, message: str) -> InputError:
        """Return the error that a line of this file is."""
        return refusal([Problem(self.file, Mark(line, column), "", message)], self.file)

    def _number(self, line: int, text: str, place: int) -> float:
        value = number_of(text)
        if value is None:
            raise self.refused(line, place + 1, f"'{text}' is not a number")
        if not abs(value) < 1e9:
            raise self.refused(line, place + 1, f"'{text}' is no usable length")
        return value


def number_of(text: str) -> float | None:
    """Return the number a text is, also with the exponent of Fortran (1.5D-3); None if none."""
    try:
        return float(text.replace("D", "E").replace("d", "e"))
    except ValueError:
        return None


def take_unit(points: RawPoints, match: re.Match[str] | None) -> None:
    """Take the unit that a pattern found, unless one is stated already."""
    if match and not points.stated_unit:
        name = next(group for group in match.groups() if group).lower()
        known = {"in": _INCH, "inch": _INCH, "µm": _MICROMETRE, "μm": _MICROMETRE}
        points.unit = known[name] if name in known else parse_unit(name).factor
        points.stated_unit = True
