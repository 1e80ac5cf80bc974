"""Print an SX function as C in single-assignment form, cut into pieces of bounded size.

The text is written in terms of real.h and elementary.c, so it serves one lane or many.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from vehicledyn.codegen.ir.instructions import RESULT, SHARED, read_function
from vehicledyn.codegen.passes.loop_rolling import Rolled, by_demand, is_deep, roll
from vehicledyn.codegen.passes.lowering import Lowered, is_at_hand, lower
from vehicledyn.codegen.passes.scheduling import CALLED
from vehicledyn.codegen.passes.scratch_allocation import ROOM
from vehicledyn.codegen.passes.signed_constants import Signed
from vehicledyn.codegen.passes.tail_scheduling import order_tail
from vehicledyn.codegen.printers.dead_piece_elimination import MOST_PIECES, pieces_needed
from vehicledyn.codegen.printers.function_body import (
    SHARED_ARRAYS,
    FunctionBody,
    OwnNames,
    name_of_shared,
)
from vehicledyn.codegen.printers.function_splitting import cut, find_places
from vehicledyn.codegen.printers.loop_printer import place_table
from vehicledyn.codegen.printers.operations import KERNEL
from vehicledyn.codegen.printers.piece_printer import PieceCode
from vehicledyn.codegen.printers.row_printer import Copies
from vehicledyn.codegen.printers.value_printer import PieceValues
from vehicledyn.codegen.printers.wide_functions import WideFunctions
from vehicledyn.codegen.toolchain.compiler import CompilationError
from vehicledyn.symbolic.tables import CurveTable

PIECE = 500
"""Instructions a C function holds at most.

gcc 12 compiles them in a time that grows linearly; the run time is the same within 5 % for 250
to 4000, and least for 500.
"""


def print_function(
    function: Any,
    name: str,
    inputs: Sequence[str],
    *,
    tables: Sequence[CurveTable] = (),
    piece: int = PIECE,
    wide: WideFunctions | None = None,
    copies: Copies | None = None,
    mirrored: dict[int, Signed] | None = None,
    selectable: bool = False,
) -> str:
    """Return the C text of an SX function with dense inputs.

    The C function is ``static void name(const real *input_1, ..., real *r0, ...)``; each
    result array holds the structural nonzeros of that output, column by column.

    Parameters
    ----------
    function
        A ``casadi.Function`` made of SX expressions.
    name
        Name of the C function.
    inputs
        C names of the input arrays, in the order of the function's inputs.
    tables
        Those that the function looks up; their rows, see :mod:`vehicledyn.codegen.ir.table_rows`,
        follow the numbers of the last input.
    piece
        Instructions a C function holds at most; a longer one calls its pieces in turn.
    wide
        Takes the shared functions that are called at several places at once, for a function
        of one lane.
    copies
        Numbers of the last input that are wanted side by side, for a function of one lane whose
        values are to be computed in rows; see :mod:`vehicledyn.codegen.passes.slp_rows`.
    mirrored
        Numbers of the last input for which others stand, for a function of several lanes; see
        :mod:`vehicledyn.codegen.passes.signed_constants`.
    selectable
        Whether a function ``name_selected`` is printed as well, which takes the pieces to compute,
        as bits, before its arrays; ``name_need`` gives those that an element of the first
        result needs.

    Raises
    ------
    CompilationError
        If the function holds an operation that has no translation.
    """
    program = read_function(function, tables)
    in_rows = copies is not None
    lowered = lower(
        program,
        in_rows=in_rows and not program.shared,
        mirrored=mirrored,
        constants=function.n_in() - 1,
    )
    _check(lowered, function.name())
    arrays = [f"const real *restrict {item}" for item in inputs]
    arrays += [f"real *restrict r{k}" for k in range(function.n_out())]
    first_row = function.numel_in(function.n_in() - 1)
    widths = [table.order + 1 for table in tables]
    places = {} if wide is None else wide.lanes_for(lowered)
    if is_deep(lowered):
        lowered = by_demand(lowered)
    elif in_rows and program.shared:
        lowered = lower(program, in_rows=True)
    else:
        lowered = replace(lowered, steps=order_tail(lowered.values, lowered.steps))
    rolling = roll(lowered, inputs, places)
    texts = []
    for number in range(len(lowered.shared)):
        text = _print_shared(
            lowered, number, name, widths, piece=piece, rolled=rolling.kinds.get(number)
        )
        if wide is not None and number in places:
            own = name_of_shared(name, number)
            wide.take(places[number], own, text)
            text = f"void {own}_wide({SHARED_ARRAYS});\n"
        texts.append(text)
    body = FunctionBody(
        lowered, list(inputs), name, widths, first_row, places, rolling=rolling, copies=copies
    )
    return "".join([*texts, _function(body, arrays, piece, selectable=selectable)])


def _print_shared(
    lowered: Lowered,
    number: int,
    name: str,
    widths: list[int],
    *,
    piece: int,
    rolled: Rolled | None = None,
) -> str:
    """Return a function that a function calls, named after it; ``rows`` are its tables.

    One that is called in loops is followed by the table of its places.
    """
    shared, own = lowered.shared[number], name_of_shared(name, number)
    inner = [_print_shared(shared, k, own, widths, piece=piece) for k in range(len(shared.shared))]
    arrays, names, table = SHARED_ARRAYS.split(", "), OwnNames(), ""
    if rolled is not None:
        given, found = rolled.given, rolled.found
        arrays = [f"const real *restrict a{k}" for k in range(len(given.arrays))]
        arrays += ["const real *restrict rows"]
        arrays += [f"real *restrict r{k}" for k in range(len(found.arrays))]
        names = OwnNames(
            {k: f"a{group}[{place}]" for k, (group, place) in enumerate(given.places)},
            {k: f"r{group}[{place}]" for k, (group, place) in enumerate(found.places)},
        )
        table = place_table(rolled, own)
    inputs = [array.split("restrict ")[1] for array in arrays if array.startswith("const")]
    body = FunctionBody(shared, inputs, own, widths, names=names)
    return "".join([*inner, _function(body, arrays, piece), table])


def _check(lowered: Lowered, name: str) -> None:
    for function in lowered.shared:
        _check(function, name)
    for item in lowered.values:
        if item.operation in (SHARED, RESULT):
            continue
        if not (is_at_hand(item) or KERNEL.has(item.operation) or item.operation in CALLED):
            raise CompilationError(
                f"the operation {item.operation} in '{name}' has no translation to C; "
                "write the expression with elementary functions to have it compiled"
            )


def _function(
    body: FunctionBody, arrays: list[str], piece: int, *, selectable: bool = False
) -> str:
    """Return the function of a body, in pieces where it is long."""
    pieces = cut(body, piece)
    places = find_places(body, pieces)
    called: Counter[int] = Counter()
    values = [PieceValues(body, places, number) for number in range(max(1, len(pieces)))]
    arising = dict.fromkeys([*body.rolling.held.place, *body.results])
    at_hand = [value for value in arising if is_at_hand(body.values[value])]
    stores = [line for value in at_hand for line in values[0].stores(value)]
    codes = [
        PieceCode(own, called).lines(steps) for own, steps in zip(values, pieces, strict=False)
    ]
    if selectable and len(codes) <= MOST_PIECES and not body.rolling.kinds:
        needs = pieces_needed(body, pieces, places)
    else:
        needs = [-1] * sum(output == 0 for output, _, _ in body.lowered.results)
    if len(codes) <= 1 and not selectable:
        room = [f"real {ROOM}[{places.room}];"] if places.room else []
        return _definition(body.name, arrays, [*room, *stores, *(codes[0] if codes else [])])
    n = len(body.inputs)
    results = [f"r{k}" for k in range(len(arrays) - n)]
    arguments = ", ".join([*body.inputs, ROOM, *results])
    arrays_in = [*arrays[:n], f"real *restrict {ROOM}", *arrays[n:]]
    aligned = " __attribute__((aligned(32)))" if body.rows else ""
    texts, calls = [], [f"real {ROOM}[{max(1, places.room)}]{aligned};", *stores]
    for number, lines in enumerate(codes):
        texts.append("VD_APART " + _definition(f"{body.name}_{number}", arrays_in, lines))
        chosen = f"if (pieces >> {number % MOST_PIECES} & 1) " if selectable else ""
        calls.append(f"{chosen}{body.name}_{number}({arguments});")
    if not selectable:
        return "".join([*texts, _definition(body.name, arrays, calls)])
    bits, arguments = "unsigned long long", ", ".join([*body.inputs, *results])
    numbers = ", ".join(f"{need % (1 << MOST_PIECES)}ULL" for need in needs) or "0"
    return "".join(
        [
            *texts,
            f"static const {bits} {body.name}_needs[] = {{{numbers}}};\n",
            f"static {bits} {body.name}_need(int k) {{\n  return {body.name}_needs[k];\n}}\n",
            _definition(f"{body.name}_selected", [f"{bits} pieces", *arrays], calls),
            _definition(body.name, arrays, [f"{body.name}_selected(-1ULL, {arguments});"]),
        ]
    )


def _definition(name: str, arrays: Sequence[str], lines: Sequence[str]) -> str:
    body = "\n".join(f"  {line}" for line in lines)
    return f"static void {name}({', '.join(arrays)}) {{\n{body}\n}}\n"
