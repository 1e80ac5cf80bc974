"""Constraint equations with multipliers and projection: the second way to close loops.

All coordinates that are not driven are states. Accelerations and multipliers solve

    [M  Jᵀ] [ q̈ ]   [Q - c]
    [J  0 ] [-λ] = [ -γ  ],

and before they do, the states x, w are put onto the constraints by the smallest step in the
metric of the masses (Lubich et al. (1992), MEXX; Eich (1993), SIAM J. Numer. Anal. 30): a Newton
step of h(q) = 0 from x, and J v + h_t = 0 exactly. So the constraints hold wherever the equations
are evaluated, and no coordinate has to determine another: only a Jacobian that loses its rank is
singular. Hairer, Wanner (1996), Solving Ordinary Differential Equations II, section VII.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.loops.closure import MultiplierClosure
from vehicledyn.multibody.loops.coupling import most_entangled
from vehicledyn.multibody.loops.loop_closure import Loops
from vehicledyn.multibody.model.symbols import Symbols
from vehicledyn.multibody.model.system import MOST_ENTANGLED, System
from vehicledyn.multibody.recursion.forward_dynamics import TreeProblem
from vehicledyn.multibody.recursion.mass_matrix import mass_matrix
from vehicledyn.multibody.recursion.newton_euler import inverse_dynamics
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import Rows
from vehicledyn.symbolic.kkt import SaddlePoint
from vehicledyn.symbolic.ops import Scalar

_SINGULAR = 1e-12


@dataclass(frozen=True)
class Projection:
    """States, and the coordinates and rates on the constraints that belong to them.

    ``coordinates`` and ``rates`` are the symbols of the states by coordinate. ``gap`` and
    ``opening`` are the errors of the constraints before the states are put onto them.
    """

    coordinates: dict[str, Scalar]
    rates: dict[str, Scalar]
    gap: Scalar
    opening: Scalar
    old: tuple[Scalar, Scalar]
    new: tuple[Scalar, Scalar]

    def applied(self, expression: Scalar) -> Scalar:
        """Return an expression of coordinates and rates as one of the states."""
        (q, v), (new_q, new_v) = self.old, self.new
        return ops.substitute(ops.substitute(expression, v, new_v), q, new_q)


class ConstrainedMotion:
    """The constrained motion of one system."""

    def __init__(self, system: System, symbols: Symbols, loops: Loops) -> None:
        """Factorise masses and constraints at symbolic coordinates.

        Raises
        ------
        InputError
            If the mass matrix of all coordinates is singular at the start.
        """
        self._symbols, self._loops = symbols, loops
        joints = symbols.joints
        self.free = [k for k, j in enumerate(joints) if j.role != "driven" and j.type.has_speed]
        self._place = {k: i for i, k in enumerate(self.free)}
        self._kept = [row for row, _ in loops.closure.partition.pairs]
        mass = _mass_rows(symbols, loops, self.free)
        if not _is_regular(system, symbols, loops, mass):
            raise InputError(
                f"system '{system.name}': some coordinates move no mass by themselves, as places "
                "of contact do; multipliers need a mass for each, so take 'constraint_method: "
                "partitioning'"
            )
        jacobian = [
            {self._place[c]: v for c, v in loops.closure.jacobian[row].items() if c in self._place}
            for row in self._kept
        ]
        self._saddle = SaddlePoint(mass, jacobian)

    @property
    def rows(self) -> list[int]:
        """Rows of the constraints that have multipliers, in their order."""
        return self._kept

    @property
    def solves_sparsely(self) -> bool:
        """Whether a sparse matrix is factorised at run time, by a call."""
        return not self._saddle.is_unrolled

    def closed(self, found: dict[int, Scalar] | None = None) -> Loops:
        """Return the loops without dependent coordinates, with the multipliers once found."""
        closure = self._loops.closure
        none = replace(closure.partition, blocks=())
        own = MultiplierClosure(
            none, closure.jacobian, closure.rate, closure.quadratic, found or {}
        )
        positions = replace(self._loops.positions, blocks=())
        return replace(self._loops, closure=own, positions=positions)

    def projection(self) -> Projection:
        """Return the states, with what puts them onto the constraints."""
        s = self._symbols
        names = [s.joints[k].name for k in self.free]
        places = [j.name for j in s.joints if j.role != "driven" and j.type.has_position]
        states = {name: ops.symbol(f"{name}_state") for name in places}
        rates = {name: ops.symbol(f"{name}_rate_state") for name in names}
        rows = self._loops.constraints
        gaps = [
            rows[r].residual.expression if rows[r].is_holonomic else ops.scalar(0.0)
            for r in self._kept
        ]
        known = {**s.rates, **rates}
        openings = [self._opening(row, known) for row in self._kept]
        nothing = [ops.scalar(0.0)] * len(self.free)
        step = self._saddle.solve([*nothing, *(-gap for gap in gaps)])
        change = self._saddle.solve([*nothing, *(-opening for opening in openings)])
        q, x = (ops.column([table[n] for n in places]) for table in (s.coordinates, states))
        v, w = (ops.column([table[n] for n in names]) for table in (s.rates, rates))
        steps = self._steps_of_places(dict(zip(names, step, strict=False)))
        moved = ops.substitute(ops.column([steps[n] for n in places]), q, x)
        gap = ops.substitute(largest_size(gaps), q, x)
        return Projection(
            states,
            rates,
            gap,
            largest_size(openings),
            (q, v),
            (x + moved, w + ops.column(change[: len(names)])),
        )

    def _steps_of_places(self, step: dict[str, Scalar]) -> dict[str, Scalar]:
        """Return small steps of all positions from those along the speeds.

        A small turn δ moves a quaternion Q by ½ Q ∘ (0, δ), as an angular velocity does in time.
        """
        s = self._symbols
        found = {j.name: step[j.name] for j in s.joints if j.name in step and j.type.is_paired}
        for joint in s.joints:
            if joint.type.element == 0:
                given = [s.coordinates[name] for name in joint.positions]
                turn = [step[name] for name in joint.speeds]
                none = joint.type.rates(given, [ops.scalar(0.0)] * len(turn))
                pairs = zip(joint.type.rates(given, turn), none, strict=True)
                moved = [rate - rest for rate, rest in pairs]
                found |= dict(zip(joint.positions, moved, strict=True))
        return found

    def accelerations(
        self, problem: TreeProblem, given: dict[str, Scalar]
    ) -> tuple[dict[str, Scalar], dict[int, Scalar]]:
        """Return the accelerations of the free coordinates by name, and the multipliers by row.

        ``given`` are the accelerations of the driven coordinates.
        """
        p, joints = problem, self._symbols.joints
        needed, _ = inverse_dynamics(p.kinematics, p.wrenches, p.gravity, p.inertias)
        right = [
            p.joint_forces.get(joints[k].name, 0.0) - needed[joints[k].name] for k in self.free
        ]
        closure = self._loops.closure
        for row in self._kept:
            total = -closure.quadratic[row]
            for column, entry in closure.jacobian[row].items():
                if column not in self._place:
                    total = total - entry * given[joints[column].name]
            right.append(total)
        found = self._saddle.solve([ops.scalar(item) for item in right])
        count = len(self.free)
        names = [joints[k].name for k in self.free]
        multipliers = {row: -found[count + k] for k, row in enumerate(self._kept)}
        return dict(zip(names, found[:count], strict=True)), multipliers

    def impulse_response(self, gradient: dict[int, Scalar]) -> list[Scalar]:
        """Return the jumps of the free rates by a unit impulse along a gradient."""
        side = [gradient.get(k, ops.scalar(0.0)) for k in self.free]
        side += [ops.scalar(0.0)] * len(self._kept)
        return self._saddle.solve(side)[: len(self.free)]

    def _opening(self, row: int, rates: dict[str, Scalar]) -> Scalar:
        closure, joints = self._loops.closure, self._symbols.joints
        total = closure.rate[row]
        for column, entry in closure.jacobian[row].items():
            total = total + entry * rates[joints[column].name]
        return total


def multipliers_of(system: System, symbols: Symbols, loops: Loops) -> ConstrainedMotion | None:
    """Return the constrained motion with multipliers where they are asked for or do better.

    They do where many constraints are entangled, if each coordinate moves a mass.

    Raises
    ------
    InputError
        If they are asked for where they cannot be had.
    """
    if not may_take_multipliers(system, symbols, loops):
        return None
    try:
        return ConstrainedMotion(system, symbols, loops)
    except InputError:
        if system.constraint_method == "auto":
            return None
        raise


def may_take_multipliers(system: System, symbols: Symbols, loops: Loops) -> bool:
    """Return whether :func:`multipliers_of` would try."""
    method = system.constraint_method
    if method == "partitioning" or not loops.constraints:
        return False
    return method != "auto" or are_entangled(symbols, loops.gaps.structure)


def are_entangled(symbols: Symbols, structure: Sequence[set[int]]) -> bool:
    """Return whether so many constraints are entangled that multipliers do better."""
    fixed = {k for k, joint in enumerate(symbols.joints) if joint.role == "driven"}
    return most_entangled(structure, fixed) > MOST_ENTANGLED


def _mass_rows(symbols: Symbols, loops: Loops, free: list[int]) -> Rows:
    """Return the mass matrix of the free coordinates at symbolic coordinates."""
    names = {symbols.joints[k].name: i for i, k in enumerate(free)}
    rows: Rows = [{} for _ in free]
    for (a, b), value in mass_matrix(loops.kinematics, set(names)).items():
        rows[names[a]][names[b]] = value
    return rows


def _is_regular(system: System, symbols: Symbols, loops: Loops, rows: Rows) -> bool:
    """Return whether the mass matrix is positive definite at the start."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

    entries = system.table.entries
    inputs = [symbols.time, symbols.coordinate_column, ops.column([e.symbol for e in entries])]
    places = [(i, j) for i, row in enumerate(rows) for j in row]
    q = np.array([loops.start[j.name] for j in symbols.joints])
    column = ops.column([v for row in rows for v in row.values()])
    found = ops.numeric(inputs, column)(0.0, q, np.array([e.value for e in entries]))
    matrix = np.zeros((len(rows), len(rows)))
    for (i, j), value in zip(places, found[:, 0], strict=True):
        matrix[i, j] = value
    sizes = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    if not (np.isfinite(matrix).all() and (sizes > 0.0).all()):
        return False
    scaled = matrix / np.outer(sizes, sizes)
    count, owner = connected_components(csr_matrix(scaled), directed=False)
    order = np.argsort(owner, kind="stable")
    groups = np.split(order, np.cumsum(np.bincount(owner, minlength=count))[:-1])
    try:
        lower = [np.linalg.cholesky(scaled[np.ix_(group, group)]) for group in groups]
    except np.linalg.LinAlgError:
        return False
    return all(float(np.diag(factor).min()) ** 2 > _SINGULAR for factor in lower)


def largest_size(items: list[Scalar]) -> Scalar:
    """Return the largest of absolute values, zero for none."""
    largest: Scalar = ops.scalar(0.0)
    for item in items:
        largest = ops.maximum(largest, ops.absolute(item))
    return largest
