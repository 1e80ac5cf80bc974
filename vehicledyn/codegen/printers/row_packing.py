"""Print rows with the values that they need side by side, collected where they lie apart."""

from __future__ import annotations

from vehicledyn.codegen.ir.instructions import INPUT
from vehicledyn.codegen.passes.lowering import CONDITIONS
from vehicledyn.codegen.passes.slp_rows import PLACES, PackedRow
from vehicledyn.codegen.printers.operations import CONDITIONAL
from vehicledyn.codegen.printers.row_printer import row_expression
from vehicledyn.codegen.printers.value_printer import PieceValues


class SideBySide:
    """Values of a piece in fours; what was collected once is used again."""

    def __init__(self, values: PieceValues) -> None:
        """Begin without collected values."""
        self._values = values
        self._body, self._place = values.body, values.places.place
        self._collected: dict[tuple[int, ...], str] = {}

    def row_lines(self, row: PackedRow) -> list[str]:
        """Return the lines that compute a row and store what others need of it."""
        number = self._body.rows[row.values]
        conditions = CONDITIONAL.get(row.operation, ())
        lines: list[str] = []
        given = [
            self.four(operands, lines, is_condition=k in conditions)
            for k, operands in enumerate(row.operands)
        ]
        kind = "vd_mask4" if row.operation in CONDITIONS else "vd_four"
        is_number = [all(map(self._values.is_number, operands)) for operands in row.operands]
        lines.append(f"const {kind} v{number} = {row_expression(row, given, is_number)};")
        return lines + self.stores(row.values)

    def four(self, values: tuple[int, ...], lines: list[str], *, is_condition: bool = False) -> str:
        """Return an expression for values side by side; add the lines that collect them."""
        item, found = self._body.values[values[0]], self._body.rows.get(values)
        if found is not None:
            here = self._values.is_here(values[0])
            text = f"v{found}" if here else f"VD_FOUR_AT(s + {self._place[values[0]]})"
            if (here and item.operation in CONDITIONS) == is_condition:
                return text
            return f"vd4_true({text})" if is_condition else f"vd4_real({text})"
        if values not in self._collected:
            name = f"g{values[0]}_{len(self._collected)}"
            self._collected[values] = name
            lines.append(f"const vd_four {name} = {self._collect(values)};")
        text = self._collected[values]
        return f"vd4_true({text})" if is_condition else text

    def stores(self, values: tuple[int, ...]) -> list[str]:
        """Return the lines that store values, those of a row at once."""
        if len(values) == 1:
            return self._values.stores(values[0])
        lines: list[str] = []
        if values[0] in self._place:
            text = self.four(values, lines)
            lines.append(f"VD_FOUR_TO(s + {self._place[values[0]]}, {text});")
        for value in values:
            targets = self._body.results.get(value, [])
            lines += [f"{target} = {self._values.number(value)};" for target in targets]
        return lines

    def _collect(self, values: tuple[int, ...]) -> str:
        body = self._body
        numbers = [self._values.number(value) for value in values]
        if len(set(values)) == 1:
            return f"vd4_all({numbers[0]})"
        items = [body.values[value] for value in values]
        if all(item.operation == INPUT for item in items) and body.copies is not None:
            arrays = {item.source[0] for item in items}
            elements = tuple(item.source[1] for item in items)
            if len(arrays) == 1 and elements == tuple(range(elements[0], elements[0] + PLACES)):
                return f"VD_FOUR_AT({body.inputs[items[0].source[0]]} + {elements[0]})"
            if arrays == {len(body.inputs) - 1}:
                return f"VD_FOUR_AT({body.inputs[-1]} + {body.copies.place(elements)})"
        return f"(vd_four){{{', '.join(numbers)}}}"
