"""Assemble the C source that carries tangents of a motion, several directions side by side."""

from __future__ import annotations

from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.kernel_functions import KernelFunctions
from vehicledyn.codegen.passes.linear_program import PointProgram, StageProgram
from vehicledyn.codegen.passes.slp_rows import PLACES
from vehicledyn.codegen.printers.c_printer import print_function
from vehicledyn.codegen.printers.kernel_source import (
    lane_head,
    listed,
    shared_source,
    shared_texts,
    wide_units,
)
from vehicledyn.codegen.printers.row_code import print_rows, print_rows_back
from vehicledyn.codegen.printers.row_printer import Copies
from vehicledyn.codegen.printers.wide_functions import WideFunctions
from vehicledyn.codegen.toolchain.compiler import UNIT_BREAK, suitable_lanes
from vehicledyn.symbolic.equations import Equations

_ARGUMENTS = ("t", "x", "z", "c")


def tangent_lanes() -> int:
    """Return how many directions are carried side by side."""
    return 8 if suitable_lanes() == 8 else 4


def tangent_source(
    equations: Equations,
    functions: KernelFunctions,
    stage: StageProgram,
    observed: PointProgram,
    *,
    back: bool = False,
) -> str:
    """Return the C source: one unit for the motion, one for its tangents.

    With ``back`` the adjoints of the motion are among the first.
    """
    lanes = suitable_lanes()
    in_rows, tables = lanes >= PLACES, equations.tables
    copies = Copies(functions.prepare.numel_out(0) + ROW * len(tables))
    wide = WideFunctions(lanes)
    head = [shared_source("real.h"), shared_source("elementary.c")]
    head += [shared_source("fours.h")] if in_rows else []
    texts = shared_texts(equations, functions, wide, copies if in_rows else None)
    printed = [
        print_function(
            function, name, _ARGUMENTS, tables=tables, copies=copies if in_rows else None
        )
        for function, name in ((stage.function, "linearise"), (observed.function, "observe"))
    ]
    sizes = {
        "NU": stage.function.numel_out(1),
        "NI": stage.function.numel_out(2),
    }
    names = [f"#define {name} {size}" for name, size in sizes.items()]
    motion = [*head, *texts, *printed, copies.text, *names, shared_source("linearise.c")]
    motion += _back(equations, functions, stage, observed) if back else []
    return UNIT_BREAK.join(
        ["\n".join(motion), *wide_units(wide), _directions(equations, functions, stage, observed)]
    )


def _back(
    equations: Equations, functions: KernelFunctions, stage: StageProgram, observed: PointProgram
) -> list[str]:
    """Return the functions of adjoints."""
    n_x, n_z, n_c = len(equations.states), len(equations.unknowns), functions.prepare.numel_out(0)
    first = 1 + n_x + n_z
    seeded = [*stage.program.targets.tolist(), *stage.unknowns.tolist()]
    rows, ends = stage.program.transposed(1 + n_x + n_c), observed.program
    own = ends.transposed(first + n_c)
    return [
        print_rows_back(rows, range(1 + n_x, 1 + n_x + n_c), "stage_back", seeded),
        print_rows_back(own, range(first, first + n_c), "point_back", ends.targets.tolist()),
        shared_source("back.c"),
    ]


def _directions(
    equations: Equations, functions: KernelFunctions, stage: StageProgram, observed: PointProgram
) -> str:
    n_x, n_z, n_c = len(equations.states), len(equations.unknowns), functions.prepare.numel_out(0)
    first = 1 + n_x + n_z
    sizes = {
        "NX": n_x,
        "NZ": n_z,
        "NQ": len(equations.positions),
    }
    return "\n".join(
        [
            *lane_head(tangent_lanes()),
            *[f"#define {name} {size}" for name, size in sizes.items()],
            listed("static const int", "positions", equations.positions),
            listed("static const int", "velocities", equations.velocities),
            print_rows(
                stage.program, range(1 + n_x, 1 + n_x + n_c), "stage_rows", stage.unknowns.tolist()
            ),
            print_rows(observed.program, range(first, first + n_c), "point_rows"),
            shared_source("tangents_ahead.c"),
        ]
    )
