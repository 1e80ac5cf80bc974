"""CasADi functions that find the cell of a place in a table, and their derivatives.

CasADi differentiates a call by calls of further functions. Those of a cell are zero everywhere,
since knot and coefficients do not change within a cell.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

PREFIX = "cell_of_"
"""How the names of such functions begin; those of their derivatives hold it further on."""

_ORDERS = 4
"""Derivatives of derivatives that CasADi may take by itself."""


def is_slope(name: str) -> bool:
    """Return whether a name is that of a function CasADi made to differentiate a cell."""
    return not name.startswith(PREFIX) and PREFIX in name


def cell_function(name: str, origin: float, step: float, cells: NDArray[np.float64]) -> Any:
    """Return the CasADi function x -> (knot, coefficients) of the table of this name.

    Coefficients come from a linear interpolation between cells, taken at whole numbers only,
    since it reads no more of the table than it needs.
    """
    import casadi

    x = casadi.MX.sym("x")
    rows, width = cells.shape
    place = casadi.fmax(casadi.fmin((x - origin) * (1.0 / step), rows - 1.0), 0.0)
    cell = casadi.floor(place)
    row_of = casadi.interpolant(
        "rows", "linear", [range(rows)], cells.ravel(), {"lookup_mode": ["exact"]}
    )
    found = casadi.vertcat(origin + step * cell, row_of(cell))
    return casadi.Function(name, [x], [found], _flat(name, [(1, 1)], [(1 + width, 1)], _ORDERS))


def _flat(
    name: str, inputs: list[tuple[int, int]], outputs: list[tuple[int, int]], orders: int
) -> dict[str, Any]:
    """Return options of a function whose derivatives are zero, up to some order.

    They are given as Jacobians with all entries, which a function keeps when it is written to a
    file and read again. CasADi's own would have no entries, and in forward mode it leaves the
    derivative of a call undefined where it has none.
    """
    import casadi

    options: dict[str, Any] = {"never_inline": True}
    if not orders:
        return options
    jacobian, given = f"jac_{name}", [*inputs, *outputs]
    blocks = [(a * b, c * d) for a, b in outputs for c, d in inputs]
    function = casadi.Function(
        jacobian,
        [casadi.MX.sym("given", *shape) for shape in given],
        [casadi.MX(casadi.DM.zeros(*shape)) for shape in blocks],
        _flat(jacobian, given, blocks, orders - 1),
    )
    return options | {
        "custom_jacobian": function,
        "enable_forward": False,
        "enable_reverse": False,
    }
