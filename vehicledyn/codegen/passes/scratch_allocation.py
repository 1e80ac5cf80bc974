"""Places for what calls in loops give to each other, in the array of a function.

A long chain fills more than the fastest cache with its numbers. What is written counts twice
there, so results that nothing else needs are put where they belong at once, sines and cosines
are computed in their places, and a place is used again as soon as nothing waits for its values.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

from vehicledyn.codegen.ir.instructions import SHARED
from vehicledyn.codegen.passes.lowering import Lowered, is_at_hand
from vehicledyn.codegen.passes.scheduling import Pack, computed_by, operands_of

ROOM = "s"
"""The array that holds what calls give to each other."""

PACK = 4
"""Reals in a vd_pack of real.h: elementary functions fill multiples of it."""

_AT_ONCE = 32
"""Calls of an elementary function whose arguments are laid out together."""


@dataclass(frozen=True)
class Groups:
    """Numbers that lie alike in an array in all calls: (group, offset) of each number.

    ``arrays`` are those that the groups lie in, ``starts`` the place of each group by call, None
    where a call finds its numbers elsewhere.
    """

    places: list[tuple[int, int]]
    arrays: list[str]
    starts: list[list[int] | None]


@dataclass
class Held:
    """Places of values in the array of a function, and how many it has.

    ``results`` are the values that calls put in their places; others are stored there. ``done``
    are results of the function that calls put where they belong. ``packs`` gives the first places
    of the results of the elementary functions that are computed in place, by their first value.
    """

    place: dict[int, int] = field(default_factory=dict)
    results: set[int] = field(default_factory=set)
    done: set[int | None] = field(default_factory=set)
    packs: dict[int, list[int]] = field(default_factory=dict)
    size: int = 0

    def fill(self, results: Iterable[tuple[int | None, int]]) -> list[int]:
        """Take results with their places, and return those that are there."""
        used = {value: place for value, place in results if value is not None}
        self.place |= used
        self.results |= set(used)
        return list(used)


def find_room(lowered: Lowered, arrays: dict[int, list[str]]) -> tuple[Held, dict[int, Groups]]:
    """Give a place to all that calls in loops share, and return where their results go.

    Results that are needed by the same functions lie side by side. A place is used again once
    nothing waits for its values.

    Parameters
    ----------
    lowered
        The function.
    arrays
        The arrays that hold the arguments of each shared function that is called in loops.
    """
    uses, held, room = _Uses.of(lowered, arrays), Held(), _Room()
    for value in sorted(uses.given):
        if is_at_hand(lowered.values[value]):
            held.place[value] = room.take(1)
    layouts = {number: uses.layout(lowered, number) for number in arrays}
    starts: dict[int, list[list[int] | None]] = defaultdict(list)
    ending: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for number, step in enumerate(lowered.steps):
        if isinstance(step, Pack) and step.shared in layouts:
            for values in step.values:
                places = layouts[step.shared].placed(values, uses, held, room)
                starts[step.shared].append([place.start for place in places])
                for place in places:
                    if place.size:
                        ending[max(place.last, number)].append((place.start, place.size))
            for start, size in ending[number]:
                room.give_back(start, size)
            continue
        if isinstance(step, Pack) and _fills_room(step, uses):
            _place_pack(step, held, room)
        for value in computed_by(step):
            if value in uses.given and value not in held.place:
                held.place[value] = room.take(1)
    held.size = room.size
    found = {n: Groups(item.places, item.arrays, starts[n]) for n, item in layouts.items()}
    return held, found


def _fills_room(pack: Pack, uses: _Uses) -> bool:
    """Return whether calls in loops need results of many calls of an elementary function."""
    return (
        pack.function != SHARED
        and len(pack.values) >= PACK
        and sum(value in uses.given for value in pack.computed) >= len(pack.values)
    )


def _place_pack(pack: Pack, held: Held, room: _Room) -> None:
    """Put the results of an elementary function side by side, each of its results for itself."""
    firsts = []
    for column in zip(*pack.values, strict=True):
        start = room.take(-(-len(column) // PACK) * PACK)
        firsts.append(start)
        held.fill((value, start + k) for k, value in enumerate(column))
    held.packs[pack.computed[0]] = firsts


def parts_of(pack: Pack) -> list[Pack]:
    """Return calls of an elementary function in packs whose arguments stay in the cache."""
    pairs = [
        (pack.operands[k : k + _AT_ONCE], pack.values[k : k + _AT_ONCE])
        for k in range(0, len(pack.operands), _AT_ONCE)
    ]
    return [Pack(pack.function, operands, values) for operands, values in pairs]


@dataclass(frozen=True)
class _Layout:
    """Results of a shared function in groups, and the array that each group lies in."""

    groups: list[list[int]]
    arrays: list[str]

    @property
    def places(self) -> list[tuple[int, int]]:
        """Group of each result and its place there."""
        found = {k: (g, at) for g, group in enumerate(self.groups) for at, k in enumerate(group)}
        return [found[k] for k in range(len(found))]

    def placed(
        self, values: tuple[int | None, ...], uses: _Uses, held: Held, room: _Room
    ) -> list[_Placed]:
        """Put the values of a call in their places and return where each group is."""
        found = []
        for group, array in zip(self.groups, self.arrays, strict=True):
            if array != ROOM:
                (value,) = (values[k] for k in group)
                held.done.add(value)
                found.append(_Placed(uses.result[value][1]))
                continue
            start = room.take(len(group))
            used = held.fill((values[k], start + place) for place, k in enumerate(group))
            last = max((uses.last.get(value, -1) for value in used), default=-1)
            found.append(_Placed(start, len(group), last))
        return found


class _Placed(NamedTuple):
    """Where a group begins, the places it takes, and the last step that needs them."""

    start: int
    size: int = 0
    last: int = -1


@dataclass(frozen=True)
class _Uses:
    """Who uses values: ``given`` are those that calls in loops take from the array of a function.

    ``users`` are the shared functions that use a value, -1 for all else; ``last`` is the last step
    that does. ``result`` gives output and element of values that are one result and nothing else.
    """

    given: set[int]
    users: dict[int, set[int]]
    last: dict[int, int]
    result: dict[int | None, tuple[int, int]]

    @classmethod
    def of(cls, lowered: Lowered, arrays: dict[int, list[str]]) -> _Uses:
        uses = cls(set(), defaultdict(set), {}, {})
        for number, step in enumerate(lowered.steps):
            calls, user = [tuple(operands_of(lowered.values, step))], -1
            if isinstance(step, Pack) and step.shared in arrays:
                calls, user = step.operands, step.shared
            for call in calls:
                for k, value in enumerate(call):
                    uses.users[value].add(user)
                    uses.last[value] = number
                    if user >= 0 and arrays[user][k] == ROOM:
                        uses.given.add(value)
        times = Counter(value for _, _, value in lowered.results)
        for output, element, value in lowered.results:
            if times[value] == 1 and value not in uses.users:
                uses.result[value] = (output, element)
        for value in times:
            uses.users[value].add(-1)
            uses.last[value] = len(lowered.steps)
        return uses

    def layout(self, lowered: Lowered, shared: int) -> _Layout:
        """Return the results of a shared function in groups that the same functions need.

        One that is in all calls a result and nothing else stands alone, in the result's array.
        """
        packs = [s for s in lowered.steps if isinstance(s, Pack) and s.shared == shared]
        calls = [values for pack in packs for values in pack.values]
        groups: dict[object, list[int]] = {}
        arrays: dict[object, str] = {}
        for k, column in enumerate(zip(*calls, strict=True)):
            outputs = {self.result[v][0] if v in self.result else -1 for v in column}
            output = outputs.pop() if len(outputs) == 1 else -1
            users = [self.users.get(value, set()) for value in column if value is not None]
            key = frozenset().union(*users) if output < 0 else k
            groups.setdefault(key, []).append(k)
            arrays[key] = ROOM if output < 0 else f"r{output}"
        return _Layout(list(groups.values()), [arrays[key] for key in groups])


class _Room:
    """Places in an array, given out and taken back."""

    def __init__(self) -> None:
        self.size = 0
        self._free: list[tuple[int, int]] = []

    def take(self, count: int) -> int:
        """Return the first of so many places side by side.

        Those that were given back last are in the cache still, those of the same number fit.
        """
        fitting = [k for k, (_, size) in enumerate(self._free) if size >= count]
        if not fitting:
            self.size += count
            return self.size - count
        best = min(fitting, key=lambda k: (self._free[k][1] != count, -k))
        start, size = self._free.pop(best)
        if size > count:
            self.give_back(start + count, size - count)
        return start

    def give_back(self, start: int, count: int) -> None:
        """Let places be taken again."""
        self._free.append((start, count))
