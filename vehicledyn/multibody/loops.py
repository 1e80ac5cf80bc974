"""From cuts to a closure: assemble, choose the dependent coordinates, differentiate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody import assembly, partition
from vehicledyn.multibody.closure import Closure
from vehicledyn.multibody.cuts import Residual
from vehicledyn.multibody.kinematics import Kinematics
from vehicledyn.multibody.parts import Motion
from vehicledyn.multibody.system import System
from vehicledyn.multibody.tree import Tree
from vehicledyn.multibody.unknowns import Symbols
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


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


def close(
    system: System, tree: Tree, symbols: Symbols, motion: dict[str, Motion], time: float = 0.0
) -> Loops:
    """Assemble the loops, partition the coordinates and derive the closure."""
    bare = Kinematics(tree, symbols.coordinates, symbols.rates)
    constraints = [
        Constraint(cut.name, residual)
        for cut in system.cuts
        for residual in cut.residuals(bare.between(cut.body_a, cut.body_b))
    ]
    h = ops.column([c.residual.expression for c in constraints])
    jacobian = ops.jacobian(h, symbols.coordinate_column)
    q = _assembled(system, symbols, motion, constraints, h, jacobian, time)
    chosen = _partition(system, symbols, jacobian, q)
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


def _values(system: System) -> NDArray[np.float64]:
    return np.array([entry.value for entry in system.table.entries])


def _parameters(system: System) -> Scalar:
    return ops.column([entry.symbol for entry in system.table.entries])


def _assembled(
    system: System,
    symbols: Symbols,
    motion: dict[str, Motion],
    constraints: list[Constraint],
    h: Scalar,
    jacobian: Scalar,
    time: float,
) -> NDArray[np.float64]:
    """Return all coordinates at the start, with every loop closed."""
    q = np.array([j.start for j in symbols.joints])
    states = [s for part in symbols.states.values() for s in part.values()]
    starts = [v.start for part in system.parts for v in part.states()]
    driven = [k for k, j in enumerate(symbols.joints) if j.name in motion]
    positions = ops.column([motion[symbols.joints[k].name].position for k in driven])
    known = [symbols.time, ops.column(states), _parameters(system)]
    q[driven] = ops.numeric(known, positions)(time, starts, _values(system))[:, 0]
    fixed = ("independent", "driven")
    free = [k for k, j in enumerate(symbols.joints) if j.role not in fixed]
    inputs = [symbols.coordinate_column, symbols.time, _parameters(system)]
    gaps, slopes = ops.numeric(inputs, h), ops.numeric(inputs, jacobian)
    rest = (time, _values(system))

    def at(values: NDArray[np.float64]) -> NDArray[np.float64]:
        full = q.copy()
        full[free] = values
        return full

    q[free] = assembly.assemble(
        lambda values: gaps(at(values), *rest)[:, 0],
        lambda values: slopes(at(values), *rest)[:, free],
        q[free],
        [c.cut for c in constraints],
    )
    return q


def _partition(
    system: System, symbols: Symbols, jacobian: Scalar, q: NDArray[np.float64]
) -> partition.Partition:
    inputs = [symbols.coordinate_column, symbols.time, _parameters(system)]
    numbers = ops.numeric(inputs, jacobian)(q, 0.0, _values(system))
    roles = [j.role for j in symbols.joints]
    return partition.choose(
        numbers,
        [set(row) for row in ops.rows_of(jacobian)],
        must=[k for k, role in enumerate(roles) if role == "dependent"],
        may=[k for k, role in enumerate(roles) if role == "auto"],
        names=[j.name for j in symbols.joints],
    )
