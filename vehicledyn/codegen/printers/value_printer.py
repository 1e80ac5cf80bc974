"""Read and store single values where a piece of a function needs them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.codegen.ir.instructions import CONST, INPUT
from vehicledyn.codegen.passes.lowering import CONDITIONS
from vehicledyn.codegen.printers.function_body import FunctionBody
from vehicledyn.codegen.printers.function_splitting import Places
from vehicledyn.codegen.printers.operations import KERNEL


@dataclass(frozen=True)
class PieceValues:
    """Values as a piece of a function names them.

    Inputs and constants are read where they are needed, results stored where they arise; the
    values that a later piece needs are handed on in the array ``s``.
    """

    body: FunctionBody
    places: Places
    piece: int

    def is_here(self, value: int) -> bool:
        """Return whether the piece computes a value."""
        return self.places.piece_of[value] == self.piece

    def is_number(self, value: int) -> bool:
        """Return whether a value is surely a number."""
        item = self.body.values[value]
        return item.operation == CONST and not math.isnan(item.number)

    def number(self, value: int) -> str:
        """Return an expression for a value as a real."""
        text = self._reference(value)
        return f"vd_real({text})" if self._is_mask(value) else text

    def condition(self, value: int) -> str:
        """Return an expression for a value as a condition."""
        text = self._reference(value)
        return text if self._is_mask(value) else f"vd_true({text})"

    def stores(self, value: int) -> list[str]:
        """Return the lines that store a value."""
        place, room = self.places.place, self.body.rolling.held
        if value in room.done:
            return []
        held = value in place and value not in room.results
        targets = [f"s[{place[value]}]"] if held else []
        targets += self.body.results.get(value, [])
        return [f"{target} = {self.number(value)};" for target in targets]

    def _is_mask(self, value: int) -> bool:
        return self.body.values[value].operation in CONDITIONS and self.is_here(value)

    def _reference(self, value: int) -> str:
        body, item = self.body, self.body.values[value]
        if item.operation == INPUT and item.source[1] in body.names.inputs:
            return body.names.inputs[item.source[1]]
        if item.operation == INPUT:
            return f"{body.inputs[item.source[0]]}[{item.source[1]}]"
        if item.operation == CONST:
            return f"vd_all({KERNEL.number(item.number).text})"
        if not self.is_here(value) or value in body.rolling.held.results:
            return f"s[{self.places.place[value]}]"
        if value in body.row_of:
            row, place = body.row_of[value]
            return f"v{row}[{place}]"
        return f"w{value}"


def taken(values: Sequence[int | None], array: str, place: str) -> list[str]:
    """Return the lines that take the values of a call from an array."""
    return [
        f"const real w{value} = {array}[{place.format(k)}];"
        for k, value in enumerate(values)
        if value is not None
    ]
