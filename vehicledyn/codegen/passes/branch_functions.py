"""Functions whose signs choose between branches of the equations.

They are the arguments of min, max, abs, sign and comparisons, and the places in tables of straight
lines, where these change from line to line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.codegen.ir.sx_graph import Node, Rebuild, read_nodes
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.shared import inlined
from vehicledyn.symbolic.tables import CurveTable, table_of

_PAIRS = ("FMIN", "FMAX", "LT", "LE")
_SINGLES = ("FABS", "SIGN")
_BENT = 1e-9
"""Part of a table's largest slope by which lines that meet at a corner differ."""


@dataclass(frozen=True)
class BranchFunctions:
    """The functions of rates and residuals that choose between branches and change along a motion.

    ``function`` is that of time, states, unknowns and parameters, a ``casadi.Function`` whose
    result is a column; ``is_table`` (count,) says which rows are places in tables, counted in
    cells. ``inputs`` are the symbols of its arguments, ``column`` what these give.
    """

    function: Any
    is_table: NDArray[np.bool_]
    inputs: list[Any]
    column: Any

    @staticmethod
    def of(equations: Equations, channels: Sequence[int] = ()) -> BranchFunctions:
        """Return those of a model, and of the channels with some numbers if wanted."""
        import casadi

        e = equations
        inputs = [e.time, e.state, e.algebraic, e.parameter]
        shown = casadi.SX(e.output)[list(channels)] if channels else casadi.SX(0, 1)
        whole = inlined(casadi.vertcat(casadi.SX(e.rate), casadi.SX(e.residual), shown))
        found = _deciders(casadi.Function("f", inputs, [casadi.densify(whole)]), inputs)
        column = casadi.vertcat(*[item for item, _ in found]) if found else casadi.SX(0, 1)
        column = casadi.densify(column)
        is_table = np.array([kind for _, kind in found], dtype=bool)
        return BranchFunctions(
            casadi.Function("branches", inputs, [column]), is_table, inputs, column
        )

    @property
    def count(self) -> int:
        """Number of functions."""
        return len(self.is_table)


def _table(function: Any) -> CurveTable:
    table = table_of(function)
    if table is None:
        raise ValueError(f"'{function.name()}' is no table")
    return table


def _deciders(function: Any, inputs: list[Any]) -> list[tuple[Any, bool]]:
    """Return the functions that change along a motion, and which are places in tables."""
    import casadi

    nodes, _ = read_nodes(function)
    rebuild = Rebuild(function, inputs, nodes)
    pairs = {getattr(casadi, f"OP_{name}") for name in _PAIRS}
    singles = {getattr(casadi, f"OP_{name}") for name in _SINGLES}
    moving = _moving(nodes)
    values: list[Any] = []
    found: dict[Any, tuple[Any, bool]] = {}
    for node, moves in zip(nodes, moving, strict=True):
        values.append(rebuild.value(node, values))
        code, operands, detail = node
        if not moves:
            continue
        if code in pairs:
            key = tuple(sorted(operands))
            found.setdefault(key, (values[operands[0]] - values[operands[1]], False))
        elif code in singles:
            found.setdefault(operands, (values[operands[0]], False))
        elif code == casadi.OP_CALL and _is_bent(table := _table(rebuild.calls[int(detail)])):
            place = (values[operands[0]] - table.origin) * (1.0 / table.step)
            last = len(table.cells) - 1.0
            found.setdefault((*operands, "table"), (casadi.fmax(casadi.fmin(place, last), 0), True))
    return list(found.values())


def _moving(nodes: list[Node]) -> list[bool]:
    """Return which values change along a motion."""
    import casadi

    moving: list[bool] = []
    for code, operands, _ in nodes:
        if code == casadi.OP_INPUT:
            moving.append(operands[0] < 3)
        else:
            moving.append(any(moving[item] for item in operands))
    return moving


def _is_bent(table: CurveTable) -> bool:
    """Return whether a table is of straight lines that meet at corners."""
    slopes = table.cells[:, 1]
    corners = np.abs(np.diff(slopes)) > _BENT * np.abs(slopes).max()
    return table.order == 1 and bool(corners.any())
