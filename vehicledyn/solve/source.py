"""Assemble the C source of a kernel: printed functions, tables of the blocks and the loop."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from vehicledyn.solve.code import print_function
from vehicledyn.solve.functions import KernelFunctions, operations_of
from vehicledyn.symbolic.equations import Equations

COUNTED = ("prepare", "rates", "outputs", "blocks")

_HEAD = """\
#include <math.h>
#include <string.h>

#if defined(_WIN32)
#define VD_EXPORT __declspec(dllexport)
#else
#define VD_EXPORT __attribute__((visibility("default")))
#endif
#define VD_APART __attribute__((noinline))

static inline double vd_min(double a, double b) { return a < b || b != b ? a : b; }
static inline double vd_max(double a, double b) { return a > b || b != b ? a : b; }
static inline double vd_sign(double a) { return a < 0.0 ? -1.0 : a > 0.0 ? 1.0 : a; }
"""


def kernel_source(equations: Equations, functions: KernelFunctions) -> str:
    """Return the complete C source of a kernel."""
    arguments = ["t", "x", "z", "c"]
    parts = [
        _HEAD,
        print_function(functions.prepare, "prepare", ["p"]),
        print_function(functions.rates, "rates", arguments),
        print_function(functions.outputs, "outputs", arguments),
        print_function(functions.events, "events", arguments),
        print_function(functions.resets, "resets", arguments),
        *[print_function(b, f"block_{k}", arguments) for k, b in enumerate(functions.blocks)],
        _tables(equations, functions),
        loop_source(),
    ]
    return "\n".join(parts)


def loop_source() -> str:
    """Return the text of loop.c, the part that all kernels share."""
    return Path(__file__).with_name("loop.c").read_text(encoding="utf-8")


def _tables(equations: Equations, functions: KernelFunctions) -> str:
    n_states, n_unknowns = len(equations.states), len(equations.unknowns)
    blocks = equations.blocks
    sizes = {
        "NX": n_states,
        "NX1": max(1, n_states),
        "NZ": n_unknowns,
        "NZ1": max(1, n_unknowns),
        "NY": len(equations.channels),
        "NB": len(blocks),
        "NW": max([1, *[block.stop - block.start for block in blocks]]),
        "NQ": len(equations.positions),
        "NE": len(equations.events),
        "NE1": max(1, len(equations.events)),
    }
    counts = operations_of(functions)
    starts = [block.start for block in blocks] + [n_unknowns]
    signature = ", ".join(["const double *"] * 4 + ["double *"] * 2)
    names = [f"block_{k}" for k in range(len(blocks))] or ["0"]
    return "\n".join(
        [
            *[f"#define {name} {size}" for name, size in sizes.items()],
            _table("static const int", "block_start", starts),
            _table("static const double", "block_tolerance", [b.tolerance for b in blocks]),
            _table("static const int", "positions", equations.positions),
            _table("static const int", "velocities", equations.velocities),
            _table("static const int", "fires_rising", _fires(equations, "rising")),
            _table("static const int", "fires_falling", _fires(equations, "falling")),
            f"typedef void (*block_function)({signature});",
            _table("static const block_function", "block_functions", names),
            f"VD_EXPORT const int vd_constants = {functions.prepare.numel_out(0)};",
            f"VD_EXPORT const int vd_new_values = {functions.resets.numel_out(0)};",
            _table("VD_EXPORT const int", "vd_operations", [counts[key] for key in COUNTED]),
        ]
    )


def _fires(equations: Equations, direction: str) -> list[int]:
    return [int(event.direction in (direction, "either")) for event in equations.events]


def _table(kind: str, name: str, values: Sequence[float | int | str]) -> str:
    items = ", ".join(str(value) for value in values) or "0"
    return f"{kind} {name}[] = {{{items}}};"
