"""Bring instructions into the form in which they are printed: fused, chosen, called in packs.

- a b + c, a b - c and c - a b become one operation, rounded once, where the product is not
  needed for itself;
- the two halves of an if_else become one choice;
- elementary functions are called in packs: those that do not wait for each other together, so
  that they fill the registers of the processor whether a kernel has one lane or many;
- of functions that several places share only the results that a place needs are kept;
- where asked for, values that are computed alike in four places become rows, see
  :mod:`vehicledyn.codegen.passes.slp_rows`.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from vehicledyn.codegen.ir.instructions import (
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
from vehicledyn.codegen.passes.fma_chains import chain_products
from vehicledyn.codegen.passes.negation_folding import turn_negated
from vehicledyn.codegen.passes.scheduling import CALLED, Step, call_levels, needed_values, schedule
from vehicledyn.codegen.passes.signed_constants import Signed, read_mirrored
from vehicledyn.codegen.passes.slp_rows import find_rows

CONDITIONS = frozenset({"LT", "LE", "EQ", "NE", "NOT", "AND", "OR"})
"""Operations whose values are conditions."""

FUSED = {("ADD", 0): "FMA", ("ADD", 1): "FMA", ("SUB", 0): "FMS", ("SUB", 1): "FNMA"}
"""Fused operation for a sum and the place of the product in it; the addend comes last."""

LOOKED_UP = frozenset({CELL, KNOT, ENTRY})
"""Operations that look up a table."""

_ASKED = frozenset({*CALLED, *LOOKED_UP, SHARED, RESULT})


@dataclass(frozen=True)
class Lowered:
    """Values, the steps that compute them in order, and (output, element, value) of results.

    Inputs and constants take no step. ``shared`` are the functions that are called, with the
    results that are needed, in the order of the results. ``rows`` are the values of those rows
    that steps or packs compute.
    """

    values: list[Instruction]
    steps: list[Step]
    results: list[tuple[int, int, int]]
    shared: list[Lowered]
    rows: list[tuple[int, ...]]

    @cached_property
    def looks_up(self) -> bool:
        """Whether values come from tables, here or in the functions that are called."""
        own = any(item.operation in LOOKED_UP for item in self.values)
        return own or any(function.looks_up for function in self.shared)


def lower(
    program: Program,
    *,
    in_rows: bool = False,
    chained: bool = True,
    mirrored: dict[int, Signed] | None = None,
    constants: int = 0,
) -> Lowered:
    """Return a program in the form in which it is printed, in rows where that is asked for.

    Shared functions stay without rows, as their places are side by side already, and without
    chains of sums, as some of their arguments come late. ``mirrored`` are the elements of the
    input ``constants`` for which others stand, see
    :mod:`vehicledyn.codegen.passes.signed_constants`.
    """
    values, results = _without_repeats(program)
    values = _choose(values)
    if chained:
        values, results = chain_products(values, needed_values(values, results), results)
    values = fuse(values, results)
    values, results = turn_negated(values, needed_values(values, results), results)
    if mirrored:
        values = read_mirrored(values, results, mirrored, constants)
    wanted = _results_wanted(values, results, len(program.shared))
    shared = [
        lower(_keeping(function, kept), chained=False)
        for function, kept in zip(program.shared, wanted, strict=True)
    ]
    needed = needed_values(values, results)
    level = call_levels(values, needed)
    found = []
    if in_rows:
        found = find_rows(values, results, needed=needed, level=level, called=CALLED)
    steps, rows = schedule(values, results, wanted, found)
    return Lowered(values, steps, results, shared, rows)


def _results_wanted(
    values: list[Instruction], results: Iterable[tuple[int, int, int]], n_shared: int
) -> list[list[int]]:
    """Return the numbers of the results that are needed of each shared function."""
    wanted: list[set[int]] = [set() for _ in range(n_shared)]
    for needed, item in zip(needed_values(values, results), values, strict=True):
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
    return value.operation in (INPUT, CONST)


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
        if item.operation in _ASKED:
            known[item] = len(values) - 1
        return len(values) - 1

    for item in program.instructions:
        operands = tuple(place[operand] for operand in item.operands)
        if item.operation == "TAN":
            parts = (add(Instruction("SIN", operands)), add(Instruction("COS", operands)))
            place.append(add(Instruction("DIV", parts)))
        else:
            same = operands == item.operands
            place.append(add(item if same else item._replace(operands=operands)))
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


def fuse(values: list[Instruction], results: Iterable[tuple[int, int, int]]) -> list[Instruction]:
    """Join products and the sums they enter, where this makes the product itself needless."""
    needed = needed_values(values, results)
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
