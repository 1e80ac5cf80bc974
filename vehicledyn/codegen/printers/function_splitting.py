"""Cut functions into pieces, and find places for the values that pieces hand on."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

from vehicledyn.codegen.passes.scheduling import Step, computed_by, operands_of
from vehicledyn.codegen.passes.slp_rows import PLACES
from vehicledyn.codegen.printers.function_body import FunctionBody


@dataclass(frozen=True)
class Places:
    """Pieces that values arise in, and places of those that others need.

    ``place`` is that in the array ``s``, which holds ``room`` values.
    """

    piece_of: dict[int, int]
    place: dict[int, int]
    room: int


def cut(body: FunctionBody, size: int) -> list[list[Step]]:
    """Return the steps in pieces of so many instructions, or one where fewer will not do."""
    pieces: list[list[Step]] = []
    filled = size
    for step in body.lowered.steps:
        if filled >= size:
            pieces.append([])
            filled = 0
        pieces[-1].append(step)
        filled += 1 if body.rolling.holds(step) else len(computed_by(step))
    return pieces


def find_places(body: FunctionBody, pieces: list[list[Step]]) -> Places:
    """Find the piece of each value, and a place for those that a later piece needs.

    A place is used again once its value is needed no more, so that all stay in the cache.
    """
    piece_of: dict[int, int] = {}
    last: dict[tuple[int, ...], int] = {}
    for number, steps in enumerate(pieces):
        for step in steps:
            for value in computed_by(step):
                piece_of[value] = number
            for value in operands_of(body.values, step):
                if piece_of.get(value, number) != number:
                    last[body.together(value)] = number
    place = dict(body.rolling.held.place)
    ending: dict[int, list[tuple[int, int]]] = defaultdict(list)
    free = _Free(body.rolling.held.size)
    for number, steps in enumerate(pieces):
        for step in steps:
            for values in dict.fromkeys(map(body.together, computed_by(step))):
                if values in last and values[0] not in place:
                    first = free.take(len(values))
                    place.update(zip(values, range(first, first + PLACES), strict=False))
                    ending[last[values]].append((first, len(values)))
        free.give(ending[number])
    return Places(piece_of, place, free.room)


class _Free:
    """Places of an array that may be used, from some place on.

    Those of whole rows begin at multiples of their length.
    """

    def __init__(self, room: int) -> None:
        self.room = room
        self._whole: list[int] = []
        self._single: list[int] = []

    def take(self, size: int) -> int:
        """Return the first of so many places."""
        if size == 1 and self._single:
            return self._single.pop()
        if not self._whole:
            self._whole.append(self.room)
            self.room += PLACES
        first = self._whole.pop()
        if size == 1:
            self._single += range(first + PLACES - 1, first, -1)
        return first

    def give(self, places: list[tuple[int, int]]) -> None:
        """Take places back, with their number."""
        for first, size in places:
            (self._single if size == 1 else self._whole).append(first)
