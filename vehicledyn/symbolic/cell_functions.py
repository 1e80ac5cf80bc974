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
    slope = _nothing(f"fwd1_{name}", [(1, 1), (1 + width, 1), (1, 1)], 1 + width, _ORDERS)
    options: Any = {"never_inline": True, "cache": {slope.name(): slope}}
    return casadi.Function(name, [x], [found], options)


def _nothing(name: str, inputs: list[tuple[int, int]], size: int, orders: int) -> Any:
    """Return a function that is zero, and so are its derivatives up to some order.

    In forward mode CasADi 3.8 leaves the derivative of a call undefined where it has no nonzeros,
    so each derivative is given one of full shape. The inputs are arguments, results and seeds;
    results are not looked at.
    """
    import casadi

    symbols = [
        casadi.MX.sym(
            "given", casadi.Sparsity(*shape) if shape[0] == size else casadi.Sparsity.dense(*shape)
        )
        for shape in inputs
    ]
    options: dict[str, Any] = {"never_inline": True}
    if orders > 1:
        further = _nothing(f"fwd1_{name}", [*inputs, (size, 1), *inputs], size, orders - 1)
        options["cache"] = {further.name(): further}
    return casadi.Function(name, symbols, [casadi.MX.zeros(size, 1)], options)
