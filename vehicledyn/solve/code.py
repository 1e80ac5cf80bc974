"""Print an SX function as C in single-assignment form, cut into pieces of bounded size.

The text is written in terms of real.h and elementary.c, so it serves one lane or many.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import groupby
from typing import Any

from vehicledyn.solve.alike import PLACES, Row
from vehicledyn.solve.compiler import CompilationError
from vehicledyn.solve.instructions import (
    CELL,
    CONST,
    ENTRY,
    INPUT,
    KNOT,
    RESULT,
    SHARED,
    Instruction,
    read_function,
)
from vehicledyn.solve.lowering import CONDITIONS, LOOKED_UP, Lowered, is_at_hand, lower
from vehicledyn.solve.rolled import ROOM, Rolled, Rolling, by_demand, is_deep, roll
from vehicledyn.solve.row_code import Copies, row_expression
from vehicledyn.solve.schedule import CALLED, Pack, Step
from vehicledyn.solve.table_rows import ROW
from vehicledyn.symbolic.tables import CurveTable

PIECE = 500
"""Instructions a C function holds at most.

gcc 12 compiles them in a time that grows linearly; the run time is the same within 5 % for 250
to 4000, and least for 500.
"""

_PACK = 4
"""Reals in a vd_pack of real.h."""

_LOADED_AT_ONCE = 4
"""Entries of a cell that are loaded together, those of cubic curves."""

_TEMPLATES = {
    "ASSIGN": "{0}",
    "ADD": "{0} + {1}",
    "SUB": "{0} - {1}",
    "MUL": "{0} * {1}",
    "DIV": "{0} / {1}",
    "NEG": "-{0}",
    "SQ": "{0} * {0}",
    "TWICE": "{0} + {0}",
    "INV": "1.0 / {0}",
    "FMA": "vd_fma({0}, {1}, {2})",
    "FMS": "vd_fms({0}, {1}, {2})",
    "FNMA": "vd_fnma({0}, {1}, {2})",
    "LT": "vd_lt({0}, {1})",
    "LE": "vd_le({0}, {1})",
    "EQ": "vd_eq({0}, {1})",
    "NE": "vd_ne({0}, {1})",
    "NOT": "vd_not({0})",
    "AND": "vd_and({0}, {1})",
    "OR": "vd_or({0}, {1})",
    "IF_ELSE_ZERO": "vd_only({0}, {1})",
    "SELECT": "vd_select({0}, {1}, {2})",
    "FABS": "vd_abs({0})",
    "SQRT": "vd_sqrt({0})",
    "FMIN": "vd_min({0}, {1})",
    "FMAX": "vd_max({0}, {1})",
    "SIGN": "vd_sign({0})",
    CELL: "vd_cell({0}, {table})",
    KNOT: "vd_knot({0}, {table})",
    ENTRY: "vd_entry({0}, {table}, {width}, {power})",
}

_BOUNDED = {"FMIN": "vd_lesser({0}, {1})", "FMAX": "vd_larger({0}, {1})"}
"""The same where the second operand is surely a number."""

_CONDITIONAL = {"NOT": (0,), "AND": (0, 1), "OR": (0, 1), "IF_ELSE_ZERO": (0,), "SELECT": (0,)}
"""Operands that are conditions."""


def print_function(
    function: Any,
    name: str,
    inputs: Sequence[str],
    *,
    tables: Sequence[CurveTable] = (),
    piece: int = PIECE,
    wide: WideFunctions | None = None,
    copies: Copies | None = None,
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
        Those that the function looks up; their rows, see :mod:`vehicledyn.solve.table_rows`,
        follow the numbers of the last input.
    piece
        Instructions a C function holds at most; a longer one calls its pieces in turn.
    wide
        Takes the shared functions that are called at several places at once, for a function
        of one lane.
    copies
        Numbers of the last input that are wanted side by side, for a function of one lane whose
        values are to be computed in rows; see :mod:`vehicledyn.solve.alike`.

    Raises
    ------
    CompilationError
        If the function holds an operation that has no translation.
    """
    program = read_function(function, tables)
    in_rows = copies is not None
    lowered = lower(program, in_rows=in_rows and not program.shared)
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
    rolling = roll(lowered, inputs, places)
    texts = []
    for number in range(len(lowered.shared)):
        text = _print_shared(
            lowered, number, name, widths, piece=piece, rolled=rolling.kinds.get(number)
        )
        if wide is not None and number in places:
            own = _name_of_shared(name, number)
            wide.take(places[number], own, text)
            text = f"void {own}_wide({_SHARED_ARRAYS});\n"
        texts.append(text)
    printer = _Printer(lowered, list(inputs), first_row, widths, name, places, rolling, copies)
    return "".join([*texts, printer.function(name, arrays, piece)])


_SHARED_ARRAYS = "const real *restrict a, const real *restrict rows, real *restrict r0"


@dataclass
class WideFunctions:
    """Shared functions of a kernel of one lane that carry several places side by side.

    The places of one call, such as the wheels of a train, fill the lanes that the cases of a
    sweep fill otherwise. These functions are units of their own, as they see other reals;
    ``units`` holds their text by number of lanes, ``lanes`` is what the processor carries.
    """

    lanes: int
    units: dict[int, list[str]] = field(default_factory=dict)

    def lanes_for(self, lowered: Lowered) -> dict[int, int]:
        """Return the lanes of each shared function that is called at several places at once.

        Where functions wait for one another they are called in loops instead.
        """
        if is_deep(lowered):
            return {}
        most: dict[int, int] = {}
        for step in lowered.steps:
            if isinstance(step, Pack) and step.shared is not None:
                most[step.shared] = max(most.get(step.shared, 0), len(step.operands))
        return {
            number: min(self.lanes, 4 if count <= 4 else 8)
            for number, count in most.items()
            if count > 1 and self.lanes > 1
        }

    def take(self, lanes: int, name: str, text: str) -> None:
        """Keep the text of a shared function, and what other units call it by."""
        entry = f"void {name}_wide({_SHARED_ARRAYS}) {{\n  {name}(a, rows, r0);\n}}\n"
        self.units.setdefault(lanes, []).append(text + entry)


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
    shared, own = lowered.shared[number], _name_of_shared(name, number)
    inner = [_print_shared(shared, k, own, widths, piece=piece) for k in range(len(shared.shared))]
    arrays, names, table = _SHARED_ARRAYS.split(", "), _Names({}, {}), ""
    if rolled is not None:
        given, found = rolled.given, rolled.found
        arrays = [f"const real *restrict a{k}" for k in range(len(given.arrays))]
        arrays += ["const real *restrict rows"]
        arrays += [f"real *restrict r{k}" for k in range(len(found.arrays))]
        names = _Names(
            {k: f"a{group}[{place}]" for k, (group, place) in enumerate(given.places)},
            {k: f"r{group}[{place}]" for k, (group, place) in enumerate(found.places)},
        )
        lines = ",\n".join(f"  {{{', '.join(map(str, row))}}}" for row in rolled.rows)
        width = len(given.arrays) + len(found.arrays)
        table = f"static const int {own}_at[][{width}] = {{\n{lines}\n}};\n"
    inputs = [array.split("restrict ")[1] for array in arrays if array.startswith("const")]
    printer = _Printer(shared, inputs, 0, widths, own, {}, Rolling(), names=names)
    return "".join([*inner, printer.function(own, arrays, piece), table])


@dataclass(frozen=True)
class _Names:
    """Names of inputs and results that are not elements of their arrays, by their number."""

    inputs: dict[int, str]
    results: dict[int, str]


def _name_of_shared(name: str, number: int) -> str:
    return f"{name}_shared_{number}"


def _check(lowered: Lowered, name: str) -> None:
    for function in lowered.shared:
        _check(function, name)
    for item in lowered.values:
        if item.operation in (SHARED, RESULT):
            continue
        if not (is_at_hand(item) or item.operation in _TEMPLATES or item.operation in CALLED):
            raise CompilationError(
                f"the operation {item.operation} in '{name}' has no translation to C; "
                "write the expression with elementary functions to have it compiled"
            )


def _literal(value: float) -> str:
    if math.isnan(value):
        return "NAN"
    if math.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


@dataclass
class _Printer:
    """Prints the steps of a function.

    Inputs and constants are read where they are needed, results stored where they arise; the
    values that a later piece needs are handed on in the array ``s``.
    """

    lowered: Lowered
    inputs: list[str]
    first_row: int
    widths: list[int]
    name: str
    wide: dict[int, int]
    rolling: Rolling
    copies: Copies | None = None
    names: _Names = field(default_factory=lambda: _Names({}, {}))

    def __post_init__(self) -> None:
        self._values = self.lowered.values
        self._rows = {values: number for number, values in enumerate(self.lowered.rows)}
        self._row_of = {
            value: (number, place)
            for values, number in self._rows.items()
            for place, value in enumerate(values)
        }
        self._collected: dict[tuple[int, ...], str] = {}
        self._place = dict(self.rolling.place)
        self._loaded: set[int] = set()
        self._room = self.rolling.room
        self._piece_of: dict[int, int] = {}
        self._called: dict[int | None, int] = defaultdict(int)
        self._arising: dict[int, list[str]] = defaultdict(list)
        for output, element, value in self.lowered.results:
            name = self.names.results.get(element, f"r{output}[{element}]")
            self._arising[value].append(name)

    def function(self, name: str, arrays: list[str], piece: int) -> str:
        """Return the function, in pieces where it is long."""
        pieces = self._cut(piece)
        arising = [*self._place, *self._arising]
        at_hand = [value for value in dict.fromkeys(arising) if is_at_hand(self._values[value])]
        stores = [line for value in at_hand for line in self._stores(value, 0)]
        if len(pieces) <= 1:
            steps = pieces[0] if pieces else []
            self._piece_of = {value: 0 for step in steps for value in _computed(step)}
            room = [f"real {ROOM}[{self._room}];"] if self._room else []
            return _definition(name, arrays, room + stores + self._lines(steps, 0))
        self._share(pieces)
        arguments = ", ".join([*self.inputs, "s", *_outputs(arrays, self.inputs)])
        n = len(self.inputs)
        arrays_in = [*arrays[:n], "real *restrict s", *arrays[n:]]
        aligned = " __attribute__((aligned(32)))" if self._rows else ""
        texts, calls = [], [f"real s[{max(1, self._room)}]{aligned};", *stores]
        for number, steps in enumerate(pieces):
            lines = self._lines(steps, number)
            texts.append("VD_APART " + _definition(f"{name}_{number}", arrays_in, lines))
            calls.append(f"{name}_{number}({arguments});")
        return "".join([*texts, _definition(name, arrays, calls)])

    def _cut(self, piece: int) -> list[list[Step]]:
        """Return the steps in pieces of so many instructions, or one where fewer will not do."""
        pieces: list[list[Step]] = []
        size = piece
        for step in self.lowered.steps:
            if size >= piece:
                pieces.append([])
                size = 0
            pieces[-1].append(step)
            size += 1 if self.rolling.holds(step) else len(_computed(step))
        return pieces

    def _share(self, pieces: list[list[Step]]) -> None:
        """Find the piece of each value, and a place for those that a later piece needs.

        A place is used again once its value is needed no more, so that all stay in the cache.
        """
        last: dict[tuple[int, ...], int] = {}
        for number, steps in enumerate(pieces):
            for step in steps:
                for value in _computed(step):
                    self._piece_of[value] = number
                for value in _operands(self._values, step):
                    if self._piece_of.get(value, number) != number:
                        last[self._together(value)] = number
        ending: dict[int, list[tuple[int, int]]] = defaultdict(list)
        free = _Free(self.rolling.room)
        for number, steps in enumerate(pieces):
            for step in steps:
                for values in dict.fromkeys(map(self._together, _computed(step))):
                    if values in last and values[0] not in self._place:
                        place = free.take(len(values))
                        self._place.update(zip(values, range(place, place + PLACES), strict=False))
                        ending[last[values]].append((place, len(values)))
            free.give(ending[number])
        self._room = free.room

    def _together(self, value: int) -> tuple[int, ...]:
        """Return the values of the row of a value, or itself alone."""
        found = self._row_of.get(value)
        return (value,) if found is None else self.lowered.rows[found[0]]

    def _lines(self, steps: list[Step], piece: int) -> list[str]:
        lines: list[str] = []
        self._loaded = set[int]()
        self._collected = {}
        for number, step in enumerate(steps):
            if isinstance(step, Row):
                lines += self._row_lines(step, piece)
                continue
            if isinstance(step, Pack) and self.rolling.holds(step):
                lines += self._loop(steps, number, piece)
                continue
            if isinstance(step, Pack) and step.shared is not None:
                lines += self._call_shared(step, number, piece)
            elif isinstance(step, Pack):
                lines += self._call(step, number, piece)
            else:
                lines += self._load(step, piece)
                kind = "vd_mask" if self._values[step].operation in CONDITIONS else "real"
                lines.append(f"const {kind} w{step} = {self._expression(step, piece)};")
            for values in dict.fromkeys(map(self._together, _computed(step))):
                lines += self._stores_of(values, piece)
        return lines

    def _row_lines(self, row: Row, piece: int) -> list[str]:
        """Return the lines that compute a row and store what others need of it."""
        number = self._rows[row.values]
        lines: list[str] = []
        given = [
            self._four(
                operands, piece, lines, is_condition=k in _CONDITIONAL.get(row.operation, ())
            )
            for k, operands in enumerate(row.operands)
        ]
        kind = "vd_mask4" if row.operation in CONDITIONS else "vd_four"
        is_number = [all(map(self._is_number, operands)) for operands in row.operands]
        lines.append(f"const {kind} v{number} = {row_expression(row, given, is_number)};")
        return lines + self._stores_of(row.values, piece)

    def _four(
        self, values: tuple[int, ...], piece: int, lines: list[str], *, is_condition: bool = False
    ) -> str:
        """Return an expression for values side by side; add the lines that collect them."""
        item, found = self._values[values[0]], self._rows.get(values)
        if found is not None:
            here = self._piece_of[values[0]] == piece
            text = f"v{found}" if here else f"VD_FOUR_AT(s + {self._place[values[0]]})"
            if (here and item.operation in CONDITIONS) == is_condition:
                return text
            return f"vd4_true({text})" if is_condition else f"vd4_real({text})"
        if values not in self._collected:
            self._collected[values] = f"g{values[0]}_{len(self._collected)}"
            lines.append(
                f"const vd_four {self._collected[values]} = {self._collect(values, piece)};"
            )
        text = self._collected[values]
        return f"vd4_true({text})" if is_condition else text

    def _collect(self, values: tuple[int, ...], piece: int) -> str:
        numbers = [self._number(value, piece) for value in values]
        if len(set(values)) == 1:
            return f"vd4_all({numbers[0]})"
        items = [self._values[value] for value in values]
        if all(item.operation == INPUT for item in items) and self.copies is not None:
            arrays = {item.source[0] for item in items}
            elements = tuple(item.source[1] for item in items)
            if len(arrays) == 1 and elements == tuple(range(elements[0], elements[0] + PLACES)):
                return f"VD_FOUR_AT({self.inputs[items[0].source[0]]} + {elements[0]})"
            if arrays == {len(self.inputs) - 1}:
                return f"VD_FOUR_AT({self.inputs[-1]} + {self.copies.place(elements)})"
        return f"(vd_four){{{', '.join(numbers)}}}"

    def _load(self, step: int, piece: int) -> list[str]:
        """Return what loads all entries of a cell at once, before the first of them is used."""
        item = self._values[step]
        if item.operation != ENTRY or self.widths[item.source[0]] != _LOADED_AT_ONCE:
            return []
        cell = item.operands[0]
        if cell in self._loaded:
            return []
        self._loaded.add(cell)
        row = self._table(item)["table"]
        place = self._number(cell, piece)
        return [f"real e{cell}[4];", f"vd_four_entries({place}, {row}, e{cell});"]

    def _stores_of(self, values: tuple[int, ...], piece: int) -> list[str]:
        """Return the lines that store values, those of a row at once."""
        if len(values) == 1:
            return self._stores(values[0], piece)
        lines: list[str] = []
        if values[0] in self._place:
            text = self._four(values, piece, lines)
            lines.append(f"VD_FOUR_TO(s + {self._place[values[0]]}, {text});")
        for value in values:
            targets = self._arising.get(value, [])
            lines += [f"{target} = {self._number(value, piece)};" for target in targets]
        return lines

    def _stores(self, value: int, piece: int) -> list[str]:
        held = value in self._place and value not in self.rolling.results
        targets = [f"s[{self._place[value]}]"] if held else []
        targets += self._arising.get(value, [])
        return [f"{target} = {self._number(value, piece)};" for target in targets]

    def _call(self, pack: Pack, number: int, piece: int) -> list[str]:
        """Return the lines that gather operands, call the function and take its values."""
        n = len(pack.operands)
        given = [f"a{number}_{k}" for k in range(len(pack.operands[0]))]
        found = [f"b{number}_{k}" for k in range(len(pack.values[0]))]
        lines: list[str] = []
        for name, operands in zip(given, zip(*pack.operands, strict=True), strict=True):
            filled = operands + operands[-1:] * (-n % _PACK)
            fours = [filled[k : k + _PACK] for k in range(0, n, _PACK)]
            packs = ", ".join(self._pack(four, piece, lines) for four in fours)
            lines.append(f"vd_pack {name}[] = {{{packs}}};")
        room = math.ceil(n / _PACK)
        lines.append("vd_pack " + ", ".join(f"{name}[{room}]" for name in found) + ";")
        arrays = ", ".join(f"(double *){name}" for name in given + found)
        lines.append(f"vd_{pack.function}({n} * VD_LANES, {arrays});")
        for name, values in zip(found, zip(*pack.values, strict=True), strict=True):
            for first in range(0, n, _PACK):
                four = values[first : first + _PACK]
                if four in self._rows:
                    row = self._rows[four]
                    lines.append(f"const vd_four v{row} = {name}[{first // _PACK}];")
                else:
                    lines += _taken(four, f"((real *){name})", f"{first} + {{}}")
        return lines

    def _pack(self, values: tuple[int, ...], piece: int, lines: list[str]) -> str:
        """Return the operands of four calls side by side."""
        if values in self._rows:
            return self._four(values, piece, lines)
        return f"VD_PACK({', '.join(self._number(value, piece) for value in values)})"

    def _call_shared(self, pack: Pack, number: int, piece: int) -> list[str]:
        """Return the lines that lay out arguments, call a shared function and take its values."""
        own, rows = _name_of_shared(self.name, pack.shared or 0), self.first_row
        if pack.shared in self.wide:
            return self._call_wide(pack, number, piece, self.wide[pack.shared])
        lines = []
        for k, (operands, values) in enumerate(zip(pack.operands, pack.values, strict=True)):
            given = ", ".join(self._number(operand, piece) for operand in operands)
            lines += [
                f"const real a{number}_{k}[] = {{{given}}};",
                f"real b{number}_{k}[{max(1, len(values))}];",
                f"{own}(a{number}_{k}, {self.inputs[-1]} + {rows}, b{number}_{k});",
                *_taken(values, f"b{number}_{k}", "{}"),
            ]
        return lines

    def _loop(self, steps: list[Step], number: int, piece: int) -> list[str]:
        """Return the loop over calls of one function, written where the first of them stands.

        Results of the calls are stored after the last of them.
        """
        packs: list[Pack] = []
        for step in steps[number:]:
            if not isinstance(step, Pack) or (packs and step.shared != packs[0].shared):
                break
            packs.append(step)
        before = steps[number - 1] if number else None
        shared = packs[0].shared or 0
        if isinstance(before, Pack) and before.shared == shared:
            return []
        calls = [operands for item in packs for operands in item.operands]
        first = self._called[shared]
        self._called[shared] += len(calls)
        starts = self.rolling.kinds[shared].given.starts
        lines = []
        for is_apart, group in groupby(range(len(calls)), lambda k: starts[first + k] is None):
            numbers = list(group)
            if is_apart:
                for k in numbers:
                    lines += self._call_apart(shared, first + k, calls[k], piece)
            else:
                lines += self._calls_in_loop(shared, first + numbers[0], len(numbers))
        stored = [v for pack in packs for v in pack.computed]
        return lines + [line for v in stored for line in self._stores(v, piece)]

    def _calls_in_loop(self, shared: int, first: int, count: int) -> list[str]:
        """Return a loop over calls that find their numbers by the function's table."""
        rolled, own = self.rolling.kinds[shared], _name_of_shared(self.name, shared)
        row = sum(start is not None for start in rolled.given.starts[:first])
        arrays = [*rolled.given.arrays, *rolled.found.arrays]
        arguments = [f"{array} + n[{k}]" for k, array in enumerate(arrays)]
        arguments.insert(len(rolled.given.arrays), f"{self.inputs[-1]} + {self.first_row}")
        return [
            f"for (int k = {row}; k < {row + count}; k++) {{",
            f"  const int *n = {own}_at[k];",
            f"  {own}({', '.join(arguments)});",
            "}",
        ]

    def _call_apart(
        self, shared: int, call: int, operands: tuple[int, ...], piece: int
    ) -> list[str]:
        """Return a call that finds some of its numbers elsewhere: they are laid side by side."""
        rolled, own = self.rolling.kinds[shared], _name_of_shared(self.name, shared)
        sizes = [0] * len(rolled.given.arrays)
        for group, place in rolled.given.places:
            sizes[group] = max(sizes[group], place + 1)
        laid = [["vd_all(0.0)"] * size for size in sizes]
        for (group, place), operand in zip(rolled.given.places, operands, strict=True):
            laid[group][place] = self._number(operand, piece)
        names = [f"a{shared}_{call}_{group}" for group in range(len(sizes))]
        found = rolled.found.starts[call] or []
        results = [f"{ROOM} + {place}" for place in found]
        rows = f"{self.inputs[-1]} + {self.first_row}"
        return [
            *(
                f"const real {name}[] = {{{', '.join(numbers)}}};"
                for name, numbers in zip(names, laid, strict=True)
            ),
            f"{own}({', '.join([*names, rows, *results])});",
        ]

    def _call_wide(self, pack: Pack, number: int, piece: int, lanes: int) -> list[str]:
        """Return the lines of calls that carry several places at once, the last ones repeated."""
        n_given, n_found = len(pack.operands[0]), max(1, len(pack.values[0]))
        n_rows = ROW * len(self.widths)
        rows, room = f"t{number}", "__attribute__((aligned(64)))"
        lines = [
            f"real {rows}[{max(1, n_rows * lanes)}] {room};",
            f"for (int k = 0; k < {n_rows * lanes}; k++)",
            f"  {rows}[k] = {self.inputs[-1]}[{self.first_row} + k / {lanes}];",
        ]
        own = _name_of_shared(self.name, pack.shared or 0)
        for first in range(0, len(pack.operands), lanes):
            calls = pack.operands[first : first + lanes]
            calls = calls + [calls[-1]] * (lanes - len(calls))
            given, found = f"a{number}_{first}", f"b{number}_{first}"
            numbers = [
                self._number(calls[lane][k], piece) for k in range(n_given) for lane in range(lanes)
            ]
            lines += [
                f"const real {given}[] {room} = {{{', '.join(numbers)}}};",
                f"real {found}[{n_found * lanes}] {room};",
                f"{own}_wide({given}, {rows}, {found});",
            ]
            for lane, values in enumerate(pack.values[first : first + lanes]):
                lines += _taken(values, found, f"{lanes} * {{}} + {lane}")
        return lines

    def _expression(self, index: int, piece: int) -> str:
        item = self._values[index]
        if item.operation == ENTRY and item.operands[0] in self._loaded:
            return f"e{item.operands[0]}[{item.source[1]}]"
        conditions = _CONDITIONAL.get(item.operation, ())
        names = [
            self._condition(operand, piece) if k in conditions else self._number(operand, piece)
            for k, operand in enumerate(item.operands)
        ]
        if item.operation in _BOUNDED:
            bounds = [k for k, operand in enumerate(item.operands) if self._is_number(operand)]
            if bounds:
                return _BOUNDED[item.operation].format(names[1 - bounds[-1]], names[bounds[-1]])
        return _TEMPLATES[item.operation].format(*names, **self._table(item))

    def _table(self, item: Instruction) -> dict[str, str | int]:
        """Return what the template of a look-up asks for."""
        if item.operation not in LOOKED_UP:
            return {}
        table, power = item.source
        row = f"{self.inputs[-1]} + {self.first_row + ROW * table}"
        return {"table": row, "width": self.widths[table], "power": power}

    def _is_number(self, index: int) -> bool:
        item = self._values[index]
        return item.operation == CONST and not math.isnan(item.number)

    def _number(self, index: int, piece: int) -> str:
        item = self._values[index]
        if item.operation in CONDITIONS and self._piece_of[index] == piece:
            return f"vd_real({self._reference(index, item, piece)})"
        return self._reference(index, item, piece)

    def _condition(self, index: int, piece: int) -> str:
        item = self._values[index]
        if item.operation in CONDITIONS and self._piece_of[index] == piece:
            return self._reference(index, item, piece)
        return f"vd_true({self._reference(index, item, piece)})"

    def _reference(self, index: int, item: Instruction, piece: int) -> str:
        if item.operation == INPUT and item.source[1] in self.names.inputs:
            return self.names.inputs[item.source[1]]
        if item.operation == INPUT:
            return f"{self.inputs[item.source[0]]}[{item.source[1]}]"
        if item.operation == CONST:
            return f"vd_all({_literal(item.number)})"
        if self._piece_of[index] != piece or index in self.rolling.results:
            return f"s[{self._place[index]}]"
        if index in self._row_of:
            row, place = self._row_of[index]
            return f"v{row}[{place}]"
        return f"w{index}"


class _Free:
    """Places of an array that may be used, from some place on.

    Those of whole rows begin at multiples of their length.
    """

    def __init__(self, room: int) -> None:
        self.room = room
        self._whole: list[int] = []
        self._single: list[int] = []

    def take(self, size: int) -> int:
        """Return the first of so many places."""
        if size == 1 and self._single:
            return self._single.pop()
        if not self._whole:
            self._whole.append(self.room)
            self.room += PLACES
        first = self._whole.pop()
        if size == 1:
            self._single += range(first + PLACES - 1, first, -1)
        return first

    def give(self, places: list[tuple[int, int]]) -> None:
        """Take places back, with their number."""
        for first, size in places:
            (self._single if size == 1 else self._whole).append(first)


def _taken(values: Sequence[int | None], array: str, place: str) -> list[str]:
    """Return the lines that take the values of a call from an array."""
    return [
        f"const real w{value} = {array}[{place.format(k)}];"
        for k, value in enumerate(values)
        if value is not None
    ]


def _computed(step: Step) -> list[int]:
    return [step] if isinstance(step, int) else step.computed


def _operands(values: list[Instruction], step: Step) -> list[int]:
    if isinstance(step, int):
        return list(values[step].operands)
    return [operand for group in step.operands for operand in group]


def _outputs(arrays: list[str], inputs: list[str]) -> list[str]:
    return [f"r{k}" for k in range(len(arrays) - len(inputs))]


def _definition(name: str, arrays: Sequence[str], lines: Sequence[str]) -> str:
    body = "\n".join(f"  {line}" for line in lines)
    return f"static void {name}({', '.join(arrays)}) {{\n{body}\n}}\n"
