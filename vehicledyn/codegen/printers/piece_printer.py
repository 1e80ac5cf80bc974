"""Print the steps of a piece of a function, each by its kind."""

from __future__ import annotations

from collections import Counter

from vehicledyn.codegen.ir.instructions import ENTRY, Instruction
from vehicledyn.codegen.passes.lowering import CONDITIONS, LOOKED_UP
from vehicledyn.codegen.passes.scheduling import Pack, Step, computed_by
from vehicledyn.codegen.passes.slp_rows import PackedRow
from vehicledyn.codegen.printers.call_printer import elementary_calls, shared_calls
from vehicledyn.codegen.printers.loop_printer import following_packs, loop_lines
from vehicledyn.codegen.printers.operations import CONDITIONAL, kernel_expression
from vehicledyn.codegen.printers.row_packing import SideBySide
from vehicledyn.codegen.printers.value_printer import PieceValues

_LOADED_AT_ONCE = 4
"""Entries of a cell that are loaded together, those of cubic curves."""


class PieceCode:
    """Prints the steps of one piece.

    ``called`` counts the calls in loops of each shared function, in the pieces before as well.
    """

    def __init__(self, values: PieceValues, called: Counter[int]) -> None:
        """Begin with nothing printed."""
        self._values, self._body = values, values.body
        self._fours = SideBySide(values)
        self._called = called
        self._loaded: set[int] = set()

    def lines(self, steps: list[Step]) -> list[str]:
        """Return the lines that compute steps and store what others need."""
        lines: list[str] = []
        for number, step in enumerate(steps):
            if isinstance(step, PackedRow):
                lines += self._fours.row_lines(step)
                continue
            if self._body.rolling.holds(step):
                lines += self._loop(following_packs(steps, number))
                continue
            if isinstance(step, int):
                lines += self._value(step)
            elif step.shared is not None:
                lines += shared_calls(self._values, step, number)
            else:
                lines += elementary_calls(self._values, self._fours, step, number)
            for values in dict.fromkeys(map(self._body.together, computed_by(step))):
                lines += self._fours.stores(values)
        return lines

    def _loop(self, packs: list[Pack]) -> list[str]:
        if not packs:
            return []
        shared = packs[0].shared or 0
        first = self._called[shared]
        self._called[shared] += sum(len(pack.operands) for pack in packs)
        return loop_lines(self._values, packs, first)

    def _value(self, value: int) -> list[str]:
        """Return the lines that compute one value."""
        item = self._body.values[value]
        loads = self._load(item)
        kind = "vd_mask" if item.operation in CONDITIONS else "real"
        return [*loads, f"const {kind} w{value} = {self._expression(item)};"]

    def _load(self, item: Instruction) -> list[str]:
        """Return what loads all entries of a cell at once, before the first of them is used."""
        if item.operation != ENTRY or self._body.widths[item.source[0]] != _LOADED_AT_ONCE:
            return []
        cell = item.operands[0]
        if cell in self._loaded:
            return []
        self._loaded.add(cell)
        row = self._body.table_row(item.source[0])
        place = self._values.number(cell)
        return [f"real e{cell}[4];", f"vd_four_entries({place}, {row}, e{cell});"]

    def _expression(self, item: Instruction) -> str:
        if item.operation == ENTRY and item.operands[0] in self._loaded:
            return f"e{item.operands[0]}[{item.source[1]}]"
        own, conditions = self._values, CONDITIONAL.get(item.operation, ())
        names = [
            own.condition(operand) if k in conditions else own.number(operand)
            for k, operand in enumerate(item.operands)
        ]
        is_number = [own.is_number(operand) for operand in item.operands]
        return kernel_expression(item.operation, names, is_number, self._table(item))

    def _table(self, item: Instruction) -> dict[str, str | int]:
        """Return what the template of a look-up asks for."""
        if item.operation not in LOOKED_UP:
            return {}
        table, power = item.source
        width = self._body.widths[table]
        return {"table": self._body.table_row(table), "width": width, "power": power}
