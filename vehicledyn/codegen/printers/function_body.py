"""What is printed of a function: its steps, and the names of what it reads and writes."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from functools import cached_property

from vehicledyn.codegen.ir.instructions import Instruction
from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.loop_rolling import Rolling
from vehicledyn.codegen.passes.lowering import Lowered
from vehicledyn.codegen.printers.row_printer import Copies

SHARED_ARRAYS = "const real *restrict a, const real *restrict rows, real *restrict r0"
"""Parameters of a shared function: its arguments, the rows of its tables and its results."""


def name_of_shared(name: str, number: int) -> str:
    """Return the name of a shared function that the function ``name`` calls."""
    return f"{name}_shared_{number}"


@dataclass(frozen=True)
class OwnNames:
    """Names of inputs and results that are not elements of their arrays, by their number."""

    inputs: dict[int, str] = field(default_factory=dict)
    results: dict[int, str] = field(default_factory=dict)


@dataclass(frozen=True)
class FunctionBody:
    """The steps of a function and its arrays.

    ``inputs`` are the names of the input arrays. The rows of the tables, whose entries to a cell
    are ``widths``, stand in the last of them from ``first_row`` on. ``wide`` are the lanes of the
    shared functions that are called at several places at once.
    """

    lowered: Lowered
    inputs: list[str]
    name: str
    widths: list[int]
    first_row: int = 0
    wide: dict[int, int] = field(default_factory=dict)
    rolling: Rolling = field(default_factory=Rolling)
    copies: Copies | None = None
    names: OwnNames = field(default_factory=OwnNames)

    @property
    def values(self) -> list[Instruction]:
        """All values of the function."""
        return self.lowered.values

    @cached_property
    def rows(self) -> dict[tuple[int, ...], int]:
        """Number of each row, by its values."""
        return {values: number for number, values in enumerate(self.lowered.rows)}

    @cached_property
    def row_of(self) -> dict[int, tuple[int, int]]:
        """Row of a value and its place in it."""
        return {
            value: (number, place)
            for values, number in self.rows.items()
            for place, value in enumerate(values)
        }

    @cached_property
    def results(self) -> dict[int, list[str]]:
        """Names of the results that a value is."""
        found: dict[int, list[str]] = defaultdict(list)
        for output, element, value in self.lowered.results:
            name = self.names.results.get(element, f"r{output}[{element}]")
            found[value].append(name)
        return dict(found)

    def together(self, value: int) -> tuple[int, ...]:
        """Return the values of the row of a value, or itself alone."""
        found = self.row_of.get(value)
        return (value,) if found is None else self.lowered.rows[found[0]]

    def table_row(self, table: int = 0) -> str:
        """Return an expression for the place of a table's row."""
        return f"{self.inputs[-1]} + {self.first_row + ROW * table}"
