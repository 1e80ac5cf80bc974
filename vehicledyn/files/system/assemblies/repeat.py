"""Repetition in system files: groups of parts that are made once for each value of an index.

    repeat:
      - for: {i: {from: 1, to: 3}}
        bodies:
          rod_{i}: {parent: "rod_{i-1}", ...}

Every ``{...}`` in names and texts of the group becomes the value of what stands inside, a whole
number or one of the texts that ``for`` lists. Several indices go through all their combinations.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from vehicledyn.base.problems import Place
from vehicledyn.base.units import describe
from vehicledyn.files.expressions.algebra import NUMBERS, ExpressionError
from vehicledyn.files.expressions.expressions import read_expression
from vehicledyn.files.system.sets import Sections

MOST_COPIES = 10_000
MOST_VALUES = 1_000_000
MOST_LETTERS = 20_000_000
"""Values and letters of all texts that repetition makes, at most."""

_MOST_PROBLEMS = 1_000
_LONGEST_TEXT = 200
"""Characters of an index text at most: names are made of it, and each value carries its name."""

SECTIONS = (*Sections.model_fields, "parameters")
Index = dict[str, int | str]
_BRACES = re.compile(r"\{([^{}]*)\}")


@dataclass
class Expansion:
    """A file's data with repetition carried out.

    ``origins`` says where in the file an expanded entry stands; ``problems`` what is wrong.
    """

    data: dict[str, Any] = field(default_factory=dict)
    origins: dict[Place, Place] = field(default_factory=dict)
    problems: list[tuple[Place, str]] = field(default_factory=list)
    copies: int = 0
    values: int = 0
    letters: int = 0

    @property
    def overflows(self) -> bool:
        """Whether the file asks for more than is made."""
        return bool(self._excess)

    @property
    def _excess(self) -> str:
        for number, most, what in (
            (self.copies, MOST_COPIES, "copies"),
            (self.values, MOST_VALUES, "values"),
            (self.letters, MOST_LETTERS, "letters"),
            (len(self.problems), _MOST_PROBLEMS, "problems"),
        ):
            if number > most:
                return f"makes more than {most} {what}"
        return ""

    def place(self, place: Place) -> Place:
        """Return where in the file something of the expanded data stands."""
        for size in range(len(place), 0, -1):
            head = self.origins.get(place[:size])
            if head is not None:
                return self.place((*head, *place[size:]))
        return place

    def fill(self, target: dict[str, Any], at: Place, source: Any, place: Place) -> None:
        """Put a file's mapping into ``target``, which lies ``at`` a place of the data."""
        self._fill(target, at, source, place, {})

    def _fill(
        self, target: dict[str, Any], at: Place, source: dict[str, Any], place: Place, index: Index
    ) -> None:
        for key, value in source.items():
            here = (*place, key)
            if key == "repeat":
                for item, item_place in self._items(value, here):
                    self._repeat(target, at, item, item_place, index)
            elif key == "mirror":
                self._mirror(target, at, value, here, index)
            elif key in SECTIONS and isinstance(value, dict):
                entries = target.setdefault(key, {})
                if not isinstance(entries, dict):
                    continue
                for name, entry in value.items():
                    self._enter(entries, (*at, key), entry, (*here, name), index)
            elif not index:
                target[key] = value
            elif key != "for":
                target[key] = self._filled(value, here, index)

    def _enter(
        self, entries: dict[str, Any], at: Place, entry: Any, place: Place, index: Index
    ) -> None:
        new = self._text(str(place[-1]), place, index)
        if new in entries:
            self.problems.append((place, f"'{new}' is defined twice"))
            return
        entries[new] = self._filled(entry, place, index)
        if (*at, new) != place:
            self.origins[(*at, new)] = place

    def _repeat(
        self, target: dict[str, Any], at: Place, item: dict[str, Any], place: Place, index: Index
    ) -> None:
        known = {"for", "repeat", "mirror", *SECTIONS}
        for key in item:
            if key not in known:
                words = f"unknown key. Known: {', '.join(sorted(known))}"
                self.problems.append(((*place, key), words))
        for values in self._indices(item.get("for"), (*place, "for"), index):
            if self.overflows:
                return
            self.copies += 1
            parts = {k: v for k, v in item.items() if k in known}
            if not self.overflows:
                self._fill(target, at, parts, place, values)
            if self.overflows:
                self.problems.append((place, self._excess))
                return

    def _mirror(
        self, target: dict[str, Any], at: Place, value: Any, place: Place, index: Index
    ) -> None:
        groups = target.setdefault("mirror", [])
        if not isinstance(groups, list):
            return
        for item, item_place in self._items(value, place):
            group: dict[str, Any] = {}
            group_at = (*at, "mirror", len(groups))
            if group_at != item_place:
                self.origins[group_at] = item_place
            groups.append(group)
            self._fill(group, group_at, item, item_place, index)

    def _items(self, value: Any, place: Place) -> Iterator[tuple[dict[str, Any], Place]]:
        if not isinstance(value, list):
            self.problems.append((place, f"expected a list, found {describe(value)}"))
            return
        for number, item in enumerate(value):
            if isinstance(item, dict):
                yield item, (*place, number)
            else:
                words = f"expected a mapping, found {describe(item)}"
                self.problems.append(((*place, number), words))

    def _indices(self, value: Any, place: Place, index: Index) -> Iterator[Index]:
        if not isinstance(value, dict) or not value:
            words = "missing: indices and their values, such as {i: [1, 2, 3]}"
            self.problems.append((place, words))
            return
        choices = [self._choices(v, (*place, name), index) for name, v in value.items()]
        for values in itertools.product(*choices):
            yield {**index, **dict(zip(value, values, strict=True))}

    def _choices(self, value: Any, place: Place, index: Index) -> list[int | str]:
        if isinstance(value, list) and all(type(v) in (int, str) for v in value):
            return self._short(value, place)
        if isinstance(value, dict) and set(value) == {"from", "to"}:
            ends = [self._whole(value[key], (*place, key), index) for key in ("from", "to")]
            return list(range(ends[0], min(ends[1] + 1, ends[0] + MOST_COPIES + 1)))
        words = "expected a list of whole numbers or texts, or {from: 1, to: 3}"
        self.problems.append((place, words))
        return []

    def _short(self, values: list[int | str], place: Place) -> list[int | str]:
        """Return the values of an index whose texts are short enough to be part of names."""
        short = []
        for number, value in enumerate(values):
            if isinstance(value, str) and len(value) > _LONGEST_TEXT:
                words = f"a text of {len(value)} characters; names take {_LONGEST_TEXT} of an index"
                self.problems.append(((*place, number), words))
            else:
                short.append(value)
        return short

    def _whole(self, value: Any, place: Place, index: Index) -> int:
        filled = self._filled(value, place, index)
        if isinstance(filled, str) and re.fullmatch(r"-?\d+", filled):
            filled = int(filled)
        if type(filled) is int:
            return filled
        self.problems.append((place, f"expected a whole number, found {describe(filled)}"))
        return 0

    def _filled(self, value: Any, place: Place, index: Index) -> Any:
        self.values += bool(index)
        if self.overflows:
            return None
        if isinstance(value, dict):
            return {
                self._text(k, (*place, k), index): self._filled(v, (*place, k), index)
                for k, v in value.items()
            }
        if isinstance(value, list):
            return [self._filled(v, (*place, n), index) for n, v in enumerate(value)]
        return self._text(value, place, index) if isinstance(value, str) else value

    def _text(self, text: str, place: Place, index: Index) -> str:
        if not index:
            return text

        def worth(match: re.Match[str]) -> str:
            inside = match[1].strip()
            if isinstance(index.get(inside), str):
                return str(index[inside])
            numbers = {k: float(v) for k, v in index.items() if isinstance(v, int)}
            try:
                found = read_expression(inside).value(numbers, NUMBERS)
                if isinstance(found, tuple) or found != int(found):
                    raise ExpressionError("no whole number")
            except (ExpressionError, OverflowError) as error:
                self.problems.append((place, f"'{{{inside}}}': {error}"))
                return "0"
            return str(int(found))

        filled = _BRACES.sub(worth, text)
        self.letters += len(filled)
        return filled


def expand(data: dict[str, Any]) -> Expansion:
    """Return a file's data with all repetition carried out."""
    expansion = Expansion()
    expansion.fill(expansion.data, (), data, ())
    return expansion
