"""Put the values of a function in an order for printing, calls of functions in packs."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from heapq import heapify, heappop, heappush

from vehicledyn.codegen.ir.instructions import CONST, INPUT, RESULT, SHARED, Instruction
from vehicledyn.codegen.passes.slp_rows import PLACES, PackedRow

CALLED = {
    **{name.upper(): name for name in ("atan", "asin", "acos", "exp", "log", "tanh", "atan2")},
    **dict.fromkeys(("SIN", "COS"), "sincos"),
    **{
        name.upper(): name
        for name in (
            *("sinh", "cosh", "asinh", "acosh", "atanh", "floor", "ceil", "erf", "expm1"),
            *("log1p", "pow", "fmod", "remainder", "copysign", "hypot"),
        )
    },
    "CONSTPOW": "pow",
}
"""Functions of elementary.c by operation."""


@dataclass(frozen=True)
class Pack:
    """Calls of one function at once: operands and values of each call.

    A call of "sincos" has two values, one of which may be absent (None). A call of the shared
    function of number ``shared`` has one for each result kept.
    """

    function: str
    operands: list[tuple[int, ...]]
    values: list[tuple[int | None, ...]]
    shared: int | None = None

    @property
    def computed(self) -> list[int]:
        """The values that the pack computes."""
        return [value for call in self.values for value in call if value is not None]


Step = int | Pack | PackedRow
"""What computes a value, the values of several calls, or those of a row."""


def computed_by(step: Step) -> list[int]:
    """Return the values that a step computes."""
    return [step] if isinstance(step, int) else step.computed


def operands_of(values: list[Instruction], step: Step) -> list[int]:
    """Return the values that a step reads."""
    if isinstance(step, int):
        return list(values[step].operands)
    return [operand for group in step.operands for operand in group]


def needed_values(values: list[Instruction], results: Iterable[tuple[int, int, int]]) -> list[bool]:
    """Return whether any result needs each value."""
    needed = [False] * len(values)
    for _, _, value in results:
        needed[value] = True
    for index in range(len(values) - 1, -1, -1):
        if needed[index]:
            for operand in values[index].operands:
                needed[operand] = True
    return needed


def call_levels(values: list[Instruction], needed: list[bool]) -> list[int]:
    """Return how many calls in turn lead to each value, itself included."""
    level = [0] * len(values)
    for index, item in enumerate(values):
        level[index] = max((level[operand] for operand in item.operands), default=0)
        if needed[index] and (item.operation in CALLED or item.operation == SHARED):
            level[index] += 1
    return level


def schedule(
    values: list[Instruction],
    results: Iterable[tuple[int, int, int]],
    wanted: list[list[int]],
    rows: list[PackedRow],
) -> tuple[list[Step], list[tuple[int, ...]]]:
    """Return the steps, and the values of the rows that they compute.

    Each pack comes as early as the functions it waits for allow.

    Parameters
    ----------
    values, results
        Instructions in an order of computation, and (output, element, value) of each result.
    wanted
        The numbers of the results that are needed of each shared function.
    rows
        Those asked for; one that a value would have to wait for in vain is left out.
    """
    order = _Order(values, needed_values(values, results), rows)
    shared: dict[int, dict[int, int]] = defaultdict(dict)
    waiting: dict[tuple[int, str], dict[tuple[int, ...], dict[str, int]]] = {}
    level = call_levels(values, order.needed)
    for index, item in enumerate(values):
        if not order.needed[index]:
            continue
        if item.operation in CALLED:
            calls = waiting.setdefault((level[index], CALLED[item.operation]), {})
            calls.setdefault(item.operands, {})[item.operation] = index
        elif item.operation == SHARED:
            waiting.setdefault((level[index], SHARED), {})[(index,)] = {}
        elif item.operation == RESULT:
            shared[item.operands[0]][item.source[1]] = index
    steps: list[Step] = []
    for key in sorted(waiting):
        if key[1] == SHARED:
            packs = _shared_packs(values, waiting[key], shared, wanted)
        else:
            packs = _packs(key[1], waiting[key], order.call_rows(key[1]), values)
        for pack in packs:
            steps += order.steps_to({operand for call in pack.operands for operand in call})
            steps.append(pack)
            order.take(pack)
    return steps + order.steps_to({value for _, _, value in results}), order.computed


def _shared_packs(
    values: list[Instruction],
    calls: Iterable[tuple[int, ...]],
    shared: dict[int, dict[int, int]],
    wanted: list[list[int]],
) -> list[Pack]:
    groups: dict[int, list[int]] = defaultdict(list)
    for (index,) in calls:
        groups[values[index].source[0]].append(index)
    return [
        Pack(
            SHARED,
            [values[index].operands for index in group],
            [tuple(shared[index].get(k) for k in wanted[number]) for index in group],
            number,
        )
        for number, group in groups.items()
    ]


def _packs(
    function: str,
    calls: dict[tuple[int, ...], dict[str, int]],
    rows: list[tuple[int, ...]],
    values: list[Instruction],
) -> list[Pack]:
    """Return the pack of some calls; of sines those without a cosine have one for themselves.

    The calls of a row lie side by side, where the registers of the processor begin.
    """
    if function == "sincos":
        parts = [
            ("sincos", ("SIN", "COS"), {k: call for k, call in calls.items() if "COS" in call}),
            ("sin", ("SIN",), {k: call for k, call in calls.items() if "COS" not in call}),
        ]
    else:
        names = dict.fromkeys(name for call in calls.values() for name in call)
        parts = [
            (function, (name,), {k: call for k, call in calls.items() if name in call})
            for name in names
        ]
    packs = []
    for name, operations, part in parts:
        order = _in_rows(part, rows, values)
        found = [tuple(part[given].get(operation) for operation in operations) for given in order]
        if order:
            packs.append(Pack(name, order, found))
    return packs


def _in_rows(
    calls: Iterable[tuple[int, ...]], rows: list[tuple[int, ...]], values: list[Instruction]
) -> list[tuple[int, ...]]:
    """Return calls with those of each row one after the other, before the others."""
    rest = dict.fromkeys(calls)
    found: list[tuple[int, ...]] = []
    for row in rows:
        given = [values[value].operands for value in row]
        if len(set(given)) == PLACES and all(item in rest for item in given):
            found += given
            for item in given:
                del rest[item]
    return [*found, *rest]


class _Order:
    """The order of single values and rows, in which every operand comes first."""

    def __init__(
        self, values: list[Instruction], needed: list[bool], rows: list[PackedRow]
    ) -> None:
        self.needed = needed
        self.computed: list[tuple[int, ...]] = []
        self._values = values
        self._row_of = {value: row for row in rows for value in row.values}
        self._rank = self._ranks() if rows else list(range(len(values)))
        self._done = [
            item.operation in (INPUT, CONST) or not wanted
            for item, wanted in zip(values, needed, strict=True)
        ]

    def _ranks(self) -> list[int]:
        """Return the place of each value in the order; rows that would wait in vain go.

        A row waits for the operands of all its values. Where nothing else can be computed and
        the operands of a value are, its row waits for itself.
        """
        users: list[list[int]] = [[] for _ in self._values]
        missing = [len(set(item.operands)) for item in self._values]
        for index, item in enumerate(self._values):
            for operand in set(item.operands):
                users[operand].append(index)
        ready = [index for index, count in enumerate(missing) if count == 0]
        heapify(ready)
        held: dict[int, int] = defaultdict(int)
        stuck: set[int] = set()
        rank, place = [0] * len(self._values), 0
        while ready or stuck:
            if not ready:
                row = self._row_of[min(stuck)]
                for value in row.values:
                    del self._row_of[value]
                    if value in stuck:
                        heappush(ready, value)
                stuck.difference_update(row.values)
            index = heappop(ready)
            members: tuple[int, ...] = (index,)
            if index in self._row_of:
                row = self._row_of[index]
                held[id(row)] += 1
                stuck.add(index)
                if held[id(row)] < len(row.values):
                    continue
                members = row.values
                stuck.difference_update(members)
            place += 1
            for member in members:
                rank[member] = place
                for user in users[member]:
                    missing[user] -= 1
                    if missing[user] == 0:
                        heappush(ready, user)
        return rank

    def call_rows(self, function: str) -> list[tuple[int, ...]]:
        """Return the values of the rows of calls of a function."""
        return [
            row.values
            for value, row in self._row_of.items()
            if value == row.values[0] and CALLED.get(row.operation) == function
        ]

    def take(self, pack: Pack) -> None:
        """Count the values of a pack as computed, and those of its rows that lie side by side."""
        for value in pack.computed:
            self._done[value] = True
        for column in zip(*pack.values, strict=True):
            for first in range(0, len(column) - PLACES + 1, PLACES):
                row = tuple(column[first : first + PLACES])
                known = self._row_of.get(row[0]) if row[0] is not None else None
                if known is not None and known.values == row:
                    self.computed.append(known.values)

    def steps_to(self, wanted: set[int]) -> list[Step]:
        """Return what is still to be computed for some values, in order."""
        found: dict[int, Step] = {}
        stack = [value for value in wanted if not self._done[value]]
        while stack:
            value = stack.pop()
            if self._done[value]:
                continue
            row = self._row_of.get(value)
            members = (value,) if row is None else row.values
            found[self._rank[value]] = value if row is None else row
            if row is not None:
                self.computed.append(row.values)
            for member in members:
                self._done[member] = True
                stack += [k for k in self._values[member].operands if not self._done[k]]
        return [found[rank] for rank in sorted(found)]
