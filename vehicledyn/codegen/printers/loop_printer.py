"""Print calls of shared functions in loops over tables of places, see loop_rolling.py."""

from __future__ import annotations

from itertools import groupby

from vehicledyn.codegen.passes.loop_rolling import Rolled
from vehicledyn.codegen.passes.scheduling import Pack, Step
from vehicledyn.codegen.printers.function_body import FunctionBody, name_of_shared
from vehicledyn.codegen.printers.value_printer import PieceValues


def place_table(rolled: Rolled, own: str) -> str:
    """Return the table that gives the places of the calls of the function ``own``."""
    lines = ",\n".join(f"  {{{', '.join(map(str, row))}}}" for row in rolled.rows)
    width = len(rolled.given.arrays) + len(rolled.found.arrays)
    return f"static const int {own}_at[][{width}] = {{\n{lines}\n}};\n"


def following_packs(steps: list[Step], number: int) -> list[Pack]:
    """Return calls of one function that follow one another from a step on.

    None where the step before calls that function too, as they are printed there.
    """
    packs: list[Pack] = []
    for step in steps[number:]:
        if not isinstance(step, Pack) or (packs and step.shared != packs[0].shared):
            break
        packs.append(step)
    before = steps[number - 1] if number else None
    is_printed = isinstance(before, Pack) and before.shared == packs[0].shared
    return [] if is_printed else packs


def loop_lines(values: PieceValues, packs: list[Pack], first: int) -> list[str]:
    """Return the lines of calls of one function that follow one another.

    ``first`` is the number of the first among all calls of the function. Results are stored after
    the last call.
    """
    shared = packs[0].shared or 0
    calls = [operands for pack in packs for operands in pack.operands]
    starts = values.body.rolling.kinds[shared].given.starts
    lines = []
    for is_apart, group in groupby(range(len(calls)), lambda k: starts[first + k] is None):
        numbers = list(group)
        if is_apart:
            for k in numbers:
                lines += _call_apart(values, shared, first + k, calls[k])
        else:
            lines += _calls_in_loop(values.body, shared, first + numbers[0], len(numbers))
    stored = [value for pack in packs for value in pack.computed]
    return lines + [line for value in stored for line in values.stores(value)]


def _calls_in_loop(body: FunctionBody, shared: int, first: int, count: int) -> list[str]:
    """Return a loop over calls that find their numbers by the function's table."""
    rolled, own = body.rolling.kinds[shared], name_of_shared(body.name, shared)
    row = sum(start is not None for start in rolled.given.starts[:first])
    arrays = [*rolled.given.arrays, *rolled.found.arrays]
    arguments = [f"{array} + n[{k}]" for k, array in enumerate(arrays)]
    arguments.insert(len(rolled.given.arrays), body.table_row())
    return [
        f"for (int k = {row}; k < {row + count}; k++) {{",
        f"  const int *n = {own}_at[k];",
        f"  {own}({', '.join(arguments)});",
        "}",
    ]


def _call_apart(
    values: PieceValues, shared: int, call: int, operands: tuple[int, ...]
) -> list[str]:
    """Return a call that finds some of its numbers elsewhere: they are laid side by side."""
    body = values.body
    rolled, own = body.rolling.kinds[shared], name_of_shared(body.name, shared)
    sizes = [0] * len(rolled.given.arrays)
    for group, place in rolled.given.places:
        sizes[group] = max(sizes[group], place + 1)
    laid = [["vd_all(0.0)"] * size for size in sizes]
    for (group, place), operand in zip(rolled.given.places, operands, strict=True):
        laid[group][place] = values.number(operand)
    names = [f"a{shared}_{call}_{group}" for group in range(len(sizes))]
    found = rolled.found.starts[call] or []
    results = [
        f"{array} + {place}" for array, place in zip(rolled.found.arrays, found, strict=True)
    ]
    return [
        *(
            f"const real {name}[] = {{{', '.join(numbers)}}};"
            for name, numbers in zip(names, laid, strict=True)
        ),
        f"{own}({', '.join([*names, body.table_row(), *results])});",
    ]
