"""Print the rows of a linear program as straight C for several directions side by side.

A row's sum stays in a register as long as the rows after it in the same function want it. What
the constants contribute is left out: which of them move is known at run time only.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from vehicledyn.codegen.passes.linear_program import Program

_PIECE = 400
"""Entries a C function holds at most."""


def print_rows(program: Program, constants: range, name: str, kept: Sequence[int] = ()) -> str:
    """Return C functions ``name(w, b, t)`` that write the rows into the columns t.

    Parameters
    ----------
    program
        The rows.
    constants
        The columns of the sources that are constants.
    name
        Name of the function; ``b`` holds what the constants contribute to each row.
    kept
        Columns that are written whatever uses them, besides the targets.
    """
    touched = [any(c in constants for c in _columns(program, k)) for k in range(len(program.out))]
    style = _Style(name, constants, range(0), touched)
    return _printed(program, style, {*map(int, program.targets), *kept})


def print_rows_back(program: Program, added: range, name: str, seeded: Sequence[int]) -> str:
    """Return C functions ``name(w, b, t)`` that write adjoints into the columns t.

    Parameters
    ----------
    program
        The transposed rows.
    added
        Columns to which is added, where others are written.
    name
        Name of the function; ``b`` holds the seeds of rows.
    seeded
        Columns that have seeds.
    """
    own = set(seeded)
    touched = [int(column) in own for column in program.out]
    return _printed(program, _Style(name, range(0), added, touched), set(map(int, program.targets)))


@dataclass(frozen=True)
class _Style:
    """Name of the function, columns left out, columns added to, rows that begin with b."""

    name: str
    left_out: range
    added: range
    touched: list[bool]


def _printed(program: Program, style: _Style, kept: set[int]) -> str:
    pieces, name = list(_pieces(program)), style.name
    last_use = dict.fromkeys(kept, len(pieces))
    for number, piece in enumerate(pieces):
        for k in piece:
            for column in _columns(program, k):
                last_use[column] = max(last_use.get(column, 0), number)
    texts = []
    for number, piece in enumerate(pieces):
        head = f"static VD_APART void {name}_{number}(const double *w, const real *b, real *t) {{"
        lines, own = [head], set[int]()
        for k in piece:
            target = int(program.out[k])
            text = _sum(program, k, style.left_out, own, touched=style.touched[k])
            if target in style.added:
                lines.append(f"  t[{target}] += {text};")
                continue
            own.add(target)
            lines.append(f"  const real r{target} = {text};")
            if last_use.get(target, -1) > number:
                lines.append(f"  t[{target}] = r{target};")
        texts.append("\n".join([*lines, "}"]))
    calls = "".join(f"\n  {name}_{number}(w, b, t);" for number in range(len(pieces)))
    head = f"static void {name}(const double *w, const real *b, real *t) {{{calls}\n}}"
    return "\n".join([*texts, head])


def _columns(program: Program, k: int) -> list[int]:
    return [int(item) for item in program.columns[program.starts[k] : program.starts[k + 1]]]


def _pieces(program: Program) -> Iterator[list[int]]:
    piece: list[int] = []
    entries = 0
    for k in range(len(program.out)):
        piece.append(k)
        entries += int(program.starts[k + 1] - program.starts[k])
        if entries >= _PIECE:
            yield piece
            piece, entries = [], 0
    if piece:
        yield piece


def _sum(program: Program, k: int, constants: range, own: set[int], *, touched: bool) -> str:
    text = f"b[{k}]" if touched else ""
    for i in range(program.starts[k], program.starts[k + 1]):
        column, weight = int(program.columns[i]), int(program.which[i])
        if column in constants:
            continue
        value = f"r{column}" if column in own else f"t[{column}]"
        text = f"vd_fma(vd_all(w[{weight}]), {value}, {text})" if text else f"w[{weight}] * {value}"
    return text or "vd_all(0.0)"
