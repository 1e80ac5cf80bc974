"""Read SX expressions as a list of instructions, each value computed once.

A look-up in a table becomes a CELL, the number of the cell that a place lies in, and what is
found there: its KNOT, where it begins, and each ENTRY, the coefficient of a power of the distance
from the knot. Cell 0 is straight and comes before the first one of the curve.

The one place that knows how CasADi stores a function; printers of any language start here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from vehicledyn.symbolic.table_calls import calls_in, table_of
from vehicledyn.symbolic.tables import CurveTable

INPUT, CONST = "INPUT", "CONST"
CELL, KNOT, ENTRY = "CELL", "KNOT", "ENTRY"


class Instruction(NamedTuple):
    """A value: operation, the values it is made from, the element of an input, or a number.

    ``operation`` is the name of the CasADi operation without its prefix, such as "MUL", or one
    of a look-up. The ``source`` of a look-up is the number of the table and that of the power.
    """

    operation: str
    operands: tuple[int, ...] = ()
    source: tuple[int, int] = (0, 0)
    number: float = 0.0


@dataclass(frozen=True)
class Program:
    """Instructions in the order of computation, and (output, element, value) of each result.

    ``done`` tells how many instructions precede each result.
    """

    instructions: list[Instruction]
    results: list[tuple[int, int, int]]
    done: list[int]


def read_function(function: Any, tables: Sequence[CurveTable] = ()) -> Program:
    """Return the instructions of a ``casadi.Function`` made of SX expressions.

    Parameters
    ----------
    function
        The function.
    tables
        All that its expressions look up, in the order in which they are numbered.

    Raises
    ------
    ValueError
        If a table is missing, or something else than a table is called.
    """
    names = _operations()
    program = Program([], [], [])
    slot: dict[int, int] = {}
    calls = calls_in(function)
    numbers = {table.identity: number for number, table in enumerate(tables)}
    for k in range(function.n_instructions()):
        name = names[function.instruction_id(k)]
        given, target = function.instruction_input(k), function.instruction_output(k)
        if name == "OUTPUT":
            program.results.append((target[0], target[1], slot[given[0]]))
            program.done.append(len(program.instructions))
            continue
        if name == "CALL":
            found = _look_up(program, slot[given[0]], _number_of(calls[k], numbers), target)
            slot.update(found)
            continue
        if name == INPUT:
            item = Instruction(name, source=(given[0], given[1]))
        elif name == CONST:
            item = Instruction(name, number=function.instruction_constant(k))
        else:
            item = Instruction(name, tuple(slot[value] for value in given))
        slot[target[0]] = len(program.instructions)
        program.instructions.append(item)
    return program


def _number_of(function: Any, numbers: dict[str, int]) -> int:
    table = table_of(function)
    if table is None:
        raise ValueError(f"the function '{function.name()}' is called, which is no table")
    if table.identity not in numbers:
        raise ValueError(f"table '{table.name}' is not among the tables of the equations")
    return numbers[table.identity]


def _look_up(
    program: Program, place: int, table: int, target: Sequence[int]
) -> Iterator[tuple[int, int]]:
    """Add a look-up and yield the slots of its results with their values."""
    cell = len(program.instructions)
    program.instructions.append(Instruction(CELL, (place,), (table, 0)))
    for k, wanted in enumerate(target):
        if wanted >= 0:
            yield wanted, len(program.instructions)
            item = Instruction(ENTRY, (cell,), (table, k - 1)) if k else None
            program.instructions.append(item or Instruction(KNOT, (cell,), (table, 0)))


def read_expressions(
    inputs: Sequence[Any], expressions: Sequence[Any], tables: Sequence[CurveTable] = ()
) -> Program:
    """Return the instructions of scalars, common parts computed once, in their order.

    Parameters
    ----------
    inputs
        Columns of symbols.
    expressions
        Scalars; the results are numbered (0, index).
    tables
        Those that the expressions look up.
    """
    import casadi

    column = casadi.vertcat(*[casadi.densify(casadi.SX(item)) for item in expressions])
    shared = casadi.cse(casadi.SX(column)) if expressions else casadi.SX(0, 1)
    return read_function(casadi.Function("expressions", list(inputs), [shared]), tables)


@cache
def _operations() -> dict[int, str]:
    import casadi

    return {getattr(casadi, name): name[3:] for name in dir(casadi) if name.startswith("OP_")}
