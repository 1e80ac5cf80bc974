"""The SX functions a kernel runs, with what depends on the parameters alone moved apart.

    prepare: p -> c,    rates, outputs: (t, x, z, c) -> ẋ, y,    blocks: (t, x, z, c) -> g, ∂g/∂z,
    events, resets: (t, x, z, c) -> functions whose sign change marks events, new values of states

Parameters are all symbolic, so a good part of every expression does not change in a run;
``prepare`` computes it once for each parameter set.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from vehicledyn.codegen.ir.instructions import read_function
from vehicledyn.codegen.ir.sx_graph import Node, Rebuild, fixed_from, read_nodes
from vehicledyn.codegen.passes.reciprocals import use_reciprocals
from vehicledyn.codegen.passes.signed_constants import mirrored_constants
from vehicledyn.codegen.passes.split_calls import call_apart
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.motion_residuals import MotionResiduals
from vehicledyn.symbolic.table_calls import calls_in
from vehicledyn.symbolic.tables import CurveTable, table_of

_NO_WORK = ("OP_INPUT", "OP_OUTPUT", "OP_CONST", "OP_PARAMETER")

COUNTED = ("prepare", "rates", "outputs", "blocks")
"""Parts of a kernel whose operations are counted."""


@dataclass(frozen=True)
class KernelFunctions:
    """CasADi functions of a kernel; ``blocks`` are in the order of the equations' blocks.

    ``waves`` return residual and Jacobian of neighbouring blocks that do not depend on each
    other, in one column, and ``wave_starts`` are their first blocks. ``balance``, if wanted:
    (t, x, z, a, c) -> what is missing at accelerations a, and the mass matrix, see
    :class:`~vehicledyn.symbolic.motion_residuals.MotionResiduals`.
    """

    prepare: Any
    rates: Any
    outputs: Any
    blocks: tuple[Any, ...]
    events: Any
    resets: Any
    waves: tuple[Any, ...]
    wave_starts: tuple[int, ...]
    balance: Any = None


def derive_functions(
    equations: Equations, residuals: MotionResiduals | None = None
) -> KernelFunctions:
    """Return the functions of a kernel for some equations, and of what accelerations fulfil."""
    import casadi

    time, state, unknown = equations.time, equations.state, equations.algebraic
    expressions: Any = [equations.rate, equations.output, *event_expressions(equations)]
    expressions += block_expressions(equations)
    n_kernel = len(expressions)
    acceleration = casadi.SX(0, 1) if residuals is None else residuals.acceleration
    if residuals is not None:
        symbols = [time, state, unknown, acceleration, equations.parameter]
        expressions += _missing(residuals, symbols)
    given = [time, state, unknown, acceleration, equations.parameter]
    expressions, constants, values = _apart(given, expressions)
    inputs = [time, state, unknown, constants]
    starts = wave_starts(equations)
    waves = [
        casadi.Function(f"wave_{k}", inputs, [column])
        for k, column in enumerate(_wave_columns(equations, starts, expressions[4:n_kernel]))
    ]
    balance = None
    if residuals is not None:
        at = [time, state, unknown, acceleration, constants]
        balance = casadi.Function("balance", at, expressions[n_kernel:])
    return KernelFunctions(
        prepare=_prepare(equations.parameter, values, equations.tables),
        rates=casadi.Function("rates", inputs, expressions[:1]),
        outputs=casadi.Function("outputs", inputs, expressions[1:2]),
        blocks=tuple(
            casadi.Function(f"block_{k}", inputs, expressions[4 + 2 * k : 6 + 2 * k])
            for k in range(len(equations.blocks))
        ),
        events=casadi.Function("events", inputs, expressions[2:3]),
        resets=casadi.Function("resets", inputs, expressions[3:4]),
        waves=tuple(waves),
        wave_starts=starts,
        balance=balance,
    )


def _missing(residuals: MotionResiduals, symbols: list[Any]) -> list[Any]:
    """Return residuals and mass matrix in terms of symbols (t, x, z, a, p)."""
    import casadi

    r = residuals
    own = [r.time, r.state, r.algebraic, r.acceleration, r.parameter]
    return list(casadi.Function("missing", own, [r.residual, r.mass])(*symbols))


def kernel_columns(equations: Equations) -> tuple[list[str], list[Any], tuple[int, ...]]:
    """Return names and columns of what a kernel computes, and the first block of each wave."""
    starts = wave_starts(equations)
    waves = _wave_columns(equations, starts, block_expressions(equations))
    names = ["rates", "outputs", "events", "resets", *(f"wave_{k}" for k in range(len(waves)))]
    columns = [equations.rate, equations.output, *event_expressions(equations), *waves]
    return names, columns, starts


def _wave_columns(equations: Equations, starts: tuple[int, ...], blocks: list[Any]) -> list[Any]:
    """Return residuals and Jacobians of the blocks of each wave in one column."""
    import casadi

    stops = [*starts[1:], len(equations.blocks)]
    return [
        casadi.vertcat(*[casadi.vec(item) for item in blocks[2 * start : 2 * stop]])
        for start, stop in zip(starts, stops, strict=False)
    ]


def apart_in_functions(
    names: Sequence[str],
    inputs: list[Any],
    results: Sequence[Sequence[Any]],
    tables: Sequence[CurveTable],
    room: int = 0,
) -> tuple[Any, dict[str, Any]]:
    """Return ``prepare``: p -> c, and functions by name of the other inputs and c.

    Parameters
    ----------
    names
        Names of the functions.
    inputs
        Columns of symbols, the parameters last.
    results
        SX columns of each function.
    tables
        All that is looked up.
    room
        How many further numbers c has at its end.
    """
    import casadi

    flat, constants, values = _apart(inputs, [item for items in results for item in items])
    given = [*inputs[:-1], casadi.vertcat(constants, casadi.SX.sym("room", room))]
    functions, rest = {}, iter(flat)
    for name, items in zip(names, results, strict=True):
        functions[name] = casadi.Function(name, given, [next(rest) for _ in items])
    return _prepare(inputs[-1], values, tables), functions


def _prepare(parameter: Any, values: Any, tables: Sequence[CurveTable]) -> Any:
    """Return the function of the constants; those opposite or equal to another are made of it.

    Written apart they may differ in their last bit, as their products are fused with other sums;
    code that reads one in place of both would have other results than code that reads each.
    """
    import casadi

    written = casadi.Function("prepare", [parameter], [values])
    found = mirrored_constants(read_function(written, tables))
    items = casadi.vertsplit(values) if values.numel() else []
    for element, (other, sign) in found.items():
        items[element] = items[other] if sign > 0 else -items[other]
    column = casadi.vertcat(casadi.SX(0, 1), *items)
    return casadi.Function("prepare", [parameter], [column])


def apart_from_parameters(inputs: list[Any], expressions: list[Any]) -> tuple[Any, Any]:
    """Return two functions that together give expressions.

    Parameters
    ----------
    inputs
        Columns of symbols, the parameters last.
    expressions
        SX matrices.

    Returns
    -------
    tuple
        ``prepare``: p -> c, and the function of the other inputs and c that gives the
        expressions, dense.
    """
    import casadi

    prepare, constants, results = parts_apart_from_parameters(inputs, expressions)
    return prepare, casadi.Function("evaluate", [*inputs[:-1], constants], results)


def parts_apart_from_parameters(
    inputs: list[Any], expressions: list[Any]
) -> tuple[Any, Any, list[Any]]:
    """Return ``prepare``: p -> c, symbols of c, and the expressions in terms of them, dense.

    Parameters
    ----------
    inputs
        Columns of symbols, the parameters last.
    expressions
        SX matrices.
    """
    import casadi

    results, constants, values = _apart(inputs, expressions)
    return casadi.Function("prepare", [inputs[-1]], [values]), constants, results


def _apart(inputs: list[Any], expressions: list[Any]) -> tuple[list[Any], Any, Any]:
    """Return dense expressions in terms of constants, these, and their values."""
    import casadi

    last = len(inputs) - 1
    whole = casadi.cse([casadi.densify(casadi.SX(item)) for item in expressions])
    with as_written():
        function = casadi.Function("all", inputs, whole)
        if function.get_function():
            function = casadi.Function("all", inputs, _split_calls(function, inputs))
        whole = use_reciprocals(function, inputs, lambda source: source[0] == last)
        return _move_apart(casadi.Function("all", inputs, whole), inputs)


def wave_starts(equations: Equations) -> tuple[int, ...]:
    """Return the first block of each run of blocks that do not depend on each other's unknowns."""
    import casadi

    if not equations.blocks:
        return ()
    pattern = casadi.jacobian(equations.residual, equations.algebraic).sparsity()
    needed: dict[int, set[int]] = {}
    for row, column in zip(*pattern.get_triplet(), strict=True):
        needed.setdefault(row, set()).add(column)
    starts = [0]
    for number, block in enumerate(equations.blocks):
        first = equations.blocks[starts[-1]].start
        own = range(block.start, block.stop)
        if any(first <= item < block.start for row in own for item in needed.get(row, ())):
            starts.append(number)
    return tuple(starts)


def event_expressions(equations: Equations) -> list[Any]:
    """Return the functions of the events, in their order, and the column of new values."""
    import casadi

    marks = [equations.event[event.index] for event in equations.events]
    reset = casadi.SX(0, 1) if equations.reset is None else equations.reset
    return [casadi.vertcat(*marks) if marks else casadi.SX(0, 1), reset]


def block_expressions(equations: Equations) -> list[Any]:
    """Return the residual and the Jacobian of each block, one after the other."""
    found: list[Any] = []
    for block in equations.blocks:
        inside = slice(block.start, block.stop)
        residual = equations.residual[inside]
        slopes = equations.slopes
        known = None if slopes is None else slopes[inside, inside]
        unknown = equations.algebraic[inside]
        found += [residual, ops.jacobian(residual, unknown) if known is None else known]
    return found


def count_operations(equations: Equations) -> dict[str, int]:
    """Return the number of operations of prepare, rates, outputs and blocks (all together)."""
    return operations_of(derive_functions(equations))


def operations_of(functions: KernelFunctions) -> dict[str, int]:
    """Return the number of operations of each part; loads and constants do not count."""
    return {
        "prepare": operations_in(functions.prepare),
        "rates": operations_in(functions.rates),
        "outputs": operations_in(functions.outputs),
        "blocks": sum(operations_in(block) for block in functions.blocks),
    }


def operations_in(function: Any) -> int:
    """Return the number of operations of a function, those that it calls included."""
    return _operations_in(function, {})


def _operations_in(function: Any, known: dict[str, int]) -> int:
    """Return the same number, given those of called functions by name, which grow."""
    import casadi

    free = {getattr(casadi, name) for name in _NO_WORK}
    own = sum(function.instruction_id(k) not in free for k in range(function.n_instructions()))
    for item in calls_in(function).values():
        if table_of(item) is not None:
            continue
        if item.name() not in known:
            known[item.name()] = _operations_in(item, known)
        own += known[item.name()] - 1
    return own


@contextmanager
def as_written() -> Iterator[None]:
    """Keep CasADi from turning a times 1/b back into a / b."""
    import casadi

    casadi.GlobalOptions.setSimplificationOnTheFly(False)
    try:
        yield
    finally:
        casadi.GlobalOptions.setSimplificationOnTheFly(True)


def _split_calls(function: Any, inputs: list[Any]) -> list[Any]:
    """Return the results of a function with calls split that need what is fixed.

    What a called function makes of the last input alone, the parameters, is written out before
    the call and given to it.
    """
    import casadi

    nodes, results = read_nodes(function)
    fixed = _fixed_values(nodes, function.n_in() - 1)
    rebuild = Rebuild(function, inputs, nodes)
    values: list[Any] = []
    for index, node in enumerate(nodes):
        code, operands, detail = node
        if code == casadi.OP_CALL and not fixed[index]:
            mask, called = tuple(fixed[item] for item in operands), rebuild.calls[int(detail)]
            if table_of(called) is None:
                values.append(call_apart(called, mask, [values[item] for item in operands]))
                continue
        values.append(rebuild.value(node, values))
    return rebuild.results(results, values)


def _move_apart(function: Any, inputs: list[Any]) -> tuple[list[Any], Any, Any]:
    """Return the results of a function in terms of constants, these, and their values.

    A constant is whatever other parts need of what depends on the last input alone. First come
    those that calls are given, in the order of the calls, so that like calls find them alike.
    """
    import casadi

    source, constant, call = casadi.OP_INPUT, casadi.OP_CONST, casadi.OP_CALL
    nodes, results = read_nodes(function)
    fixed = _fixed_values(nodes, function.n_in() - 1)
    number = [code == constant for code, _, _ in nodes]
    needed = {value for pairs in results for _, value in pairs}
    for (code, operands, _), is_fixed in zip(nodes, fixed, strict=True):
        if not is_fixed and code != source:
            needed.update(operands)
    given = [k for code, operands, _ in nodes if code == call for k in operands]
    order = {k: place for place, k in reversed([*enumerate(given)])}
    wanted = sorted(
        (k for k in needed if fixed[k] and not number[k]),
        key=lambda k: (order.get(k, len(given)), k),
    )
    constants = casadi.SX.sym("constant", len(wanted))
    rebuild = Rebuild(function, inputs, nodes)
    apart: list[Any] = []
    values: list[Any] = []
    names = {value: constants[k] for k, value in enumerate(wanted)}
    for index, node in enumerate(nodes):
        apart.append(rebuild.value(node, apart) if fixed[index] else None)
        plain = number[index] or not fixed[index]
        values.append(rebuild.value(node, values) if plain else names.get(index))
    known = [apart[value] for value in wanted]
    column = casadi.vertcat(*known) if known else casadi.SX(0, 1)
    return rebuild.results(results, values), constants, column


def _fixed_values(nodes: list[Node], parameter_input: int) -> list[bool]:
    """Return for each value whether it depends on nothing but the parameters."""
    return fixed_from(nodes, lambda source: source[0] == parameter_input)
