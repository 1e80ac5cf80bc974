"""What is wrong in a study: gathered with places in its file, or in arguments, reported at once."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.problems import Place, Problem, dotted, is_count, refusal
from vehicledyn.base.units import is_bare, is_pure, missing_unit, to_si
from vehicledyn.base.yaml import Document
from vehicledyn.files.scenario.sources import Sources


@dataclass
class Mistakes:
    """Problems of a study so far; ``document`` is None for a study that is no file."""

    document: Document | None = None
    problems: list[Problem] = field(default_factory=list)

    def wrong(self, place: Place, words: str, *, at_key: bool = False) -> None:
        """Note a problem at a place, or at the nearest one around it that the file has."""
        found = self.problem(place, words, at_key=at_key)
        if found not in self.problems:
            self.problems.append(found)

    def problem(self, place: Place, words: str, *, at_key: bool = False) -> Problem:
        """Return a problem at a place, which is not noted."""
        if self.document is None:
            return Problem("", None, dotted(place), words)
        found = Sources(self.document).problem(place, words, at_key=at_key)
        return found if place else found._replace(field="file")

    def check_keys(self, place: Place, item: Iterable[str], keys: Collection[str]) -> None:
        """Note keys of a mapping that mean nothing."""
        for key in item:
            if key not in keys:
                guess = nearest_name(str(key), keys)
                hint = f"did you mean '{guess}'? Known" if guess else "known"
                words = f"unknown key; {hint}: {', '.join(keys)}"
                self.wrong((*place, key), words, at_key=True)

    def number(self, place: Place, value: object, unit: str) -> float:
        """Return a quantity of the study in SI; not a number, and a problem, if it has no size."""
        if self.document is not None and is_bare(value) and not is_pure(unit):
            self.wrong(place, missing_unit(value, unit))
            return math.nan
        try:
            found = to_si(value, unit)
        except InputError as error:
            self.wrong(place, str(error))
            return math.nan
        if math.isfinite(found):
            return found
        self.wrong(place, "expected a finite number")
        return math.nan

    @contextmanager
    def at(self, *place: str | int) -> Iterator[None]:
        """Note errors of the block as problems at a place, and go on behind it."""
        try:
            yield
        except InputError as error:
            for line in str(error).splitlines():
                if not is_count(line):
                    self.wrong(place, line)

    def refuse(self) -> None:
        """Raise InputError if anything is wrong."""
        if not self.problems:
            return
        if self.document is None:
            raise InputError("\n".join(map(str, self.problems)))
        raise refusal(self.problems, self.document.name)


def silent(text: str, fraction: float | None = None) -> None:
    """Report nothing."""
