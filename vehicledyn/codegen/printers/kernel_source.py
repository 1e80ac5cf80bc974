"""Assemble the C source of a kernel: printed functions, tables of the blocks and the loop.

A large kernel comes in units, so that the compiler works on one while the next is printed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vehicledyn.codegen.ir.instructions import read_function
from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.kernel_functions import (
    COUNTED,
    KernelFunctions,
    operations_in,
    operations_of,
)
from vehicledyn.codegen.passes.signed_constants import Signed, mirrored_constants
from vehicledyn.codegen.passes.slp_rows import PLACES
from vehicledyn.codegen.printers.c_printer import print_function
from vehicledyn.codegen.printers.row_printer import Copies
from vehicledyn.codegen.printers.wide_functions import WideFunctions
from vehicledyn.codegen.toolchain.compiler import UNIT_BREAK, suitable_lanes
from vehicledyn.symbolic.equations import Equations

_ARGUMENTS = ("t", "x", "z", "c")

_LARGE = 4_000
"""Operations of rates and outputs from which each is a unit of its own."""


def kernel_source(equations: Equations, functions: KernelFunctions) -> str:
    """Return the complete C source of a kernel for one case, for this processor."""
    return UNIT_BREAK.join(kernel_units(equations, functions))


def kernel_units(equations: Equations, functions: KernelFunctions) -> Iterator[str]:
    """Yield the same source unit by unit, each once it is printed; only the last knows all."""
    return _units(equations, functions, suitable_lanes())


def comes_in_units(functions: KernelFunctions) -> bool:
    """Return whether rates and outputs are large enough for units of their own."""
    return sum(map(operations_in, (functions.rates, functions.outputs))) >= _LARGE


def portable_source(equations: Equations, functions: KernelFunctions) -> str:
    """Return the complete C source of a kernel for one case, for any processor."""
    return UNIT_BREAK.join(_units(equations, functions, 1))


def _units(equations: Equations, functions: KernelFunctions, lanes: int) -> Iterator[str]:
    events = [
        events_text(equations, functions),
        print_function(functions.resets, "resets", _ARGUMENTS, tables=equations.tables),
    ]
    wide = WideFunctions(lanes)
    copies = Copies(functions.prepare.numel_out(0) + ROW * len(equations.tables))
    in_rows = lanes >= PLACES
    head = [shared_source("real.h"), shared_source("elementary.c")]
    head += [shared_source("fours.h")] if in_rows else []
    print_one = _printer(equations, wide, copies if in_rows else None, None)
    apart = lanes > 1 and comes_in_units(functions)
    texts = []
    for name, function in (("rates", functions.rates), ("outputs", functions.outputs)):
        text = print_one(function, name, wide)
        if not apart:
            texts.append(text)
        else:
            yield "\n".join([*head, text, _AWAY.format(name=name)])
            texts.append(_FROM_AWAY.format(name=name))
    yield from wide_units(wide)
    prepare = print_function(functions.prepare, "prepare", ["p"], tables=equations.tables)
    texts = [prepare, *texts, *_model_texts(equations, functions, print_one)]
    yield "\n".join([*head, *texts, *events, copies.text, loop_source()])


def loop_source() -> str:
    """Return what a kernel of one lane offers, behind its functions, tables and steps."""
    return "\n".join(map(shared_source, ("event_sides.c", "loop.c")))


_GIVEN = "const real *t, const real *x, const real *z, const real *c, real *r"
_AWAY = f"void vd_{{name}}_apart({_GIVEN}) {{{{\n  {{name}}(t, x, z, c, r);\n}}}}\n"
_FROM_AWAY = (
    f"void vd_{{name}}_apart({_GIVEN});\n"
    f"VD_INLINE void {{name}}({_GIVEN}) {{{{\n  vd_{{name}}_apart(t, x, z, c, r);\n}}}}\n"
)
"""How a function is given by its unit, and called by the others."""


def wide_units(wide: WideFunctions) -> list[str]:
    """Return the units of functions that carry several places of a model at once."""
    return ["\n".join([*lane_head(lanes), *texts]) for lanes, texts in wide.units.items()]


def lane_head(lanes: int) -> list[str]:
    """Return what a unit begins with whose reals hold so many lanes."""
    return [f"#define VD_LANES {lanes}", shared_source("real.h"), shared_source("elementary.c")]


def lane_source(equations: Equations, functions: KernelFunctions, lanes: int) -> str:
    """Return the C source of a kernel that carries so many cases side by side."""
    mirrored = mirrored_constants(read_function(functions.prepare, equations.tables))
    texts = [
        *shared_texts(equations, functions, mirrored=mirrored),
        events_text(equations, functions),
    ]
    return "\n".join([*lane_head(lanes), *texts, shared_source("batch.c")])


def events_text(equations: Equations, functions: KernelFunctions) -> str:
    """Return the text of the functions of the events."""
    return print_function(functions.events, "events", _ARGUMENTS, tables=equations.tables)


def shared_texts(
    equations: Equations,
    functions: KernelFunctions,
    wide: WideFunctions | None = None,
    copies: Copies | None = None,
    mirrored: dict[int, Signed] | None = None,
    *,
    sampled: bool = True,
) -> list[str]:
    """Return what all kernels have: functions of the model, tables and steps.

    Without ``sampled`` the outputs are left out. ``wide`` and ``copies`` are for kernels of one
    lane, ``mirrored`` for those of several, see
    :func:`vehicledyn.codegen.printers.c_printer.print_function`.
    """
    print_one = _printer(equations, wide, copies, mirrored)
    texts = [
        print_function(functions.prepare, "prepare", ["p"], tables=equations.tables),
        print_one(functions.rates, "rates", wide),
    ]
    if sampled:
        selectable = mirrored is not None
        texts.append(print_one(functions.outputs, "outputs", wide, selectable=selectable))
    return [
        *texts,
        *_model_texts(equations, functions, print_one),
    ]


def _printer(
    equations: Equations,
    wide: WideFunctions | None,
    copies: Copies | None,
    mirrored: dict[int, Signed] | None,
) -> Callable[..., str]:
    """Return what prints a function of the model."""

    def printed(
        function: Any, name: str, wide: WideFunctions | None = None, *, selectable: bool = False
    ) -> str:
        return print_function(
            function,
            name,
            _ARGUMENTS,
            tables=equations.tables,
            wide=wide,
            copies=copies,
            mirrored=mirrored,
            selectable=selectable,
        )

    return printed


def _model_texts(
    equations: Equations, functions: KernelFunctions, print_one: Callable[..., str]
) -> list[str]:
    """Return what follows rates and outputs: blocks, tables and steps."""
    return [
        *[print_one(wave, f"wave_{k}") for k, wave in enumerate(functions.waves)],
        kernel_tables(equations, KernelSizes.of(functions)),
        kernel_counts(KernelSizes.of(functions)),
        shared_source("steps.c"),
    ]


def shared_source(name: str) -> str:
    """Return the text of a file that all kernels share, such as loop.c."""
    return (Path(__file__).parents[1] / "runtime" / name).read_text(encoding="utf-8")


@dataclass(frozen=True)
class KernelSizes:
    """What the tables of a kernel tell of its functions.

    ``wave_starts`` are the first blocks of its waves, ``wave_sizes`` their numbers of results;
    ``operations`` are those of :data:`~vehicledyn.codegen.passes.kernel_functions.COUNTED`.
    """

    wave_starts: tuple[int, ...]
    wave_sizes: tuple[int, ...]
    constants: int
    new_values: int
    operations: dict[str, int]

    @classmethod
    def of(cls, functions: KernelFunctions) -> KernelSizes:
        """Return the sizes of functions."""
        return cls(
            functions.wave_starts,
            tuple(wave.numel_out(0) for wave in functions.waves),
            functions.prepare.numel_out(0),
            functions.resets.numel_out(0),
            operations_of(functions),
        )


def kernel_tables(equations: Equations, of: KernelSizes) -> str:
    """Return what the loop must know of a model: sizes, blocks, events and counts."""
    n_states, n_unknowns = len(equations.states), len(equations.unknowns)
    blocks = equations.blocks
    sizes = {
        "NX": n_states,
        "NX1": max(1, n_states),
        "NZ": n_unknowns,
        "NZ1": max(1, n_unknowns),
        "NY": len(equations.channels),
        "NB": len(blocks),
        "NV": max([1, *of.wave_sizes]),
        "NWAVES": len(of.wave_sizes),
        "NW": max([1, *[block.stop - block.start for block in blocks]]),
        "NQ": len(equations.positions),
        "NE": len(equations.events),
        "NE1": max(1, len(equations.events)),
    }
    starts = [block.start for block in blocks] + [n_unknowns]
    signature = ", ".join(["const real *"] * 4 + ["real *"])
    names = [f"wave_{k}" for k in range(len(of.wave_sizes))] or ["0"]
    return "\n".join(
        [
            *[f"#define {name} {size}" for name, size in sizes.items()],
            listed("static const int", "block_start", starts),
            listed("static const double", "block_tolerance", [b.tolerance for b in blocks]),
            listed("static const int", "positions", equations.positions),
            listed("static const int", "velocities", equations.velocities),
            listed("static const int", "fires_rising", _fires(equations, "rising")),
            listed("static const int", "fires_falling", _fires(equations, "falling")),
            f"typedef void (*wave_function)({signature});",
            listed("static const wave_function", "wave_functions", names),
            listed("static const int", "wave_start", [*of.wave_starts, len(blocks)]),
            listed("static const int", "wave_of", _waves_of(of.wave_starts, len(blocks))),
            listed("static const int", "value_start", _value_starts(equations, of.wave_starts)),
        ]
    )


def kernel_counts(of: KernelSizes) -> str:
    """Return what a library says of its model: numbers of constants, new values, operations."""
    return "\n".join(
        [
            f"VD_EXPORT const int vd_constants = {of.constants};",
            f"VD_EXPORT const int vd_new_values = {of.new_values};",
            listed("VD_EXPORT const int", "vd_operations", [of.operations[k] for k in COUNTED]),
        ]
    )


def _waves_of(starts: tuple[int, ...], n_blocks: int) -> list[int]:
    """Return the wave of each block."""
    return [sum(start <= k for start in starts) - 1 for k in range(n_blocks)]


def _value_starts(equations: Equations, wave_starts: tuple[int, ...]) -> list[int]:
    """Return where the values of each block begin among those of its wave."""
    starts, place = [], 0
    for k, block in enumerate(equations.blocks):
        place = 0 if k in wave_starts else place
        starts.append(place)
        size = block.stop - block.start
        place += size + size * size
    return starts


def _fires(equations: Equations, direction: str) -> list[int]:
    return [int(event.direction in (direction, "either")) for event in equations.events]


def listed(kind: str, name: str, values: Sequence[float | int | str]) -> str:
    """Return the C definition of an array that holds some values, or a zero if there are none."""
    items = ", ".join(str(value) for value in values) or "0"
    return f"{kind} {name}[] = {{{items}}};"
