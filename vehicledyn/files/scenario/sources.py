"""Where each value of a scenario came from: a line of the file or an option."""

from __future__ import annotations

from dataclasses import dataclass, field

from vehicledyn.base.problems import START, Place, Problem, dotted
from vehicledyn.base.yaml import Document

_LETTERS = {0: "x", 1: "y", 2: "z"}


@dataclass
class Sources:
    """Marks of a file's values and the options that changed some of them."""

    document: Document
    options: dict[Place, str] = field(default_factory=dict)

    def override(self, place: Place, option: str) -> None:
        """Note that an option set the value at a place, whatever the file says."""
        size = len(place)
        for inner in [p for p in self.options if p[:size] == place]:
            del self.options[inner]
        self.options[place] = option

    def problem(self, place: Place, message: str, *, at_key: bool = False) -> Problem:
        """Return the problem of a value, with the nearest line or option that explains it.

        Parameters
        ----------
        place
            Place of the value; it may be missing.
        message
            What is wrong.
        at_key
            Whether to point at the key rather than at its value.
        """
        option = self._option(place)
        if option is not None:
            exact = any(self.options.get(name) == option for name in _names(place))
            return Problem(option, None, "" if exact else dotted(place), message)
        known = next(p for p in _outwards(place) if p in self.document.keys or not p)
        key = self.document.keys.get(known, START)
        value = self.document.values.get(known, START)
        at_value = known in _names(place) and not at_key and value.line == key.line
        return Problem(self.document.name, value if at_value else key, dotted(place), message)

    def _option(self, place: Place) -> str | None:
        for outer in _outwards(place):
            if outer in self.options:
                return self.options[outer]
        size = len(place)
        inner = [p for p in self.options if p[:size] == place] if place else []
        return self.options[inner[-1]] if inner else None


def _names(place: Place) -> list[Place]:
    """Return a place, and once more with the letter of a vector's component for its index."""
    last = place[-1] if place else None
    letter = _LETTERS.get(last) if isinstance(last, int) else None
    return [place, (*place[:-1], letter)] if letter else [place]


def _outwards(place: Place) -> list[Place]:
    """Return a place and all that hold it, innermost first."""
    return [*_names(place), *(place[:size] for size in range(len(place) - 1, -1, -1))]
