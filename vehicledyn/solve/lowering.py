"""Bring instructions into the form in which they are printed: fused, chosen, called in packs.

- a b + c, a b - c and c - a b become one operation, rounded once, where the product is not
  needed for itself;
- the two halves of an if_else become one choice;
- elementary functions are called in packs: those that do not wait for each other together, so
  that they fill the registers of the processor whether a kernel has one lane or many;
- of functions that several places share only the results that a place needs are kept.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass

from vehicledyn.solve.instructions import (
    CELL,
    CONST,
    ENTRY,
    INPUT,
    KNOT,
    RESULT,
    SHARED,
    Instruction,
    Program,
)

CONDITIONS = frozenset({"LT", "LE", "EQ", "NE", "NOT", "AND", "OR"})
"""Operations whose values are conditions."""

FUSED = {("ADD", 0): "FMA", ("ADD", 1): "FMA", ("SUB", 0): "FMS", ("SUB", 1): "FNMA"}
"""Fused operation for a sum and the place of the product in it; the addend comes last."""

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

LOOKED_UP = frozenset({CELL, KNOT, ENTRY})
"""Operations that look up a table."""

_AT_HAND = (INPUT, CONST)
_ASKED = frozenset({*CALLED, *LOOKED_UP, SHARED, RESULT})


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


Step = int | Pack


@dataclass(frozen=True)
class Lowered:
    """Values, the steps that compute them in order, and (output, element, value) of results.

    Inputs and constants take no step. ``shared`` are the functions that are called, with the
    results that are needed, in the order of the results.
    """

    values: list[Instruction]
    steps: list[Step]
    results: list[tuple[int, int, int]]
    shared: list[Lowered]


def lower(program: Program) -> Lowered:
    """Return a program in the form in which it is printed."""
    values, results = _without_repeats(program)
    values = _fuse(_choose(values), results)
    wanted = _results_wanted(values, results, len(program.shared))
    shared = [
        lower(_keeping(function, kept))
        for function, kept in zip(program.shared, wanted, strict=True)
    ]
    return Lowered(values, _schedule(values, results, wanted), results, shared)


def _results_wanted(
    values: list[Instruction], results: Iterable[tuple[int, int, int]], n_shared: int
) -> list[list[int]]:
    """Return the numbers of the results that are needed of each shared function."""
    wanted: list[set[int]] = [set() for _ in range(n_shared)]
    for needed, item in zip(_needed(values, results), values, strict=True):
        if needed and item.operation == RESULT:
            wanted[item.source[0]].add(item.source[1])
    return [sorted(numbers) for numbers in wanted]


def _keeping(function: Program, kept: list[int]) -> Program:
    """Return a function with some of its results, in their order."""
    place = {number: k for k, number in enumerate(kept)}
    results = [(0, place[k], value) for _, k, value in function.results if k in place]
    return Program(function.instructions, results, function.done, function.shared)


def is_at_hand(value: Instruction) -> bool:
    """Return whether a value is an input or a constant."""
    return value.operation in _AT_HAND


def _without_repeats(program: Program) -> tuple[list[Instruction], list[tuple[int, int, int]]]:
    """Return the instructions with each function and table asked once a value.

    tan x becomes sin x / cos x.
    """
    values: list[Instruction] = []
    place: list[int] = []
    known: dict[Instruction, int] = {}

    def add(item: Instruction) -> int:
        if item.operation in _ASKED and item in known:
            return known[item]
        values.append(item)
        known[item] = len(values) - 1
        return known[item]

    for item in program.instructions:
        operands = tuple(place[operand] for operand in item.operands)
        if item.operation == "TAN":
            parts = (add(Instruction("SIN", operands)), add(Instruction("COS", operands)))
            place.append(add(Instruction("DIV", parts)))
        else:
            place.append(add(item._replace(operands=operands)))
    return values, [(output, element, place[value]) for output, element, value in program.results]


def _choose(values: list[Instruction]) -> list[Instruction]:
    """Join (c ? a : 0) + (!c ? b : 0) to a choice."""
    chosen = list(values)
    for index, item in enumerate(values):
        if item.operation != "ADD":
            continue
        yes, no = (values[operand] for operand in item.operands)
        if yes.operation != "IF_ELSE_ZERO" or no.operation != "IF_ELSE_ZERO":
            continue
        opposite = values[no.operands[0]]
        if opposite.operation == "NOT" and opposite.operands[0] == yes.operands[0]:
            operands = (yes.operands[0], yes.operands[1], no.operands[1])
            chosen[index] = Instruction("SELECT", operands)
    return chosen


def _fuse(values: list[Instruction], results: Iterable[tuple[int, int, int]]) -> list[Instruction]:
    """Join products and the sums they enter, where this makes the product itself needless."""
    needed = _needed(values, results)
    uses: dict[int, list[int]] = defaultdict(list)
    for index, item in enumerate(values):
        if needed[index]:
            for operand in item.operands:
                uses[operand].append(index)
    kept = {value for _, _, value in results}
    fused = list(values)

    def can_take(user: int, product: int) -> bool:
        item = values[user]
        return (
            item.operation in ("ADD", "SUB")
            and fused[user] is item
            and item.operands[0] != item.operands[1]
        )

    products = [
        index
        for index, item in enumerate(values)
        if needed[index] and item.operation in ("MUL", "SQ") and index not in kept
    ]
    for most_uses in (1, len(values)):
        for product in products:
            users = uses[product]
            if not 0 < len(users) <= most_uses:
                continue
            if all(can_take(user, product) for user in users):
                for user in users:
                    fused[user] = _fused(values[user], values[product], product)
                uses[product] = []
    return fused


def _fused(total: Instruction, product: Instruction, index: int) -> Instruction:
    place = total.operands.index(index)
    factors = product.operands if product.operation == "MUL" else product.operands * 2
    return Instruction(FUSED[total.operation, place], (*factors, total.operands[1 - place]))


def _needed(values: list[Instruction], results: Iterable[tuple[int, int, int]]) -> list[bool]:
    needed = [False] * len(values)
    for _, _, value in results:
        needed[value] = True
    for index in range(len(values) - 1, -1, -1):
        if needed[index]:
            for operand in values[index].operands:
                needed[operand] = True
    return needed


def _schedule(
    values: list[Instruction],
    results: Iterable[tuple[int, int, int]],
    wanted: list[list[int]],
) -> list[Step]:
    """Return the steps; each pack as early as the functions it waits for allow."""
    needed = _needed(values, results)
    shared: dict[int, dict[int, int]] = defaultdict(dict)
    level = [0] * len(values)
    waiting: dict[tuple[int, str], dict[tuple[int, ...], dict[str, int]]] = {}
    for index, item in enumerate(values):
        level[index] = max((level[operand] for operand in item.operands), default=0)
        if needed[index] and item.operation in CALLED:
            level[index] += 1
            calls = waiting.setdefault((level[index], CALLED[item.operation]), {})
            calls.setdefault(item.operands, {})[item.operation] = index
        elif needed[index] and item.operation == SHARED:
            level[index] += 1
            waiting.setdefault((level[index], SHARED), {})[(index,)] = {}
        elif needed[index] and item.operation == RESULT:
            shared[item.operands[0]][item.source[1]] = index
    done = [is_at_hand(item) or not needed[index] for index, item in enumerate(values)]
    steps: list[Step] = []
    for key in sorted(waiting):
        if key[1] == SHARED:
            groups: dict[int, list[int]] = defaultdict(list)
            for (index,) in waiting[key]:
                groups[values[index].source[0]].append(index)
            packs = [
                Pack(
                    SHARED,
                    [values[index].operands for index in group],
                    [tuple(shared[index].get(k) for k in wanted[number]) for index in group],
                    number,
                )
                for number, group in groups.items()
            ]
        else:
            packs = _packs(key[1], waiting[key])
        for pack in packs:
            operands = {operand for call in pack.operands for operand in call}
            steps += _compute(values, operands, done)
            steps.append(pack)
            for value in pack.computed:
                done[value] = True
    return steps + _compute(values, {value for _, _, value in results}, done)


def _packs(function: str, calls: dict[tuple[int, ...], dict[str, int]]) -> list[Pack]:
    """Return the pack of some calls; of sines those without a cosine have one for themselves."""
    if function != "sincos":
        return [Pack(function, list(calls), [tuple(call.values()) for call in calls.values()])]
    both = {given: call for given, call in calls.items() if "COS" in call}
    alone = {given: call for given, call in calls.items() if "COS" not in call}
    found = []
    if both:
        pairs = [(call.get("SIN"), call["COS"]) for call in both.values()]
        found.append(Pack("sincos", list(both), list(pairs)))
    if alone:
        found.append(Pack("sin", list(alone), [(call["SIN"],) for call in alone.values()]))
    return found


def _compute(values: list[Instruction], wanted: set[int], done: list[bool]) -> list[Step]:
    """Return what is still to be computed for some values, in the order of the program."""
    todo: list[int] = []
    stack = [value for value in wanted if not done[value]]
    for value in stack:
        done[value] = True
    while stack:
        value = stack.pop()
        todo.append(value)
        for operand in values[value].operands:
            if not done[operand]:
                done[operand] = True
                stack.append(operand)
    return [*sorted(todo)]
