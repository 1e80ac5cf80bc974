"""Read SX expressions as a list of instructions, each value computed once.

A look-up in a table becomes a CELL, the number of the cell that a place lies in, and what is
found there: its KNOT, where it begins, and each ENTRY, the coefficient of a power of the distance
from the knot. Cell 0 is straight and comes before the first one of the curve.

A call of a function that several places share becomes a SHARED with all arguments, and a RESULT
for each number that it returns.

The one place that knows how CasADi stores a function; printers of any language start here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, NamedTuple

from vehicledyn.symbolic.cell_functions import is_slope
from vehicledyn.symbolic.shared import inlined
from vehicledyn.symbolic.table_calls import calls_in
from vehicledyn.symbolic.tables import CurveTable, table_of

INPUT, CONST = "INPUT", "CONST"
CELL, KNOT, ENTRY = "CELL", "KNOT", "ENTRY"
SHARED, RESULT = "SHARED", "RESULT"


class Instruction(NamedTuple):
    """A value: operation, the values it is made from, the element of an input, or a number.

    ``operation`` is the name of the CasADi operation without its prefix, such as "MUL", or one
    of a look-up or call. The ``source`` of a look-up is the number of the table and that of the
    power, of a shared function its number and that of the result.
    """

    operation: str
    operands: tuple[int, ...] = ()
    source: tuple[int, int] = (0, 0)
    number: float = 0.0


@dataclass(frozen=True)
class Program:
    """Instructions in the order of computation, and (output, element, value) of each result.

    ``done`` says how many instructions precede each result. ``shared`` are the functions that are
    called; their arguments are the elements of input 0, their results those of output 0.
    """

    instructions: list[Instruction]
    results: list[tuple[int, int, int]]
    done: list[int]
    shared: list[Program] = field(default_factory=list)


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
        If a table is missing, or something else is called than tables and functions of SX.
    """
    names = _operations()
    program = Program([], [], [])
    slot: dict[int, int] = {}
    calls = calls_in(function)
    numbers = {table.identity: number for number, table in enumerate(tables)}
    known: dict[str, int] = {}
    for k in range(function.n_instructions()):
        name = names[function.instruction_id(k)]
        given, target = function.instruction_input(k), function.instruction_output(k)
        if name == "OUTPUT":
            program.results.append((target[0], target[1], slot[given[0]]))
            program.done.append(len(program.instructions))
            continue
        if name == "CALL":
            operands = tuple(slot[value] for value in given)
            if is_slope(calls[k].name()):
                found = _nothing(program, target)
            elif table_of(calls[k]) is not None:
                found = _look_up(program, operands[0], _number_of(calls[k], numbers), target)
            else:
                if calls[k].name() not in known:
                    known[calls[k].name()] = len(program.shared)
                    program.shared.append(_flat(calls[k], tables))
                found = _call(program, operands, known[calls[k].name()], target)
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


def _flat(function: Any, tables: Sequence[CurveTable]) -> Program:
    """Return a called function with its arguments and results in one row each."""
    if not function.is_a("SXFunction"):
        raise ValueError(f"the function '{function.name()}' is called, which is not one of SX")
    program = read_function(function, tables)
    before = [sum(function.nnz_in(i) for i in range(k)) for k in range(function.n_in())]
    for number, item in enumerate(program.instructions):
        if item.operation == INPUT:
            place = before[item.source[0]] + item.source[1]
            program.instructions[number] = item._replace(source=(0, place))
    before = [sum(function.nnz_out(i) for i in range(k)) for k in range(function.n_out())]
    program.results[:] = [(0, before[k] + element, value) for k, element, value in program.results]
    return program


def _nothing(program: Program, target: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Add a zero for each result wanted and yield the slots with their values."""
    for wanted in target:
        if wanted >= 0:
            yield wanted, len(program.instructions)
            program.instructions.append(Instruction(CONST, number=0.0))


def _call(
    program: Program, operands: tuple[int, ...], shared: int, target: Sequence[int]
) -> Iterator[tuple[int, int]]:
    """Add a call and yield the slots of its results with their values."""
    call = len(program.instructions)
    program.instructions.append(Instruction(SHARED, operands, (shared, 0)))
    for k, wanted in enumerate(target):
        if wanted >= 0:
            yield wanted, len(program.instructions)
            program.instructions.append(Instruction(RESULT, (call,), (shared, k)))


def _number_of(function: Any, numbers: dict[str, int]) -> int:
    table = table_of(function)
    if table is None:
        raise ValueError(f"the function '{function.name()}' is no table")
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

    Shared functions are written out.

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
    column = inlined(column) if expressions else column
    shared = casadi.cse(casadi.SX(column)) if expressions else casadi.SX(0, 1)
    return read_function(casadi.Function("expressions", list(inputs), [shared]), tables)


@cache
def _operations() -> dict[int, str]:
    import casadi

    return {getattr(casadi, name): name[3:] for name in dir(casadi) if name.startswith("OP_")}
