"""Write sums so that every product in them can be fused with a sum.

(a b + c d) + (e f + g h) takes five operations: two products, two fused sums and a sum. One after
the other it takes four: a product and three fused sums. A part of a sum that holds nothing but
products is therefore added product by product.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from vehicledyn.codegen.ir.instructions import Instruction
from vehicledyn.codegen.passes.latency import depth

_PRODUCTS = ("MUL", "SQ")
_SUMS = ("ADD", "SUB")

Result = tuple[int, int, int]


def chain_products(
    values: list[Instruction], needed: list[bool], results: Iterable[Result]
) -> tuple[list[Instruction], list[Result]]:
    """Return values and results with sums of products written as chains, changed by rounding.

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
    uses = Counter(
        operand
        for item, is_needed in zip(values, needed, strict=True)
        if is_needed
        for operand in item.operands
    )
    uses.update(value for _, _, value in results)
    inner = _inner(values, needed, uses)
    chains = _Chains()
    sums: dict[int, _Sum] = {}

    def part(operand: int) -> _Sum:
        if operand in inner:
            return sums.pop(operand)
        place = chains.place[operand]
        if values[operand].operation in _PRODUCTS and uses[operand] == 1:
            return _Sum(None, 1, [(place, 1)])
        return _Sum(place, 1, [])

    for index, item in enumerate(values):
        if not needed[index] or item.operation not in _SUMS:
            chains.keep(item)
            continue
        one, other = map(part, item.operands)
        total = chains.joined(one, other, 1 if item.operation == "ADD" else -1)
        if index in inner:
            sums[index] = total
            chains.place.append(-1)
        else:
            chains.place.append(chains.value(total))
    return chains.values, [(k, element, chains.place[value]) for k, element, value in results]


def _inner(values: list[Instruction], needed: list[bool], uses: Counter[int]) -> set[int]:
    """Return the sums that are needed for another sum only."""
    return {
        operand
        for item, is_needed in zip(values, needed, strict=True)
        if is_needed and item.operation in _SUMS
        for operand in item.operands
        if uses[operand] == 1 and values[operand].operation in _SUMS
    }


@dataclass
class _Sum:
    """A value with its sign, if there is one, and products with theirs, not yet added up."""

    base: int | None
    sign: int
    products: list[tuple[int, int]]

    def turned(self, sign: int) -> list[tuple[int, int]]:
        """Return the products with their signs times a sign."""
        return [(product, sign * own) for product, own in self.products]


class _Chains:
    """Values with sums as chains, and the place among them of each value before."""

    def __init__(self) -> None:
        self.values: list[Instruction] = []
        self.place: list[int] = []
        self._depth: list[int] = []

    def keep(self, item: Instruction) -> None:
        """Add an instruction as it is."""
        operands = tuple(self.place[operand] for operand in item.operands)
        self.place.append(self._add(item._replace(operands=operands)))

    def joined(self, one: _Sum, other: _Sum, sign: int) -> _Sum:
        """Return one sum plus or minus another; where both have a value they are added up."""
        if one.base is not None and other.base is not None:
            operation = "ADD" if sign > 0 else "SUB"
            operands = (self.value(one), self.value(other))
            return _Sum(self._add(Instruction(operation, operands)), 1, [])
        products = one.products + other.turned(sign)
        if one.base is not None:
            return _Sum(one.base, one.sign, products)
        return _Sum(other.base, sign * other.sign, products)

    def value(self, total: _Sum) -> int:
        """Add up a sum, the products in the order in which they can be there.

        At least one term is positive: the first of the sum as it was written.
        """
        products = sorted(total.products, key=lambda item: (self._depth[item[0]], item))
        value = total.base
        if value is None or total.sign < 0:
            first = next(k for k, (_, sign) in enumerate(products) if sign > 0)
            product = products.pop(first)[0]
            value = product if value is None else self._add(Instruction("SUB", (product, value)))
        for product, sign in products:
            value = self._add(Instruction("ADD" if sign > 0 else "SUB", (value, product)))
        return value

    def _add(self, item: Instruction) -> int:
        self.values.append(item)
        self._depth.append(depth(item.operation, (self._depth[k] for k in item.operands)))
        return len(self.values) - 1
