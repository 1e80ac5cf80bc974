"""Calls of shared functions that follow one another as loops over tables of places.

The joints of a long chain call the same few functions one after the other. Where the arguments
of a call lie side by side, the function is given their first place and nothing is copied; a row
of the function's table tells the places of each call, so a loop needs no code for each joint.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from vehicledyn.solve.instructions import INPUT
from vehicledyn.solve.lowering import Lowered, is_at_hand
from vehicledyn.solve.schedule import Pack, Step, computed_by, operands_of

_DEEP = 3
"""Calls, each waiting for the one before, that make a function worth a loop."""

ROOM = "s"
"""The array that holds what calls give to each other."""


@dataclass(frozen=True)
class Groups:
    """Numbers that lie alike in an array in all calls: (group, offset) of each number.

    ``arrays`` are those that the groups lie in, ``starts`` the place of each group by call, None
    where a call finds its numbers elsewhere.
    """

    places: list[tuple[int, int]]
    arrays: list[str]
    starts: list[list[int] | None]


@dataclass(frozen=True)
class Rolled:
    """How one shared function is called: where its arguments lie and where its results go."""

    given: Groups
    found: Groups

    @property
    def rows(self) -> list[list[int]]:
        """Places of the groups given and found, by call, those in loops only."""
        pairs = zip(self.given.starts, self.found.starts, strict=True)
        return [[*given, *(found or [])] for given, found in pairs if given is not None]


@dataclass
class Rolling:
    """The shared functions that are called in loops, and places in the array of a function.

    ``results`` are the values that calls put in their places; others are stored there.
    """

    kinds: dict[int, Rolled] = field(default_factory=dict)
    place: dict[int, int] = field(default_factory=dict)
    results: set[int] = field(default_factory=set)
    room: int = 0

    def holds(self, step: object) -> bool:
        """Return whether a step is one of calls in a loop."""
        return isinstance(step, Pack) and step.shared in self.kinds


def roll(lowered: Lowered, inputs: Sequence[str], wide: dict[int, int]) -> Rolling:
    """Return which shared functions of a program are called in loops, and how.

    Functions of ``wide``, which carry their calls side by side, are left to that.
    """
    if not is_deep(lowered):
        return Rolling()
    packs = [step for step in lowered.steps if isinstance(step, Pack) and step.shared is not None]
    chosen = [pack for pack in packs if pack.shared not in wide]
    rolling = Rolling()
    numbers = [pack.shared for pack in chosen if pack.shared is not None]
    calls: dict[int, list[tuple[int, ...]]] = {number: [] for number in numbers}
    for pack in chosen:
        calls[pack.shared or 0] += pack.operands
    arrays = {number: _arrays(lowered, inputs, rows) for number, rows in calls.items()}
    found = _place(lowered, rolling, arrays)
    for number, rows in calls.items():
        places = [
            [
                rolling.place[value] if array == ROOM else lowered.values[value].source[1]
                for value, array in zip(row, arrays[number], strict=True)
            ]
            for row in rows
        ]
        rolling.kinds[number] = Rolled(_grouped(arrays[number], places), found[number])
    return rolling


def is_deep(lowered: Lowered) -> bool:
    """Return whether calls of a shared function wait for one another, as in a chain."""
    packs = [step for step in lowered.steps if isinstance(step, Pack)]
    levels = Counter(pack.shared for pack in packs if pack.shared is not None)
    return max(levels.values(), default=0) >= _DEEP


def by_demand(lowered: Lowered) -> Lowered:
    """Return a program whose calls come when their results are needed, along one branch first.

    What a branch of a tree hands on stays in the cache so. Calls of one function that follow one
    another are one step.
    """
    steps: list[Step] = []
    for step in lowered.steps:
        if isinstance(step, Pack) and step.shared is not None:
            calls = zip(step.operands, step.values, strict=True)
            steps += [Pack(step.function, [call], [found], step.shared) for call, found in calls]
        else:
            steps.append(step)
    maker = {value: k for k, step in enumerate(steps) for value in computed_by(step)}
    order: list[int] = []
    done: set[int] = set()
    for _, _, result in lowered.results:
        stack = [maker[result]] if result in maker else []
        while stack:
            step = stack[-1]
            needed = [maker[v] for v in operands_of(lowered.values, steps[step]) if v in maker]
            missing = next((k for k in needed if k not in done), None)
            if missing is not None:
                stack.append(missing)
                continue
            stack.pop()
            if step not in done:
                done.add(step)
                order.append(step)
    return replace(lowered, steps=[steps[k] for k in order])


def _arrays(lowered: Lowered, inputs: Sequence[str], rows: list[tuple[int, ...]]) -> list[str]:
    """Return the array of each argument: an input where it is that in all calls."""
    found = []
    for column in zip(*rows, strict=True):
        items = [lowered.values[value] for value in column]
        sources = {item.source[0] if item.operation == INPUT else None for item in items}
        source = sources.pop() if len(sources) == 1 else None
        found.append(ROOM if source is None else inputs[source])
    return found


def _grouped(arrays: list[str], places: list[list[int]]) -> Groups:
    """Return the groups of numbers whose places move alike from call to call.

    A few calls may be otherwise, such as those at the ends of a chain; they have no starts.
    """
    usual = places[len(places) // 2]

    def moved(row: list[int]) -> tuple[tuple[str, int], ...]:
        pairs = zip(arrays, row, usual, strict=True)
        return tuple((array, place - here) for array, place, here in pairs)

    moves = [moved(row) for row in places]
    counts = Counter(_labels(move) for move in moves)
    common = [labels for labels, count in counts.items() if count >= len(places) / _FEW]
    labels = _labels(list(zip(*common, strict=True)))
    members: dict[int, list[int]] = defaultdict(list)
    for k, label in enumerate(labels):
        members[label].append(k)
    groups = list(members.values())
    first = [min(usual[k] for k in group) for group in groups]
    starts: list[list[int] | None] = []
    for move in moves:
        alike = all(len({move[k] for k in group}) == 1 for group in groups)
        steps = [move[group[0]][1] for group in groups]
        starts.append([a + b for a, b in zip(first, steps, strict=True)] if alike else None)
    own = {k: (g, usual[k] - first[g]) for g, group in enumerate(groups) for k in group}
    return Groups([own[k] for k in range(len(own))], [arrays[group[0]] for group in groups], starts)


_FEW = 8
"""Calls, of which one may be otherwise."""


def _labels(items: Sequence[object]) -> tuple[int, ...]:
    """Return for each item the place of the first that is equal."""
    first: dict[object, int] = {}
    return tuple(first.setdefault(item, k) for k, item in enumerate(items))


def _place(lowered: Lowered, rolling: Rolling, arrays: dict[int, list[str]]) -> dict[int, Groups]:
    """Give a place to all that calls in loops share, and return where their results go.

    Results that are needed by the same functions lie side by side. A place is used again once
    nothing waits for its values, so that all stay in the cache.
    """
    uses = _Uses.of(lowered, arrays)
    room = _Room()
    for value in sorted(uses.given):
        if is_at_hand(lowered.values[value]):
            rolling.place[value] = room.take(1)
    groups: dict[int, list[list[int]]] = {}
    starts: dict[int, list[list[int] | None]] = defaultdict(list)
    ending: dict[int, list[tuple[int, int]]] = defaultdict(list)
    for number, step in enumerate(lowered.steps):
        if not isinstance(step, Pack) or step.shared not in arrays:
            for value in computed_by(step):
                if value in uses.given:
                    rolling.place[value] = room.take(1)
            continue
        if step.shared not in groups:
            groups[step.shared] = uses.alike(lowered, step.shared)
        for values in step.values:
            firsts: list[int] = []
            starts[step.shared].append(firsts)
            for group in groups[step.shared]:
                start = room.take(len(group))
                firsts.append(start)
                known = [(values[k], start + place) for place, k in enumerate(group)]
                used = {value: place for value, place in known if value is not None}
                rolling.place |= used
                rolling.results |= set(used)
                last = max((uses.last.get(value, number) for value in used), default=number)
                ending[last].append((start, len(group)))
        for start, size in ending[number]:
            room.give_back(start, size)
    rolling.room = room.size
    found = {}
    for number, lists in groups.items():
        places = {k: (g, place) for g, group in enumerate(lists) for place, k in enumerate(group)}
        ordered = [places[k] for k in range(len(places))]
        found[number] = Groups(ordered, [ROOM] * len(lists), starts[number])
    return found


@dataclass(frozen=True)
class _Uses:
    """Who uses values: ``given`` are those that calls in loops take from the array of a function.

    ``users`` are the shared functions that use a value, -1 for all else; ``last`` is the last step
    that does.
    """

    given: set[int]
    users: dict[int, set[int]]
    last: dict[int, int]

    @classmethod
    def of(cls, lowered: Lowered, arrays: dict[int, list[str]]) -> _Uses:
        uses = cls(set(), defaultdict(set), {})
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
        for _, _, value in lowered.results:
            uses.users[value].add(-1)
            uses.last[value] = len(lowered.steps)
        return uses

    def alike(self, lowered: Lowered, shared: int) -> list[list[int]]:
        """Return the results of a shared function in groups that the same functions need."""
        packs = [s for s in lowered.steps if isinstance(s, Pack) and s.shared == shared]
        calls = [values for pack in packs for values in pack.values]
        groups: dict[frozenset[int], list[int]] = {}
        for k in range(len(calls[0])):
            columns = [values[k] for values in calls]
            users = [self.users.get(value, set()) for value in columns if value is not None]
            groups.setdefault(frozenset().union(*users), []).append(k)
        return list(groups.values())


class _Room:
    """Places in an array, given out and taken back."""

    def __init__(self) -> None:
        self.size = 0
        self._free: dict[int, list[int]] = defaultdict(list)

    def take(self, count: int) -> int:
        """Return the first of so many places side by side."""
        if self._free[count]:
            return self._free[count].pop()
        self.size += count
        return self.size - count

    def give_back(self, start: int, count: int) -> None:
        """Let places be taken again."""
        self._free[count].append(start)
