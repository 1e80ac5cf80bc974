"""Assemble the C source of rates, residuals and their Jacobian for CasADi's integrators."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.kernel_functions import parts_apart_from_parameters
from vehicledyn.codegen.printers.c_printer import print_function
from vehicledyn.codegen.printers.kernel_source import listed, shared_source, wide_units
from vehicledyn.codegen.printers.wide_functions import WideFunctions
from vehicledyn.codegen.toolchain.compiler import UNIT_BREAK
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations


def implicit_source(equations: Equations, lanes: int) -> str:
    """Return the source, with slopes along so many colours of the Jacobian at once."""
    import casadi

    e = equations
    parts = [casadi.densify(e.rate), casadi.densify(e.residual)]
    columns = [e.time, e.state, e.algebraic]
    patterns = [_pattern(part, column) for part in parts for column in columns]
    colours = colours_of(_whole(patterns))
    direction = ops.symbols("direction", len(colours))
    variables = casadi.vertcat(*columns)
    slope = ops.derivative(casadi.vertcat(*parts), variables, direction)
    prepare, constants, (rates, residuals, slope) = parts_apart_from_parameters(
        [*columns, direction, e.parameter], [*parts, slope]
    )
    dae = casadi.Function("dae", [*columns, constants], [rates, residuals])
    slopes = casadi.Function("slope", [*columns, direction, constants], [slope])
    sizes = {
        "NX": len(e.states),
        "NX1": max(1, len(e.states)),
        "NZ": len(e.unknowns),
        "NZ1": max(1, len(e.unknowns)),
        "NC": constants.numel(),
        "NT": ROW * len(e.tables),
        "NROW": len(e.states) + len(e.unknowns),
        "NCOLUMN": len(colours),
        "NCOLOUR": max(colours) + 1,
    }
    head = [f"#define {name} {size}" for name, size in sizes.items()]
    wide = WideFunctions(lanes)
    one = [
        shared_source("real.h"),
        shared_source("elementary.c"),
        *head,
        print_function(prepare, "prepare", ["p"], tables=e.tables),
        print_function(dae, "dae", ["t", "x", "z", "c"], tables=e.tables, wide=wide),
        f"VD_EXPORT const int vd_dae_constants = {constants.numel()};",
        _sparsity_tables(e, patterns, colours, constants.numel() + ROW * len(e.tables)),
        shared_source("implicit.c"),
    ]
    many = [
        f"#define VD_LANES {lanes}",
        shared_source("real.h"),
        shared_source("elementary.c"),
        *head,
        listed("static const int", "colour_of", colours),
        print_function(slopes, "slope", ["t", "x", "z", "d", "c"], tables=e.tables),
        shared_source("columns.c"),
    ]
    return UNIT_BREAK.join(["\n".join(one), "\n".join(many), *wide_units(wide)])


def colours_of(pattern: Any) -> list[int]:
    """Return a colour for each column of a pattern, so that no two of a colour share a row.

    Parameters
    ----------
    pattern
        A ``casadi.Sparsity``.

    Returns
    -------
    list
        Numbers from 0 on, one a column; the columns with most entries choose first, each the
        first colour that is free.
    """
    rows_of: list[list[int]] = [[] for _ in range(pattern.size2())]
    for row, column in zip(*pattern.get_triplet(), strict=True):
        rows_of[column].append(row)
    taken: list[set[int]] = []
    colours = [0] * len(rows_of)
    for column in sorted(range(len(rows_of)), key=lambda k: -len(rows_of[k])):
        own = rows_of[column]
        free = (k for k, rows in enumerate(taken) if rows.isdisjoint(own))
        colour = next(free, len(taken))
        if colour == len(taken):
            taken.append(set())
        taken[colour].update(own)
        colours[column] = colour
    return colours


def _pattern(part: Any, column: Any) -> Any:
    """Return which entries of a part's derivatives by a column of symbols may differ from zero."""
    import casadi

    if not part.numel() or not column.numel():
        return casadi.Sparsity(part.numel(), column.numel())
    return casadi.jacobian_sparsity(part, column)


def _whole(patterns: Sequence[Any]) -> Any:
    import casadi

    half = len(patterns) // 2
    return casadi.vertcat(casadi.horzcat(*patterns[:half]), casadi.horzcat(*patterns[half:]))


def _sparsity_tables(
    equations: Equations, patterns: Sequence[Any], colours: list[int], n_constants: int
) -> str:
    """Return what implicit.c knows of shapes, and where it finds the entries of each slope."""
    import casadi

    n, m = len(equations.states), len(equations.unknowns)
    shapes = [casadi.Sparsity.dense(size, 1) for size in (1, n, m, n_constants)]
    # Nothing asks for derivatives by constants.
    slopes = [
        *[*patterns[:3], casadi.Sparsity(n, n_constants)],
        *[*patterns[3:], casadi.Sparsity(m, n_constants)],
    ]
    places = []
    for number, pattern in enumerate(slopes):
        row, column = n * (number // 4), (0, 1, 1 + n, 0)[number % 4]
        entries = zip(*pattern.get_triplet(), strict=True)
        places.append([colours[column + k] * (n + m) + row + i for i, k in entries])
    kind, numbers = "static const long long", "static const int"
    return "\n".join(
        [
            *[listed(kind, f"shape_{k}", shape.compress()) for k, shape in enumerate(shapes)],
            f"{kind} *const arguments[] = {{shape_0, shape_1, shape_2, shape_3}};",
            f"{kind} *const results[] = {{shape_1, shape_2}};",
            *[listed(kind, f"slope_{k}", slope.compress()) for k, slope in enumerate(slopes)],
            f"{kind} *const slopes[] = {{{', '.join(f'slope_{k}' for k in range(8))}}};",
            *[listed(numbers, f"place_{k}", place) for k, place in enumerate(places)],
            f"{numbers} *const place_of[] = {{{', '.join(f'place_{k}' for k in range(8))}}};",
            listed(numbers, "n_slopes", [len(place) for place in places]),
        ]
    )
