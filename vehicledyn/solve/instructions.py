"""Read SX expressions as a list of instructions, each value computed once.

The one place that knows how CasADi stores a function; printers of any language start here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

INPUT, CONST = "INPUT", "CONST"


class Instruction(NamedTuple):
    """A value: operation, the values it is made from, the element of an input, or a number.

    ``operation`` is the name of the CasADi operation without its prefix, such as "MUL".
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


def read_function(function: Any) -> Program:
    """Return the instructions of a ``casadi.Function`` made of SX expressions."""
    names = _operations()
    program = Program([], [], [])
    slot: dict[int, int] = {}
    for k in range(function.n_instructions()):
        name = names[function.instruction_id(k)]
        given, target = function.instruction_input(k), function.instruction_output(k)
        if name == "OUTPUT":
            program.results.append((target[0], target[1], slot[given[0]]))
            program.done.append(len(program.instructions))
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


def read_expressions(inputs: Sequence[Any], expressions: Sequence[Any]) -> Program:
    """Return the instructions of scalars, common parts computed once, in their order.

    Parameters
    ----------
    inputs
        Columns of symbols.
    expressions
        Scalars; the results are numbered (0, index).
    """
    import casadi

    column = casadi.vertcat(*[casadi.densify(casadi.SX(item)) for item in expressions])
    shared = casadi.cse(casadi.SX(column)) if expressions else casadi.SX(0, 1)
    return read_function(casadi.Function("expressions", list(inputs), [shared]))


@cache
def _operations() -> dict[int, str]:
    import casadi

    return {getattr(casadi, name): name[3:] for name in dir(casadi) if name.startswith("OP_")}
