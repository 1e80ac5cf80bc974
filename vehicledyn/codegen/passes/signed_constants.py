"""Read one constant where a function reads two that are equal but for their sign.

The left and the right side of a vehicle have equal constants and opposite ones. Cases side by side
need a register's room for each, which the cache lacks: with one in place of two a kernel runs
faster. Every result stays the same to the last bit: a product carries the sign of its factors, and
sums are taken off in place of being added.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from math import prod

from vehicledyn.codegen.ir.instructions import INPUT, Instruction, Program
from vehicledyn.codegen.passes.negation_folding import BY_SIGNS, SIGNS
from vehicledyn.codegen.passes.scheduling import needed_values

Signed = tuple[int, int]
"""A number, and the sign with which it stands for another."""

_SUMS = {"ADD": 1, "SUB": -1}
_ABSORBING = frozenset({*_SUMS, *SIGNS})


def mirrored_constants(prepare: Program) -> dict[int, Signed]:
    """Return the constants that equal an earlier one but for their sign, with that one.

    Parameters
    ----------
    prepare
        Computes the constants from the parameters; its results are those of output 0.
    """
    known: dict[tuple[object, ...], int] = {}
    signed: list[Signed] = []
    for item in prepare.instructions:
        operands = [signed[k] for k in item.operands]
        if item.operation == "NEG":
            kept, sign = operands[0]
            signed.append((kept, -sign))
            continue
        key, sign = _identity(item, operands)
        signed.append((known.setdefault(key, len(signed)), sign))
    first: dict[int, Signed] = {}
    found: dict[int, Signed] = {}
    for _, element, value in sorted(prepare.results):
        kept, sign = signed[value]
        if kept in first:
            other, other_sign = first[kept]
            found[element] = (other, sign * other_sign)
        else:
            first[kept] = (element, sign)
    return found


def _identity(item: Instruction, operands: list[Signed]) -> tuple[tuple[object, ...], int]:
    """Return what distinguishes an instruction, and its sign beside that."""
    name = item.operation
    signs = [sign for _, sign in operands]
    kept = [number for number, _ in operands]
    if name in _SUMS:
        one, other = sorted((operands[0], (kept[1], _SUMS[name] * signs[1])))
        return ("ADD", one[0], other[0], one[1] * other[1]), one[1]
    if name in ("INV", "TWICE", "DIV"):
        return (name, *kept), prod(signs)
    if name in ("MUL", "SQ"):
        factors = sorted(kept * 2 if name == "SQ" else kept)
        return ("MUL", *factors), 1 if name == "SQ" else prod(signs)
    return (name, *operands, item.source, item.number), 1


def read_mirrored(
    values: list[Instruction],
    results: Iterable[tuple[int, int, int]],
    constants: dict[int, Signed],
    place: int,
) -> list[Instruction]:
    """Return values that read the kept constants, in the same order.

    Parameters
    ----------
    values, results
        Instructions in an order of computation, and (output, element, value) of each result.
    constants
        For elements of an input others of it, with their sign, that stand for them.
    place
        The number of that input.
    """
    results = list(results)
    turning = _Turning(values, needed_values(values, results), constants, place)
    turning.find_turnable({value for _, _, value in results})
    return turning.values()


class _Turning:
    """Turns the signs of products where this lets a kept constant stand for another."""

    def __init__(
        self,
        values: list[Instruction],
        needed: list[bool],
        constants: dict[int, Signed],
        place: int,
    ) -> None:
        self._found, self._needed = list(values), needed
        self._sign = [1] * len(values)
        self._turnable = [False] * len(values)
        self._stand_in: dict[int, Signed] = {}
        own = {
            item.source[1]: index
            for index, item in enumerate(values)
            if item.operation == INPUT and item.source[0] == place
        }
        for element, index in own.items():
            other, sign = constants.get(element, (element, 1))
            if sign > 0:
                self._found[index] = values[index]._replace(source=(place, other))
            elif other in own:
                self._stand_in[index] = (own[other], sign)

    def find_turnable(self, results: set[int]) -> None:
        """Find the products that may have the other sign, as all that use them can do with it."""
        users: dict[int, list[int]] = defaultdict(list)
        for index, item in enumerate(self._found):
            if self._needed[index]:
                for operand in item.operands:
                    users[operand].append(index)
        for index in range(len(self._found) - 1, -1, -1):
            self._turnable[index] = (
                self._found[index].operation == "MUL"
                and index not in results
                and all(
                    self._turnable[user] or self._found[user].operation in _ABSORBING
                    for user in users[index]
                )
            )

    def values(self) -> list[Instruction]:
        """Return the values."""
        for index, item in enumerate(self._found):
            if not self._needed[index]:
                continue
            if item.operation in SIGNS:
                self._found[index] = self._fused(item)
            elif item.operation in _SUMS:
                self._found[index] = self._sum(item)
            elif self._turnable[index]:
                kept, signs = zip(*map(self._standing, item.operands), strict=True)
                self._found[index] = item._replace(operands=kept)
                self._sign[index] = prod(signs)
        return self._found

    def _standing(self, operand: int) -> Signed:
        """Return what stands for an operand."""
        return self._stand_in.get(operand, (operand, self._sign[operand]))

    def _fused(self, item: Instruction) -> Instruction:
        kept, signs = zip(*map(self._standing, item.operands), strict=True)
        product, addend = SIGNS[item.operation]
        name = BY_SIGNS[product * signs[0] * signs[1], addend * signs[2]]
        return item._replace(operation=name, operands=kept)

    def _sum(self, item: Instruction) -> Instruction:
        (one, sign), (other, other_sign) = map(self._standing, item.operands)
        other_sign *= _SUMS[item.operation]
        if sign > 0:
            return Instruction("ADD" if other_sign > 0 else "SUB", (one, other))
        return Instruction("SUB" if other_sign > 0 else "NEGADD", (other, one))
