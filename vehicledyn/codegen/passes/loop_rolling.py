"""Calls of shared functions that follow one another as loops over tables of places.

The joints of a long chain call the same few functions one after the other. Where the arguments
of a call lie side by side, the function is given their first place and nothing is copied; a row
of the function's table gives the places of each call, so a loop needs no code for each joint.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from vehicledyn.codegen.ir.instructions import INPUT
from vehicledyn.codegen.passes.lowering import Lowered
from vehicledyn.codegen.passes.scheduling import Pack, Step, computed_by, operands_of
from vehicledyn.codegen.passes.scratch_allocation import ROOM, Groups, Held, find_room, parts_of

_DEEP = 3
"""Calls, each waiting for the one before, that make a function worth a loop."""


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
    """The shared functions that are called in loops, and places in the array of a function."""

    kinds: dict[int, Rolled] = field(default_factory=dict)
    held: Held = field(default_factory=Held)

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
    rolling.held, found = find_room(lowered, arrays)
    for number, rows in calls.items():
        places = [
            [
                rolling.held.place[value] if array == ROOM else lowered.values[value].source[1]
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

    What a branch of a tree hands on stays in the cache so. Calls of an elementary function
    come in packs of a few.
    """
    steps: list[Step] = []
    for step in lowered.steps:
        if isinstance(step, Pack) and step.shared is not None:
            calls = zip(step.operands, step.values, strict=True)
            steps += [Pack(step.function, [call], [found], step.shared) for call, found in calls]
        else:
            steps += parts_of(step) if isinstance(step, Pack) else [step]
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
    groups = [part for group in members.values() for part in _near(group, usual)]
    first = [min(usual[k] for k in group) for group in groups]
    starts: list[list[int] | None] = []
    for move in moves:
        alike = all(len({move[k] for k in group}) == 1 for group in groups)
        steps = [move[group[0]][1] for group in groups]
        starts.append([a + b for a, b in zip(first, steps, strict=True)] if alike else None)
    own = {k: (g, usual[k] - first[g]) for g, group in enumerate(groups) for k in group}
    return Groups([own[k] for k in range(len(own))], [arrays[group[0]] for group in groups], starts)


def _near(group: list[int], places: list[int]) -> list[list[int]]:
    """Return numbers that lie alike parted where their places are far from each other."""
    parts: list[list[int]] = []
    for k in sorted(group, key=lambda k: places[k]):
        if not parts or places[k] > places[parts[-1][-1]] + _FAR:
            parts.append([])
        parts[-1].append(k)
    return parts


_FAR = 8
"""Distance of places that no table row spans."""

_FEW = 8
"""Calls, of which one may be otherwise."""


def _labels(items: Sequence[object]) -> tuple[int, ...]:
    """Return for each item the place of the first that is equal."""
    first: dict[object, int] = {}
    return tuple(first.setdefault(item, k) for k, item in enumerate(items))
