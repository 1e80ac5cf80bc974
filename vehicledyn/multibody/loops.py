"""From cuts to a closure: assemble, choose the dependent coordinates, differentiate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.multibody import assembly, partition
from vehicledyn.multibody.closure import Closure
from vehicledyn.multibody.cuts import Residual
from vehicledyn.multibody.kinematics import Kinematics
from vehicledyn.multibody.parts import Motion
from vehicledyn.multibody.system import System
from vehicledyn.multibody.tree import Tree
from vehicledyn.multibody.unknowns import Symbols
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import Rows
from vehicledyn.symbolic.ops import Scalar

Array = NDArray[np.float64]
_STEP_ASIDE = 1e-3
"""Step that tells a singular configuration from redundant constraints [m, rad]."""


@dataclass(frozen=True)
class Constraint:
    """One residual with the cut it belongs to."""

    cut: str
    residual: Residual


@dataclass(frozen=True)
class Loops:
    """Constraints of a system, their closure and the assembled start.

    ``start`` holds the assembled value of every coordinate. Coordinates are indexed like
    ``Symbols.joints``.
    """

    constraints: list[Constraint]
    closure: Closure
    start: dict[str, float]

    @property
    def dependent(self) -> list[int]:
        """Indices of the dependent coordinates, in the order of solution."""
        return [column for _, column in self.closure.partition.pairs]


@dataclass(frozen=True)
class _Gaps:
    """Residuals and Jacobian of all constraints at given values of all coordinates."""

    residual: Callable[[Array], Array]
    jacobian: Callable[[Array], Array]
    cuts: list[str]


def close(
    system: System, tree: Tree, symbols: Symbols, motion: dict[str, Motion], time: float = 0.0
) -> Loops:
    """Assemble the loops, partition the coordinates and derive the closure.

    Parameters
    ----------
    system, tree, symbols
        The system, its links and its symbols.
    motion
        Position and velocity of the driven coordinates.
    time
        Time at which the loops are assembled [s].

    Raises
    ------
    NumericalError
        If the loops cannot be assembled; the message names the cuts that stay open.
    InputError
        If a coordinate declared dependent is not determined by the loops, or the assembled
        configuration is singular.
    """
    bare = Kinematics(tree, symbols.coordinates, symbols.rates)
    constraints = [
        Constraint(cut.name, residual)
        for cut in system.cuts
        for residual in cut.residuals(bare.between(cut.body_a, cut.body_b))
    ]
    h = ops.column([c.residual.expression for c in constraints])
    jacobian = ops.jacobian(h, symbols.coordinate_column)
    gaps = _gaps(system, symbols, constraints, h, jacobian)
    q = _start(system, symbols, motion, time)
    q = _assembled(symbols, gaps, q)
    chosen = _partition(symbols, gaps, ops.rows_of(jacobian), q)
    rate = ops.derivative(h, symbols.time, 1.0)
    first = ops.derivative(h, symbols.coordinate_column, symbols.rate_column) + rate
    second = ops.derivative(first, symbols.coordinate_column, symbols.rate_column) + ops.derivative(
        first, symbols.time, 1.0
    )
    closure = Closure(chosen, ops.rows_of(jacobian), _scalars(rate), _scalars(second))
    start = {j.name: float(value) for j, value in zip(symbols.joints, q, strict=True)}
    return Loops(constraints, closure, start)


def _scalars(column: Scalar) -> list[Scalar]:
    return [column[k] for k in range(column.shape[0])]


def _gaps(
    system: System,
    symbols: Symbols,
    constraints: list[Constraint],
    h: Scalar,
    jacobian: Scalar,
) -> _Gaps:
    entries = system.table.entries
    inputs = [symbols.coordinate_column, ops.column([entry.symbol for entry in entries])]
    values = np.array([entry.value for entry in entries])
    residual, slopes = ops.numeric(inputs, h), ops.numeric(inputs, jacobian)
    return _Gaps(
        lambda q: residual(q, values)[:, 0],
        lambda q: slopes(q, values),
        [c.cut for c in constraints],
    )


def _start(system: System, symbols: Symbols, motion: dict[str, Motion], time: float) -> Array:
    """Return the start values of all coordinates, driven ones from their motion."""
    q = np.array([j.start for j in symbols.joints])
    states = [s for part in symbols.states.values() for s in part.values()]
    starts = [v.start for part in system.parts for v in part.states()]
    entries = system.table.entries
    known = [symbols.time, ops.column(states), ops.column([e.symbol for e in entries])]
    driven = [k for k, j in enumerate(symbols.joints) if j.name in motion]
    positions = ops.column([motion[symbols.joints[k].name].position for k in driven])
    q[driven] = ops.numeric(known, positions)(time, starts, [e.value for e in entries])[:, 0]
    return q


def _assembled(symbols: Symbols, gaps: _Gaps, start: Array) -> Array:
    """Return all coordinates with every loop closed, near the given ones."""
    fixed = ("independent", "driven")
    free = [k for k, j in enumerate(symbols.joints) if j.role not in fixed]

    def at(values: Array) -> Array:
        full = start.copy()
        full[free] = values
        return full

    found = assembly.assemble(
        lambda values: gaps.residual(at(values)),
        lambda values: gaps.jacobian(at(values))[:, free],
        start[free],
        gaps.cuts,
    )
    return at(found)


def _partition(symbols: Symbols, gaps: _Gaps, rows: Rows, q: Array) -> partition.Partition:
    chosen = _choose(symbols, gaps, rows, q)
    if chosen.redundant:
        _refuse_singular(symbols, gaps, rows, q, chosen)
    return chosen


def _choose(symbols: Symbols, gaps: _Gaps, rows: Rows, q: Array) -> partition.Partition:
    roles = [j.role for j in symbols.joints]
    return partition.choose(
        gaps.jacobian(q),
        [set(row) for row in rows],
        must=[k for k, role in enumerate(roles) if role == "dependent"],
        may=[k for k, role in enumerate(roles) if role == "auto"],
        names=[j.name for j in symbols.joints],
    )


def _refuse_singular(
    symbols: Symbols, gaps: _Gaps, rows: Rows, q: Array, chosen: partition.Partition
) -> None:
    """Raise InputError if constraints that look redundant are not so a little further on.

    The system moves by a small step that the constraints allow to first order, and is
    assembled again. Redundant constraints stay so; at a singular configuration (book, figure
    2.5) the rank grows with the step.
    """
    moving = [k for k, j in enumerate(symbols.joints) if j.role in ("auto", "dependent")]
    _, sizes, directions = np.linalg.svd(gaps.jacobian(q)[:, moving])
    rank = int(np.sum(sizes > partition.RANK_TOLERANCE * max(1.0, sizes.max(initial=0.0))))
    allowed = directions[rank:]
    if not len(allowed):
        return
    step = q.copy()
    # Any direction will do that no symmetry prefers.
    step[moving] += _STEP_ASIDE * allowed.T @ np.cos(np.arange(len(allowed)) + 1.0)
    try:
        near = _assembled(symbols, gaps, step)
    except NumericalError:
        return
    lost = len(chosen.redundant) - len(_choose(symbols, gaps, rows, near).redundant)
    if lost > 0:
        cuts = ", ".join(f"'{gaps.cuts[row]}'" for row in chosen.redundant)
        raise InputError(
            f"the assembled configuration is singular: {lost} of the constraints of {cuts} "
            "do not act there; start the coordinates of these loops elsewhere"
        )
