"""Print calls of elementary and of shared functions: lay out operands, call, take the values."""

from __future__ import annotations

import math

from vehicledyn.codegen.ir.instructions import INPUT
from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.scheduling import Pack
from vehicledyn.codegen.passes.scratch_allocation import PACK, ROOM
from vehicledyn.codegen.printers.function_body import name_of_shared
from vehicledyn.codegen.printers.row_packing import SideBySide
from vehicledyn.codegen.printers.value_printer import PieceValues, taken


def elementary_calls(values: PieceValues, fours: SideBySide, pack: Pack, number: int) -> list[str]:
    """Return the lines of calls of an elementary function; ``number`` is that of the step."""
    firsts = values.body.rolling.held.packs.get(pack.computed[0])
    if firsts is not None:
        return _calls_in_place(values, pack, number, firsts)
    n, rows = len(pack.operands), values.body.rows
    given = [f"a{number}_{k}" for k in range(len(pack.operands[0]))]
    found = [f"b{number}_{k}" for k in range(len(pack.values[0]))]
    lines: list[str] = []

    def packed(operands: tuple[int, ...]) -> str:
        if operands in rows:
            return fours.four(operands, lines)
        return f"VD_PACK({', '.join(values.number(operand) for operand in operands)})"

    for name, operands in zip(given, zip(*pack.operands, strict=True), strict=True):
        filled = operands + operands[-1:] * (-n % PACK)
        packs = ", ".join(packed(filled[k : k + PACK]) for k in range(0, n, PACK))
        lines.append(f"vd_pack {name}[] = {{{packs}}};")
    room = math.ceil(n / PACK)
    lines.append("vd_pack " + ", ".join(f"{name}[{room}]" for name in found) + ";")
    lines.append(_call(pack.function, n, given, found))
    for name, results in zip(found, zip(*pack.values, strict=True), strict=True):
        for first in range(0, n, PACK):
            four = results[first : first + PACK]
            if four in rows:
                lines.append(f"const vd_four v{rows[four]} = {name}[{first // PACK}];")
            else:
                lines += taken(four, f"((real *){name})", f"{first} + {{}}")
    return lines


def _calls_in_place(values: PieceValues, pack: Pack, number: int, firsts: list[int]) -> list[str]:
    """Return the lines of calls whose results go to places side by side.

    Arguments that lie side by side are read where they are, as far as they fill whole packs.
    """
    n = len(pack.operands)
    there = n - n % PACK if _lie_side_by_side(values, pack) else 0
    columns = list(zip(*pack.operands, strict=True))
    lines = []
    if there:
        given = [f"&{values.number(column[0])}" for column in columns]
        lines.append(_call(pack.function, there, given, [f"{ROOM} + {k}" for k in firsts]))
    if there < n:
        given = [f"a{number}_{k}" for k in range(len(columns))]
        for name, column in zip(given, columns, strict=True):
            filled = [values.number(operand) for operand in column[there:]]
            filled += filled[-1:] * (-n % PACK)
            packs = [filled[k : k + PACK] for k in range(0, len(filled), PACK)]
            laid = ", ".join(f"VD_PACK({', '.join(numbers)})" for numbers in packs)
            lines.append(f"vd_pack {name}[] = {{{laid}}};")
        found = [f"{ROOM} + {k + there}" for k in firsts]
        lines.append(_call(pack.function, n - there, given, found))
    return lines


def _call(function: str, count: int, given: list[str], found: list[str]) -> str:
    arrays = ", ".join(f"(double *)({name})" for name in given + found)
    return f"vd_{function}({count} * VD_LANES, {arrays});"


def _lie_side_by_side(values: PieceValues, pack: Pack) -> bool:
    """Return whether each argument of the calls is an input beside that of the call before."""
    items = values.body.values
    for column in zip(*pack.operands, strict=True):
        if any(items[operand].operation != INPUT for operand in column):
            return False
        array, first = items[column[0]].source
        if any(items[v].source != (array, first + k) for k, v in enumerate(column)):
            return False
    return True


def shared_calls(values: PieceValues, pack: Pack, number: int) -> list[str]:
    """Return the lines of calls of a shared function; ``number`` is that of the step."""
    body = values.body
    if pack.shared in body.wide:
        return _wide_calls(values, pack, number, body.wide[pack.shared])
    own = name_of_shared(body.name, pack.shared or 0)
    lines = []
    for k, (operands, results) in enumerate(zip(pack.operands, pack.values, strict=True)):
        given = ", ".join(values.number(operand) for operand in operands)
        lines += [
            f"const real a{number}_{k}[] = {{{given}}};",
            f"real b{number}_{k}[{max(1, len(results))}];",
            f"{own}(a{number}_{k}, {body.table_row()}, b{number}_{k});",
            *taken(results, f"b{number}_{k}", "{}"),
        ]
    return lines


def _wide_calls(values: PieceValues, pack: Pack, number: int, lanes: int) -> list[str]:
    """Return the lines of calls that carry several places at once, the last ones repeated."""
    body = values.body
    n_given, n_found = len(pack.operands[0]), max(1, len(pack.values[0]))
    own, room = name_of_shared(body.name, pack.shared or 0), "__attribute__((aligned(64)))"
    rows, lines = "(const real *)0", []
    if body.lowered.shared[pack.shared or 0].looks_up:
        rows, n_rows = f"t{number}", ROW * len(body.widths)
        lines = [
            f"real {rows}[{n_rows * lanes}] {room};",
            f"for (int k = 0; k < {n_rows}; k++)",
            f"  for (int lane = 0; lane < {lanes}; lane++)",
            f"    {rows}[{lanes} * k + lane] = {body.inputs[-1]}[{body.first_row} + k];",
        ]
    for first in range(0, len(pack.operands), lanes):
        calls = pack.operands[first : first + lanes]
        calls = calls + [calls[-1]] * (lanes - len(calls))
        given, found = f"a{number}_{first}", f"b{number}_{first}"
        numbers = [values.number(calls[lane][k]) for k in range(n_given) for lane in range(lanes)]
        lines += [
            f"const real {given}[] {room} = {{{', '.join(numbers)}}};",
            f"real {found}[{n_found * lanes}] {room};",
            f"{own}_wide({given}, {rows}, {found});",
        ]
        for lane, results in enumerate(pack.values[first : first + lanes]):
            lines += taken(results, found, f"{lanes} * {{}} + {lane}")
    return lines
