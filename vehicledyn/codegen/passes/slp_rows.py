"""Find values that are computed alike in four places, such as the corners of a car.

Generated code of one case carries them side by side in the registers of the processor. Places
that are alike are not marked in the equations, they are found in the graph of the operations:
values whose neighbourhoods look the same begin a row, and rows grow from there, through operands
and users, as far as the four places agree. Each value keeps its operation and its rounding.

References
----------
Larsen, Amarasinghe (2000), Exploiting superword level parallelism with multimedia instruction
sets, PLDI, pages 145-156: the idea of packs that grow along operands and users.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from vehicledyn.codegen.ir.instructions import (
    CELL,
    CONST,
    ENTRY,
    INPUT,
    KNOT,
    RESULT,
    SHARED,
    Instruction,
)
from vehicledyn.codegen.passes.neighbourhoods import Neighbourhoods, first_colours

PLACES = 4
"""Places of a row: the doubles of a register of AVX2."""

_RADIUS, _FIRST_LOOK = 5, 3
"""How far neighbourhoods are compared, and how far at first."""

_WORTH = 0.05
"""Share of the values whose neighbourhood occurs four times that makes rows worth a search."""

_KINDS = {"SUB": "ADD", "FMS": "FMA", "FNMA": "FMA", "FNMS": "FMA"}
"""Operations that are others with signs."""

_SIGNS = {
    **{"ADD": (1, 1), "SUB": (1, -1)},
    **{"FMA": (1, 1), "FMS": (1, -1), "FNMA": (-1, 1), "FNMS": (-1, -1)},
}
"""Signs of the two terms of a sum; the first term of a fused one is a product."""

_TURNABLE = frozenset({"ADD", "MUL", "FMA"})
"""Kinds of operations whose first two operands may change places."""

_APART = frozenset({INPUT, CONST, SHARED, RESULT, CELL, KNOT, ENTRY})
_SLOW = frozenset({"DIV", "INV", "SQRT"})
_SAVED, _SAVED_IF_SLOW, _GATHER, _TAKE, _LOAD = 3.0, 9.0, 3.0, 0.7, 0.3
"""What a row saves and costs, in operations: its own, collecting operands, taking one value out,
and loading operands that lie side by side."""


_SWEEPS = 6
"""How often rows at the border are looked at again."""


@dataclass(frozen=True)
class PackedRow:
    """An operation in several places: its values, and the operands by their position.

    ``operation`` is "ADD" or "FMA" for all sums; ``signs`` are those of their two terms by place.
    """

    operation: str
    values: tuple[int, ...]
    operands: list[tuple[int, ...]]
    signs: list[tuple[int, ...]]

    @property
    def computed(self) -> list[int]:
        """The values that the row computes."""
        return list(self.values)


def find_rows(
    values: Sequence[Instruction],
    results: Iterable[tuple[int, int, int]],
    *,
    needed: Sequence[bool],
    level: Sequence[int],
    called: Iterable[str],
) -> list[PackedRow]:
    """Return rows of values that no result needs before another.

    Parameters
    ----------
    values
        Instructions in an order of computation.
    results
        (output, element, value) of each result.
    needed
        Whether any result needs a value.
    level
        How many calls of functions in turn precede a value; those of a row agree.
    called
        Operations that are calls of functions.
    """
    finder = _Finder(values, needed, level)
    if not finder.is_worth_it():
        return []
    finder.search()
    taken = {value for _, _, value in results}
    return _profitable(values, needed, finder.rows(), taken, frozenset(called))


class _Finder:
    """Grows rows from values that look alike."""

    def __init__(
        self, values: Sequence[Instruction], needed: Sequence[bool], level: Sequence[int]
    ) -> None:
        self._values, self._needed, self._level = values, needed, level
        self._kinds = [_KINDS.get(item.operation, item.operation) for item in values]
        self._may_stand = [
            is_needed and item.operation not in _APART
            for is_needed, item in zip(needed, values, strict=True)
        ]
        self._candidates = [index for index, may in enumerate(self._may_stand) if may]
        self._users: list[list[int]] = [[] for _ in values]
        for index, item in enumerate(values):
            if needed[index]:
                for operand in set(item.operands):
                    self._users[operand].append(index)
        self._neighbours = Neighbourhoods(
            [item.operands for item in values],
            [kind in _TURNABLE for kind in self._kinds],
            self._users,
        )
        self._last = first_colours([self._look(index) for index in range(len(values))])
        self._colours: list[list[int]] = [self._last.tolist()]
        self._rows: list[tuple[int, ...]] = []
        self._place: dict[int, tuple[int, int]] = {}

    def is_worth_it(self) -> bool:
        """Return whether enough values have a neighbourhood that occurs once a place."""
        for _ in range(_FIRST_LOOK):
            self._look_further()
        counts = Counter(self._colours[-1][k] for k in self._candidates)
        fitting = sum(count for count in counts.values() if count == PLACES)
        return fitting > 0 and fitting >= _WORTH * sum(counts.values())

    def search(self) -> None:
        """Begin rows with the values that are most surely alike, and let them grow."""
        while len(self._colours) <= _RADIUS:
            self._look_further()
        for colours in reversed(self._colours[2:]):
            classes: dict[int, list[int]] = defaultdict(list)
            for index in self._candidates:
                classes[colours[index]].append(index)
            for members in classes.values():
                if len(members) == PLACES:
                    self._grow(tuple(members))

    def rows(self) -> list[PackedRow]:
        """Return the rows found, their operands in order."""
        return [self._row(members) for members in self._rows]

    # -- neighbourhoods ----------------------------------------------------------------------

    def _look(self, index: int) -> object:
        """Return what a value looks like by itself."""
        item = self._values[index]
        if item.operation == INPUT:
            return (INPUT, item.source[0])
        if item.operation == CONST:
            return (CONST, abs(item.number))
        return (self._kinds[index], self._level[index])

    def _look_further(self) -> None:
        """Colour each value by its own colour and those of its operands and users."""
        self._last = self._neighbours.further(self._last)
        self._colours.append(self._last.tolist())

    def _alike_to(self, first: int, second: int) -> int:
        """Return how far the neighbourhoods of two values agree."""
        for reach in range(len(self._colours) - 1, -1, -1):
            if self._colours[reach][first] == self._colours[reach][second]:
                return reach + 1
        return 0

    # -- growth ------------------------------------------------------------------------------

    def _grow(self, members: tuple[int, ...]) -> None:
        queue = [members] if self._begin(members) else []
        for row in queue:
            for operands in zip(*[item[0] for item in self._aligned(row)], strict=True):
                if self._begin(operands):
                    queue.append(operands)
            queue += self._users_alike(row)

    def _begin(self, members: tuple[int, ...]) -> bool:
        if not self._may_be_row(members):
            return False
        for place, member in enumerate(members):
            self._place[member] = (len(self._rows), place)
        self._rows.append(members)
        return True

    def _may_be_row(self, members: tuple[int, ...]) -> bool:
        if len(set(members)) != PLACES:
            return False
        kind, level = self._kinds[members[0]], self._level[members[0]]
        for k in members:
            if not self._may_stand[k] or k in self._place:
                return False
            if self._kinds[k] != kind or self._level[k] != level:
                return False
        return not any(operand in members for k in members for operand in self._values[k].operands)

    def _fit(self, first: int, other: int, place: int) -> int:
        """Return how well a value of another place matches one of the first place."""
        if first == other:
            return 100
        mine, its = self._place.get(first), self._place.get(other)
        if mine is not None and its is not None:
            return 100 if mine[0] == its[0] and (mine[1], its[1]) == (0, place) else -100
        if mine is not None or its is not None:
            return -100
        if self._kinds[first] != self._kinds[other]:
            return -10
        return 1 + self._alike_to(first, other)

    def _aligned(self, members: tuple[int, ...]) -> list[tuple[list[int], tuple[int, int]]]:
        """Return operands and signs of each member, turned to match those of the first."""
        first = self._values[members[0]].operands
        found = []
        for place, member in enumerate(members):
            item = self._values[member]
            operands = list(item.operands)
            signs = _SIGNS.get(item.operation, (1, 1))
            if place and self._kinds[member] in _TURNABLE:
                straight = sum(self._fit(first[k], operands[k], place) for k in (0, 1))
                turned = sum(self._fit(first[k], operands[1 - k], place) for k in (0, 1))
                if turned > straight:
                    operands[0], operands[1] = operands[1], operands[0]
                    if self._kinds[member] == "ADD":
                        signs = (signs[1], signs[0])
            found.append((operands, signs))
        return found

    def _row(self, members: tuple[int, ...]) -> PackedRow:
        aligned = self._aligned(members)
        return PackedRow(
            self._kinds[members[0]],
            members,
            list(zip(*[operands for operands, _ in aligned], strict=True)),
            list(zip(*[signs for _, signs in aligned], strict=True)),
        )

    def _users_alike(self, members: tuple[int, ...]) -> list[tuple[int, ...]]:
        """Begin rows of users of a row that match each other, and return them."""
        users = [
            [k for k in self._users[member] if k not in self._place and self._may_stand[k]]
            for member in members
        ]
        found = []
        for first in users[0]:
            row = [first]
            for place in range(1, PLACES):
                best = self._best_user(first, members, users[place], place)
                if best is None:
                    break
                row.append(best)
            if len(row) == PLACES and self._begin(tuple(row)):
                found.append(tuple(row))
        return found

    def _best_user(
        self, first: int, members: tuple[int, ...], users: list[int], place: int
    ) -> int | None:
        """Return the user in another place that matches one of the first place, if one does."""
        best, second, found = -1, -1, None
        for user in users:
            if user in self._place or self._kinds[user] != self._kinds[first]:
                continue
            fit = self._users_fit(first, user, members[0], members[place], place)
            if fit > best:
                best, second, found = fit, best, user
            elif fit == best:
                second = fit
        return found if found is not None and best > second else None

    def _users_fit(self, first: int, other: int, mine: int, its: int, place: int) -> int:
        """Return how well two users match, beside the values of a row that they use."""
        mine_at, its_at = (
            self._values[user].operands.index(value)
            for user, value in ((first, mine), (other, its))
        )
        turnable = self._kinds[first] in _TURNABLE and mine_at < 2 and its_at < 2
        if mine_at != its_at and not turnable:
            return -1000
        if len(self._values[first].operands) != len(self._values[other].operands):
            return -1000  # calls of different functions
        rest, its_rest = (
            [operand for k, operand in enumerate(self._values[user].operands) if k != position]
            for user, position in ((first, mine_at), (other, its_at))
        )
        fits = [self._fit(a, b, place) for a, b in zip(rest, its_rest, strict=True)]
        return sum(fits) + self._alike_to(first, other)


def _profitable(
    values: Sequence[Instruction],
    needed: Sequence[bool],
    rows: list[PackedRow],
    taken: set[int],
    called: frozenset[str],
) -> list[PackedRow]:
    """Return the rows without those that the code would be better off without."""
    for _ in range(_SWEEPS):
        kept = _keep(values, needed, rows, taken, called)
        if len(kept) == len(rows):
            break
        rows = kept
    return rows


def _keep(
    values: Sequence[Instruction],
    needed: Sequence[bool],
    rows: list[PackedRow],
    taken: set[int],
    called: frozenset[str],
) -> list[PackedRow]:
    known = {row.values for row in rows}
    inside = {value for row in rows for value in row.values}
    shares = Counter(operands for row in rows for operands in row.operands)
    outside = set(taken)
    for index, item in enumerate(values):
        if needed[index] and index not in inside:
            outside.update(item.operands)
    for row in rows:
        for operands in row.operands:
            if operands not in known:
                outside.update(operands)

    def gain(row: PackedRow) -> float:
        """Return what the row saves beside single operations, at its borders too."""
        if row.operation in called:
            return 1.0
        found = _SAVED_IF_SLOW if row.operation in _SLOW else _SAVED
        found += _GATHER * min(shares[row.values], 1)
        found -= _TAKE * sum(value in outside for value in row.values)
        for operands in set(row.operands):
            if operands in known:
                found += _TAKE * sum(value not in outside for value in operands)
            elif len(set(operands)) == 1 or _are_at_hand(values, operands):
                found -= _LOAD
            else:
                found -= _GATHER / shares[operands]
        return found

    return [row for row in rows if gain(row) > 0.0]


def _are_at_hand(values: Sequence[Instruction], operands: tuple[int, ...]) -> bool:
    return all(values[k].operation in (INPUT, CONST) for k in operands)
