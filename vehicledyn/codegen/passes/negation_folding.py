"""Leave out negatives that sums can take up, and give fused sums the sign they are needed with.

a - (-b) becomes a + b, and -(a b + c), where the sum itself is not needed, -a b - c. Where product
and addend cancel, the last two differ in the sign of their zero, and compilers put the one in
place of the other where they compute one case only: so it is done here, for one case and for many.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

from vehicledyn.codegen.ir.instructions import Instruction

Result = tuple[int, int, int]

SIGNS = {"FMA": (1, 1), "FMS": (1, -1), "FNMA": (-1, 1), "FNMS": (-1, -1)}
"""Signs of product and addend of fused sums."""

BY_SIGNS = {signs: name for name, signs in SIGNS.items()}

_TERMS = {"ADD": (1, 1), "SUB": (1, -1)}


def turn_negated(
    values: list[Instruction], needed: Sequence[bool], results: Iterable[Result]
) -> tuple[list[Instruction], list[Result]]:
    """Return values and results in which no fused sum is needed for its negative alone.

    Parameters
    ----------
    values
        Instructions in an order of computation.
    needed
        Whether any result needs each of them.
    results
        (output, element, value) of each result.
    """
    results = list(results)
    taken = [
        _without_negatives(values, item) if is_needed else item
        for item, is_needed in zip(values, needed, strict=True)
    ]
    turning = _Turning(taken, needed, results)
    for index in range(len(values) - 1, -1, -1):
        turning.turn_if_negated(index)
    return turning.done()


def _without_negatives(values: list[Instruction], item: Instruction) -> Instruction:
    """Return a sum that takes up the signs of its operands, to the same bits."""
    if item.operation in SIGNS:
        product, addend = SIGNS[item.operation]
        operands = list(item.operands)
        for k, operand in enumerate(item.operands):
            if values[operand].operation == "NEG":
                operands[k] = values[operand].operands[0]
                product, addend = (-product, addend) if k < 2 else (product, -addend)
        return Instruction(BY_SIGNS[product, addend], tuple(operands))
    if item.operation in _TERMS:
        (one, other), (_, sign) = item.operands, _TERMS[item.operation]
        if values[other].operation == "NEG":
            other, sign = values[other].operands[0], -sign
        if sign > 0 and values[one].operation == "NEG":
            one, other, sign = other, values[one].operands[0], -1
        return Instruction("ADD" if sign > 0 else "SUB", (one, other))
    return item


class _Turning:
    """Values, their users, and whether these take them with the other sign."""

    def __init__(
        self, values: list[Instruction], needed: Sequence[bool], results: list[Result]
    ) -> None:
        self._values, self._results = values, results
        self._kept = {value for _, _, value in results}
        self._stand_in: dict[int, int] = {}
        self._users: dict[int, set[int]] = defaultdict(set)
        for index, item in enumerate(values):
            if needed[index]:
                for operand in item.operands:
                    self._users[operand].add(index)

    def turn_if_negated(self, index: int) -> None:
        """Turn a fused sum that all users, which are final but for their signs, take negative."""
        item, users = self._values[index], self._users[index]
        if item.operation not in SIGNS or index in self._kept or not users:
            return
        if all(self._takes_negative(user, index) for user in users):
            self._values[index] = _with_signs(item, -1, -1)
            for user in users:
                self._leave_out(user, index)

    def _takes_negative(self, user: int, value: int) -> bool:
        """Return whether a value enters another with the other sign only, as code is printed."""
        item = self._values[user]
        if item.operation == "NEG":
            return True
        product, addend = SIGNS.get(item.operation, (1, 1))
        signs = dict(zip((0, 2), (product, addend), strict=True))
        return all(signs.get(k, 1) < 0 for k, v in enumerate(item.operands) if v == value)

    def _leave_out(self, user: int, value: int) -> None:
        item = self._values[user]
        if item.operation == "NEG":
            self._stand_in[user] = value
            return
        turned = [-1 if item.operands[k] == value else 1 for k in (0, 2)]
        self._values[user] = _with_signs(item, *turned)

    def done(self) -> tuple[list[Instruction], list[Result]]:
        """Return values and results, what stands for a negative in place of it."""
        place = self._stand_in
        values = [
            item
            if place.keys().isdisjoint(item.operands)
            else item._replace(operands=tuple(place.get(k, k) for k in item.operands))
            for item in self._values
        ]
        return values, [
            (k, element, place.get(value, value)) for k, element, value in self._results
        ]


def _with_signs(item: Instruction, product: int, addend: int) -> Instruction:
    """Return a fused sum with the signs of its terms multiplied."""
    own = SIGNS[item.operation]
    return item._replace(operation=BY_SIGNS[own[0] * product, own[1] * addend])
