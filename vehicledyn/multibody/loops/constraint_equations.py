"""The rows of all constraints of a system: their expressions, derivatives and numbers.

Holonomic rows h(q, t) come first, then the non-holonomic ones B q̇ + b.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.loops.cut_motion import MovingResidual, moving_residuals
from vehicledyn.multibody.model.constraints import Geometry, Movement
from vehicledyn.multibody.model.cuts import Residual
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.symbols import Symbols
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic import frames, ops
from vehicledyn.symbolic.elimination import Rows
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.sparse_rows import matrix_of, rows_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ConstraintRow:
    """One residual with the cut or constraint it belongs to.

    ``frame`` names the axes of its force, ``is_holonomic`` whether it is one of the coordinates
    or one of the rates. Rows of cuts bring their derivatives along.
    """

    cut: str
    residual: Residual
    frame: str = "world"
    is_holonomic: bool = True
    moving: MovingResidual | None = None

    @property
    def bears(self) -> bool:
        """Whether a force belongs to it; none does where it only defines a coordinate."""
        return bool(self.residual.force_channel)

    @property
    def label(self) -> str:
        """Name of the row: that of the cut and of the force, which tells rows of a cut apart."""
        return f"{self.cut}.{self.residual.force_channel}".rstrip(".")


def rows_of_system(system: System, bare: Kinematics, time: Scalar) -> list[ConstraintRow]:
    """Return the residuals of all cuts and constraints, holonomic ones first.

    ``bare`` is the kinematics at symbolic coordinates and rates; it keeps what the cuts evaluate.
    """
    tree = bare.tree
    rows = []
    from_ancestor: dict[int, Kinematics] = {}
    for cut in system.cuts:
        frame = tree.link_name(tree.common_ancestor(cut.body_a, cut.body_b))
        for moving in moving_residuals(cut, bare, from_ancestor):
            rows.append(ConstraintRow(cut.name, moving.residual, frame, moving=moving))
    geometry, movement = Geometry(time, bare), Movement(time, bare)
    for constraint in system.constraints:
        with frames.naming("constraint", constraint.name):
            rows.extend(ConstraintRow(constraint.name, r) for r in constraint.residuals(geometry))
    for constraint in system.constraints:
        with frames.naming("constraint", constraint.name):
            rows.extend(
                ConstraintRow(constraint.name, r, is_holonomic=False)
                for r in constraint.speeds(movement)
            )
    return rows


@dataclass(frozen=True)
class RowDerivatives:
    """Rows differentiated: Jacobian by rates, what is left at rest, and at zero acceleration.

    With ``jacobian`` J, ``rate`` c and ``quadratic`` γ the rows demand J q̇ + c = 0 and
    J q̈ + γ = 0; J holds ∂h/∂q and B, c holds ∂h/∂t and b.
    """

    jacobian: Rows
    rate: list[Scalar]
    quadratic: list[Scalar]


class Gaps:
    """Residuals and Jacobian of all rows, as expressions and as numbers."""

    def __init__(self, system: System, symbols: Symbols, rows: list[ConstraintRow]) -> None:
        """Differentiate the rows.

        Raises
        ------
        InputError
            If a constraint is not linear in the rates, or a holonomic one depends on them.
        """
        self.rows = rows
        self.holonomic = sum(row.is_holonomic for row in rows)
        self._symbols = symbols
        q, qd = symbols.coordinate_column, symbols.rate_column
        self._others = ops.column(
            [row.residual.expression for row in rows if row.is_holonomic and row.moving is None]
        )
        self._h = ops.column([row.residual.expression for row in rows[: self.holonomic]])
        self._jacobian = ops.stacked(
            self._cut_jacobian(), symbols.by_speeds(ops.jacobian(self._others, q))
        )
        self._speed = ops.column([row.residual.expression for row in rows[self.holonomic :]])
        self._drift = ops.substitute(self._speed, qd, ops.column([0.0] * len(symbols.joints)))
        if len(rows) > self.holonomic:
            self._jacobian = ops.stacked(self._jacobian, ops.jacobian(self._speed, qd))
        entries = system.table.entries
        self._inputs = [symbols.time, q, ops.column([entry.symbol for entry in entries])]
        self._values = np.array([entry.value for entry in entries])
        if system.constraints:
            expressions = [*_scalars(self._h), *_scalars(self._speed)]
            _check(rows, expressions, symbols, ops.stacked(*self._inputs, qd))
        self._residual = ops.numeric(self._inputs, self._h)
        self._slopes = ops.numeric(self._inputs, self._jacobian)

    @property
    def expressions(self) -> Scalar:
        """Residuals of the holonomic rows, as functions of time, coordinates and parameters."""
        return self._h

    @property
    def cuts(self) -> list[str]:
        """Name of the cut or constraint of each holonomic row."""
        return [row.cut for row in self.rows[: self.holonomic]]

    @cached_property
    def structure(self) -> list[set[int]]:
        """Columns of the structural nonzeros of each row."""
        return [set(row) for row in rows_of(self._jacobian)]

    def at(self, values: Array) -> Gaps:
        """Return the same rows at other values of all parameters."""
        other = copy(self)
        other._values = np.array(values, dtype=float)
        return other

    @cached_property
    def _by_parameter(self) -> Callable[..., Array]:
        return ops.numeric(self._inputs, ops.jacobian(self._h, self._inputs[2]))

    def by_parameter(self, time: float, q: Array) -> Array:
        """Return the derivatives of the holonomic residuals, (n_holonomic, n_parameters)."""
        found: Array = self._by_parameter(time, q, self._values)
        return found

    def residual(self, time: float, q: Array) -> Array:
        """Return the holonomic residuals, shape (n_holonomic,)."""
        return self._residual(time, q, self._values)[:, 0]

    def jacobian(self, time: float, q: Array) -> Array:
        """Return the Jacobian of all rows, shape (n_rows, n_coordinates)."""
        return self._slopes(time, q, self._values)

    def jacobians(self, times: Array, q: Array) -> Array:
        """Return the Jacobian at many times, shape (n_times, n_rows, n_coordinates).

        ``q`` has the shape (n_coordinates, n_times).
        """
        found = self._slopes(times[None, :], q, self._values)
        return np.moveaxis(found.reshape(len(found), len(times), len(q)), 1, 0)

    def drift(self, time: float, q: Array) -> Array:
        """Return c of J q̇ + c = 0, shape (n_rows,): what time alone does to the rows."""
        rates = ops.column(self._rates())
        return ops.numeric(self._inputs, rates)(time, q, self._values)[:, 0]

    def differentiate(self) -> RowDerivatives:
        """Return what the closure of velocities and accelerations needs."""
        s = self._symbols
        q, qd = s.coordinate_column, s.velocity_column
        first = ops.derivative(self._others, q, qd) + ops.derivative(self._others, s.time, 1.0)
        if len(self.rows) > self.holonomic:
            first = ops.stacked(first, self._speed)
        second = ops.derivative(first, q, qd) + ops.derivative(first, s.time, 1.0)
        quadratic = [m.quadratic for m in self._moving] + _scalars(second)
        return RowDerivatives(rows_of(self._jacobian), self._rates(), quadratic)

    @property
    def _moving(self) -> list[MovingResidual]:
        return [row.moving for row in self.rows if row.moving is not None]

    def _cut_jacobian(self) -> Scalar:
        place = {joint.name: k for k, joint in enumerate(self._symbols.joints)}
        rows = [{place[n]: v for n, v in m.slopes.items()} for m in self._moving]
        return matrix_of(rows, len(place))

    def _rates(self) -> list[Scalar]:
        rate = ops.derivative(self._h, self._symbols.time, 1.0)
        return [*_scalars(rate), *_scalars(self._drift)]


def _check(
    rows: list[ConstraintRow], expressions: list[Scalar], symbols: Symbols, known: Scalar
) -> None:
    """Refuse rates where none may be, and symbols that a constraint cannot know."""
    rates = symbols.rate_column
    for row, expression in zip(rows, expressions, strict=True):
        if row.is_holonomic and ops.depends_on(expression, rates):
            raise InputError(
                f"constraint '{row.cut}' depends on rates, which 'residuals' must not",
                about=[row.cut],
            )
        if not row.is_holonomic and ops.depends_on(ops.jacobian(expression, rates), rates):
            raise InputError(f"constraint '{row.cut}' is not linear in the rates", about=[row.cut])
        strange = ops.free_symbols(expression, known)
        if strange:
            listed = ", ".join(f"'{name}'" for name in strange)
            raise InputError(
                f"constraint '{row.cut}' depends on {listed}; it may depend on time, coordinates, "
                "rates and parameters only",
                about=[row.cut],
            )


def _scalars(column: Scalar) -> list[Scalar]:
    return [column[k] for k in range(column.shape[0])]
