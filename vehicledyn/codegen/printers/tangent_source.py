"""Assemble the C source that carries derivatives of a motion, several points side by side."""

from __future__ import annotations

from typing import Any

from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.branch_functions import BranchFunctions
from vehicledyn.codegen.passes.kernel_functions import KernelFunctions
from vehicledyn.codegen.passes.slp_rows import PLACES
from vehicledyn.codegen.passes.stage_program import PointProgram, StageProgram
from vehicledyn.codegen.printers.c_printer import print_function
from vehicledyn.codegen.printers.kernel_source import (
    comes_in_units,
    events_text,
    lane_head,
    listed,
    shared_source,
    shared_texts,
    wide_units,
)
from vehicledyn.codegen.printers.row_code import print_jacobian
from vehicledyn.codegen.printers.row_printer import Copies
from vehicledyn.codegen.printers.wide_functions import WideFunctions
from vehicledyn.codegen.toolchain.compiler import UNIT_BREAK, suitable_lanes
from vehicledyn.symbolic.equations import Equations

_ARGUMENTS = ("t", "x", "z", "c")
_WITH_ACCELERATIONS = ("t", "x", "z", "a", "c")


def tangent_lanes() -> int:
    """Return how many points, and how many directions, are carried side by side."""
    return 8 if suitable_lanes() == 8 else 4


def tangent_source(
    equations: Equations,
    functions: KernelFunctions,
    stage: StageProgram,
    observed: PointProgram,
    branches: BranchFunctions,
    *,
    back: bool = False,
) -> str:
    """Return the C source: units for the motion, for its derivatives, and for what follows them.

    With ``back`` the adjoints of the motion are among the last.
    """
    lanes = suitable_lanes()
    in_rows, tables = lanes >= PLACES, equations.tables
    copies = Copies(functions.prepare.numel_out(0) + ROW * len(tables))
    wide = WideFunctions(lanes)
    head = [shared_source("real.h"), shared_source("elementary.c")]
    head += [shared_source("fours.h")] if in_rows else []
    texts = shared_texts(equations, functions, wide, copies if in_rows else None, sampled=False)
    runtime = map(shared_source, ("event_sides.c", "stage_points.c"))
    motion = [*head, *texts, events_text(equations, functions), copies.text, *runtime]
    at_points = [
        _apart(stage.function, "linearise", _WITH_ACCELERATIONS, equations),
        _apart(observed.function, "observe", _ARGUMENTS, equations),
        _by_state(equations, stage),
        _following(equations, stage, observed, branches, back=back),
    ]
    if branches.count:
        at_points.append(_apart(branches.function, "branches", _ARGUMENTS, equations))
    parts = at_points if comes_in_units(functions) else ["\n".join(at_points)]
    units = ["\n".join([*lane_head(tangent_lanes()), text]) for text in parts]
    return UNIT_BREAK.join([*units, "\n".join(motion), *wide_units(wide)])


def _apart(function: Any, name: str, inputs: tuple[str, ...], equations: Equations) -> str:
    """Return the text of a function at several points side by side."""
    results = [f"r{k}" for k in range(function.n_out())]
    given = ", ".join(f"const real *{item}" for item in inputs)
    given += "".join(f", real *{item}" for item in results)
    call = ", ".join([*inputs, *results])
    return "\n".join(
        [
            print_function(function, name, inputs, tables=equations.tables),
            f"void vd_{name}_apart({given}) {{\n  {name}({call});\n}}\n",
        ]
    )


def _by_state(equations: Equations, stage: StageProgram) -> str:
    """Return the text of the derivatives of unknowns and rates by time, states and unknowns."""
    n_sources = 1 + len(equations.states) + len(equations.unknowns)
    text, pattern = print_jacobian(stage.program, n_sources, "by_state")
    numbers = [len(pattern), *[k for pair in pattern for k in pair]]
    return "\n".join(
        [
            text,
            "void vd_by_state_apart(const real *w, real *j) {\n  by_state(w, j);\n}",
            listed("VD_EXPORT const int", "vd_pattern", numbers),
        ]
    )


def _following(
    equations: Equations,
    stage: StageProgram,
    observed: PointProgram,
    branches: BranchFunctions,
    *,
    back: bool,
) -> str:
    """Return the text that follows derivatives through a motion."""
    n_own, n_inverse = stage.function.numel_out(0), stage.function.numel_out(1)
    blocks = [block.stop - block.start for block in equations.blocks]
    sizes = {
        "NX": len(equations.states),
        "NZ": len(equations.unknowns),
        "NA": len(stage.accelerated),
        "NQ": len(equations.positions),
        "NB": len(blocks),
        "NW": max([1, *blocks]),
        "NU": n_own,
        "NI": n_inverse,
        "NO": observed.function.numel_out(0),
        "NBEFORE": stage.n_weights,
        "NE": len(equations.events),
        "NK": branches.count,
    }
    return "\n".join(
        [
            *[f"#define {name} {size}" for name, size in sizes.items()],
            listed("static const int", "positions", equations.positions),
            listed("static const int", "velocities", equations.velocities),
            listed("static const int", "accelerated", stage.accelerated),
            listed("static const int", "block_size", blocks),
            shared_source("passes.c"),
            shared_source("branches.c"),
            shared_source("tangents_ahead.c"),
            *([shared_source("back.c")] if back else []),
        ]
    )
