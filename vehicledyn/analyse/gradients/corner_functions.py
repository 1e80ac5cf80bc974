"""Functions whose signs decide between branches of the equations, at many points at once.

They are the arguments of min, max, abs, sign and comparisons, and the places in tables of straight
lines, where these change from line to line.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.codegen.ir.sx_graph import Node, Rebuild, read_nodes
from vehicledyn.kernel.interpreted import BufferedFunction
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.shared import inlined
from vehicledyn.symbolic.tables import CurveTable, table_of

Array = NDArray[np.float64]

_PAIRS = ("FMIN", "FMAX", "LT", "LE")
_SINGLES = ("FABS", "SIGN")
_AT_ONCE = 512
"""Points at which each operation is done at once: their numbers stay in the processor's cache."""
_BENT = 1e-9
"""Part of a table's largest slope by which lines that meet at a corner differ."""

_NUMPY: dict[str, Callable[..., Any]] = {
    "ASSIGN": np.positive,
    "ADD": np.add,
    "SUB": np.subtract,
    "MUL": np.multiply,
    "DIV": np.divide,
    "NEG": np.negative,
    "EXP": np.exp,
    "LOG": np.log,
    "POW": np.power,
    "CONSTPOW": np.power,
    "SQRT": np.sqrt,
    "SQ": np.square,
    "TWICE": lambda x: 2.0 * x,
    "SIN": np.sin,
    "COS": np.cos,
    "TAN": np.tan,
    "ASIN": np.arcsin,
    "ACOS": np.arccos,
    "ATAN": np.arctan,
    "LT": np.less,
    "LE": np.less_equal,
    "EQ": np.equal,
    "NE": np.not_equal,
    "NOT": np.logical_not,
    "AND": np.logical_and,
    "OR": np.logical_or,
    "FLOOR": np.floor,
    "CEIL": np.ceil,
    "FMOD": np.fmod,
    "FABS": np.abs,
    "SIGN": np.sign,
    "COPYSIGN": np.copysign,
    "IF_ELSE_ZERO": lambda x, y: np.where(x, y, 0.0),
    "FMIN": np.fmin,
    "FMAX": np.fmax,
    "INV": np.reciprocal,
    "SINH": np.sinh,
    "COSH": np.cosh,
    "TANH": np.tanh,
    "ASINH": np.arcsinh,
    "ACOSH": np.arccosh,
    "ATANH": np.arctanh,
    "ATAN2": np.arctan2,
    "LOG1P": np.log1p,
    "EXPM1": np.expm1,
    "HYPOT": np.hypot,
}


class CornerFunctions:
    """The functions of rates and residuals that change along a motion.

    ``is_table`` (count,) says which are places in tables, counted in cells.

    Parameters
    ----------
    equations
        The model.
    channels
        Numbers of channels whose functions count as well.
    """

    def __init__(self, equations: Equations, channels: Sequence[int] = ()) -> None:
        import casadi

        e = equations
        inputs = [e.time, e.state, e.algebraic, e.parameter]
        shown = casadi.SX(e.output)[list(channels)] if channels else casadi.SX(0, 1)
        whole = inlined(casadi.vertcat(casadi.SX(e.rate), casadi.SX(e.residual), shown))
        found = _deciders(casadi.Function("f", inputs, [casadi.densify(whole)]), inputs)
        column = casadi.vertcat(*[item for item, _ in found]) if found else casadi.SX(0, 1)
        column = casadi.densify(column)
        self.is_table: NDArray[np.bool_] = np.array([kind for _, kind in found], dtype=bool)
        self._inputs, self._column = inputs, column
        function = casadi.Function("corners", inputs, [column])
        self._nodes, results = read_nodes(function)
        self._places = [value for _, value in sorted(results[0])] if found else []
        self._calls = Rebuild(function, inputs, self._nodes).calls
        self._at = BufferedFunction(function)
        self._slopes: dict[int, Any] = {}
        self._operations = {getattr(casadi, f"OP_{name}"): f for name, f in _NUMPY.items()}
        self._codes = casadi.OP_INPUT, casadi.OP_CONST, casadi.OP_CALL
        self._plan()

    def _plan(self) -> None:
        """Find which nodes change along a motion, and where each of these is used last."""
        moving = _moving(self._nodes)
        self._order = [
            [k for k, moves in enumerate(moving) if moves == wanted] for wanted in (False, True)
        ]
        source = self._codes[0]
        users = {
            item: k
            for k in self._order[True]
            for item in (self._nodes[k][1] if self._nodes[k][0] != source else ())
        }
        self._is_own = [
            moves and code in self._operations
            for moves, (code, _, _) in zip(moving, self._nodes, strict=True)
        ]
        kept = set(self._places)
        self._last_used: dict[int, list[int]] = {k: [] for k in self._order[True]}
        for item, k in users.items():
            if self._nodes[item][0] != source and moving[item] and item not in kept:
                self._last_used[k].append(item)

    @property
    def count(self) -> int:
        """Number of functions."""
        return len(self._places)

    def at(self, time: float, state: Array, unknowns: Array, parameters: Array) -> Array:
        """Return the values at a point, shape (count,)."""
        (found,) = self._at(time, state, unknowns, parameters)
        return np.array(found, dtype=float).reshape(self.count)

    def slopes(
        self, which: int, time: float, state: Array, unknowns: Array, parameters: Array
    ) -> list[Array]:
        """Return the derivatives of one by time, states, unknowns and parameters, a row each."""
        import casadi

        if which not in self._slopes:
            rows = [casadi.densify(casadi.jacobian(self._column[which], s)) for s in self._inputs]
            self._slopes[which] = casadi.Function("slopes", self._inputs, rows)
        found = self._slopes[which](time, state, unknowns, parameters)
        return [np.array(row, dtype=float).ravel() for row in found]

    def along(self, times: Array, states: Array, unknowns: Array, parameters: Array) -> Array:
        """Return the values at points, shape (n, count); states and unknowns (n, ...)."""
        found = np.empty((len(times), self.count))
        columns = [np.ascontiguousarray(item.T) for item in (times[:, None], states, unknowns)]
        with np.errstate(all="ignore"):
            fixed = self._computed([*columns, parameters], {}, moving=False)
            for first in range(0, len(times), _AT_ONCE):
                part = slice(first, first + _AT_ONCE)
                given = [item[:, part] for item in columns]
                values = self._computed([*given, parameters], dict(fixed), moving=True)
                for k, place in enumerate(self._places):
                    found[part, k] = values[place]
        return found

    def _computed(
        self, given: list[Array], values: dict[int, Any], *, moving: bool
    ) -> dict[int, Any]:
        """Add the values of the nodes that change along a motion, or of the others.

        Rooms of values that are of no more use are used again, so that they stay in the cache.
        """
        source, constant, call = self._codes
        rooms: list[Array] = []
        for k in self._order[moving]:
            code, operands, detail = self._nodes[k]
            if code == source:
                values[k] = given[operands[0]][operands[1]]
            elif code == constant:
                values[k] = np.float64(detail)
            elif code == call:
                knot, rows = _table(self._calls[int(detail)]).cell_of(
                    np.asarray(values[operands[0]])
                )
                values[k] = (knot, *rows)
            elif code < 0:
                values[k] = values[operands[0]][int(detail)]
            else:
                operation, inputs = self._operations[code], [values[item] for item in operands]
                if moving and rooms and isinstance(operation, np.ufunc):
                    values[k] = operation(*inputs, out=rooms.pop())
                else:
                    values[k] = operation(*inputs)
            if moving:
                for item in self._last_used[k]:
                    room = values.pop(item)
                    if self._is_own[item] and room.dtype == float:
                        rooms.append(room)
        return values


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
