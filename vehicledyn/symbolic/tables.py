"""Curves given by numbers: uniform grids of polynomials that stay out of the generated code.

A table is known at run time only. In expressions it is a call that finds the cell of a place,
so code compiled for one table serves every other one with polynomials of the same order.
"""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.numbers.even_spline import even_spline
from vehicledyn.symbolic.cell_functions import PREFIX, cell_function

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CurveTable:
    """A curve y(x) of polynomials in cells of equal width, continued by its end tangents.

    In cell k, with u = (x - start) / step - k between 0 and 1,

        y = Σᵢ coefficients[k, i] uⁱ

    The methods take and return floats, arrays or expressions. Expressions differentiate exactly,
    by the polynomial of the cell; at a knot by that of the cell that begins there.

    Parameters
    ----------
    name
        What the curve is, for messages.
    start
        Place of the first knot [unit of x].
    step
        Width of a cell, positive [unit of x].
    coefficients
        Shape (n_cells, order + 1), lowest power first [unit of y]; order at least 1.

    Raises
    ------
    ValueError
        If the shape, the step or a number makes no curve.
    """

    name: str
    start: float
    step: float
    coefficients: Array

    def __post_init__(self) -> None:
        """Own the numbers and check them."""
        array = np.array(self.coefficients, dtype=float)
        array.flags.writeable = False
        object.__setattr__(self, "coefficients", array)
        if array.ndim != 2 or array.shape[0] < 1 or array.shape[1] < 2:
            raise ValueError(
                f"table '{self.name}' needs coefficients of shape (n_cells, order + 1) with at "
                f"least one cell and order 1, not {array.shape}"
            )
        finite = math.isfinite(self.start) and np.isfinite(array).all()
        if not (finite and math.isfinite(self.step) and self.step > 0.0):
            raise ValueError(
                f"table '{self.name}' needs finite numbers and a positive step, "
                f"not start {self.start:g} and step {self.step:g}"
            )

    @staticmethod
    def through(
        name: str, start: float, step: float, values: Sequence[float] | Array
    ) -> CurveTable:
        """Return the cubic spline through values at equal distances, twice differentiable.

        Its third derivative is continuous at the second and the last but one knot, so cubics
        come out exactly; fewer than four values give the polynomial through them.

        Raises
        ------
        ValueError
            If there are fewer than two values.
        """
        given = np.asarray(values, dtype=float)
        if given.ndim != 1 or given.size < 2:
            raise ValueError(f"table '{name}' needs a row of at least two values")
        if not np.isfinite(given).all():
            raise ValueError(f"table '{name}' needs finite numbers")
        return CurveTable(name, float(start), float(step), even_spline(given))

    @property
    def stop(self) -> float:
        """Place of the last knot [unit of x]."""
        return self.start + self.step * len(self.coefficients)

    @property
    def order(self) -> int:
        """Order of the polynomials."""
        return int(self.coefficients.shape[1]) - 1

    def value(self, x: Any) -> Any:
        """Return y at a place [unit of y]."""
        return self._polynomial(x, 0)

    def slope(self, x: Any) -> Any:
        """Return dy/dx at a place [unit of y / unit of x]."""
        return self._polynomial(x, 1)

    def curvature(self, x: Any) -> Any:
        """Return d²y/dx² at a place [unit of y / unit of x²]; zero beyond the ends."""
        return self._polynomial(x, 2)

    def entries(self, x: float) -> list[Any]:
        """Return the coefficients of the cell of a fixed place as expressions that look them up.

        They are those of powers of the distance from the knot, see :attr:`cells`.
        """
        import casadi

        found = self._call.function(casadi.SX(x))
        return [found[k] for k in range(1, self.order + 2)]

    def announce(self) -> None:
        """Make known that expressions look this table up, as those read from a file do."""
        _ = self._call

    @property
    def origin(self) -> float:
        """Where the cell before the first one begins [unit of x]."""
        return self.start - self.step

    @cached_property
    def cells(self) -> Array:
        """Coefficients of powers of x - knot, knot = origin + step * cell.

        Shape (n_cells + 2, order + 1): a straight cell comes before and one after all others.
        """
        order = np.arange(self.order + 1)
        scale = self.step ** -order.astype(float)
        inner = self.coefficients * scale
        last = self.coefficients[-1]
        rows = np.zeros((len(inner) + 2, self.order + 1))
        rows[1:-1] = inner
        rows[0, :2] = inner[0, 0] - inner[0, 1] * self.step, inner[0, 1]
        rows[-1, :2] = last.sum(), (order * last).sum() / self.step
        rows.flags.writeable = False
        return rows

    @property
    def identity(self) -> str:
        """A word for name and numbers, of letters, digits and single underlines."""
        readable = re.sub(r"[^0-9A-Za-z]+", "_", self.name).strip("_")
        return f"{self.digest[:16]}_{readable}".rstrip("_")

    @cached_property
    def digest(self) -> str:
        """A text that is equal for tables of equal numbers."""
        text = f"{self.start!r} {self.step!r} {self.coefficients.shape}"
        return hashlib.sha256(text.encode() + self.coefficients.tobytes()).hexdigest()

    @cached_property
    def _call(self) -> TableCall:
        name = PREFIX + self.identity
        call = _CALLS.get(name)
        if call is None:
            function = cell_function(name, self.origin, self.step, self.cells)
            call = _CALLS[name] = TableCall(function, self)
        return call

    def _polynomial(self, x: Any, derivative: int) -> Any:
        knot, rows = self.cell_of(x)
        distance = x - knot
        order = len(rows) - 1
        if order < derivative:
            return 0.0 * distance
        total = float(math.perm(order, derivative)) * rows[order]
        for power in range(order - 1, derivative - 1, -1):
            total = float(math.perm(power, derivative)) * rows[power] + distance * total
        return total

    def cell_of(self, x: Any) -> tuple[Any, Sequence[Any]]:
        """Return the knot where the cell of a place begins, and the coefficients there."""
        if not isinstance(x, int | float | np.number | np.ndarray):
            found = self._call.function(x)
            return found[0], [found[k] for k in range(1, self.order + 2)]
        last = len(self.cells) - 1
        place = np.fmax(np.fmin((x - self.origin) * (1.0 / self.step), last), 0.0)
        cell = np.trunc(place).astype(int)
        rows = np.moveaxis(self.cells[cell], -1, 0)
        return self.origin + self.step * cell, rows


@dataclass(frozen=True, eq=False)
class TableCall:
    """The function x -> (knot, coefficients) of tables with equal numbers, and one of them."""

    function: Any
    table: CurveTable


_CALLS: WeakValueDictionary[str, TableCall] = WeakValueDictionary()
"""Calls in use, by the name of their function; each lasts as long as anyone holds it."""


def any_called() -> bool:
    """Return whether any expression looks a table up."""
    return bool(_CALLS)


def table_of(function: Any) -> CurveTable | None:
    """Return the table whose cells a called ``casadi.Function`` finds, None for any other.

    Raises
    ------
    ValueError
        If the table itself is gone; whoever uses its expressions must keep it.
    """
    name = function.name()
    if not name.startswith(PREFIX):
        return None
    call = _CALLS.get(name)
    if call is None:
        raise ValueError(f"the table of '{name}' is gone; keep it as long as its expressions")
    return call.table
