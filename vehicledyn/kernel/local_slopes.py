"""Values and exact slopes of functions at one point: compiled, or interpreted without compiler."""

from __future__ import annotations

from typing import Any

from vehicledyn.codegen.toolchain.compiler import CompilationError
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.interpreted import BufferedFunction
from vehicledyn.kernel.point_slopes import PointCode
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.tables import CurveTable


class LocalSlopes:
    """Evaluates a column of functions and their derivatives by some of its variables.

    Parameters
    ----------
    values
        The functions, shape (n_values,).
    moving
        Symbols by which they are differentiated, shape (n_moving,).
    still
        All other symbols, shape (n_still,).
    tables
        All that the values look up.
    compiled
        Whether to compile them, where a compiler works.
    """

    def __init__(
        self,
        values: Any,
        moving: Any,
        still: Any,
        tables: tuple[CurveTable, ...],
        *,
        compiled: bool = True,
    ) -> None:
        """Derive, and print and compile or take the code from the cache."""
        import casadi

        values = casadi.cse(casadi.densify(values))
        self._machine = _compiled(values, moving, still, tables) if compiled else None
        if self._machine is None:
            slopes = casadi.densify(ops.jacobian(values, moving))
            function = casadi.Function("slopes", [moving, still], [values, slopes])
            self._function = BufferedFunction(function)

    def at(self, moving: Vector, still: Vector) -> tuple[Vector, Vector]:
        """Return the values (n_values,) and their derivatives (n_values, n_moving) at a point."""
        if self._machine is None:
            values, slopes = self._function(moving, still)
            return values, slopes
        values, slopes = self._machine.slopes(moving[None], still)
        return values[0], slopes[0]


def _compiled(
    values: Any, moving: Any, still: Any, tables: tuple[CurveTable, ...]
) -> PointCode | None:
    try:
        return PointCode(values, moving, still, tables, first=moving.numel())
    except CompilationError:
        return None
