"""Watch a partition while a system moves: how well the dependent coordinates are determined."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.loops import partition
from vehicledyn.multibody.loops.constraint_equations import Gaps, rows_of_system
from vehicledyn.multibody.loops.coupling import most_entangled
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.symbols import declare
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import unfold

Array = NDArray[np.float64]

REGULAR = 1e-3
"""Least singular value of constraints of length one that counts as regular [1]."""


@dataclass(frozen=True)
class PartitionComparison:
    """A partition and the best one at a configuration.

    ``leverage`` is the largest rate that an independent rate of one gives a dependent one with
    the partition in use, ``best_leverage`` that with the best partition, whose dependent
    coordinates are ``best``. ``worst`` is the dependent coordinate with the largest rate.
    """

    leverage: float
    best_leverage: float
    best: tuple[str, ...]
    worst: str


class PartitionMonitor:
    """Compares partitions of a system with the best one at a configuration.

    All coordinates but the driven ones may change their role, and those that only constraints
    know, such as places of contact: they are always dependent.
    """

    def __init__(self, joints: Sequence[Joint], gaps: Gaps, bound: Collection[str] = ()) -> None:
        """Watch the constraints of some joints, of which those in ``bound`` stay dependent."""
        self._joints = joints
        self._gaps = gaps
        self._bound = [k for k, joint in enumerate(joints) if joint.name in bound]
        self._rows: dict[tuple[int, ...], list[int]] = {}
        self._independent: list[int] | None = None

    @staticmethod
    def of(system: System) -> PartitionMonitor:
        """Return the watch of a system: differentiate its constraints."""
        symbols = declare(system)
        rows = rows_of_system(system, symbols.kinematics(unfold(system.bodies)), symbols.time)
        return PartitionMonitor(symbols.joints, Gaps(system, symbols, rows), bound_to(system))

    @property
    def choices(self) -> dict[tuple[int, ...], list[int]]:
        """Rows chosen so far, by the columns they determine; by none, those that are independent.

        What a run goes on with when it is continued: other rows would differ by rounding.
        """
        found = dict(self._rows)
        if self._independent is not None:
            found[()] = self._independent
        return found

    @choices.setter
    def choices(self, known: dict[tuple[int, ...], list[int]]) -> None:
        self._rows = {columns: rows for columns, rows in known.items() if columns}
        self._independent = known.get(())

    @property
    def names(self) -> list[str]:
        """The coordinates."""
        return [joint.name for joint in self._joints]

    @cached_property
    def most_entangled(self) -> int:
        """The largest number of constraints that no single coordinate links together."""
        fixed = {k for k, joint in enumerate(self._joints) if joint.role == "driven"}
        return most_entangled(self._gaps.structure, fixed)

    @property
    def cuts_of_rows(self) -> list[str]:
        """Name of the cut or constraint of each of the rows of :meth:`independent_rows`."""
        return [self._gaps.rows[row].cut for row in self._independent or ()]

    def independent_rows(self, time: float, values: dict[str, float]) -> Array:
        """Return the Jacobian of rows that are independent, by all coordinates but driven ones.

        Which rows are is decided when first asked; there are none where a motion that diverges
        makes them too large to compare.
        """
        _, jacobian, moving = self._at(time, values)
        if self._independent is None:
            self._independent = partition.independent_rows(jacobian[:, moving]) or None
        return np.asarray(jacobian[np.ix_(self._independent or [], moving)])

    def is_regular(self, time: float, values: dict[str, float], least: float = REGULAR) -> bool:
        """Return whether the constraints are far from depending on each other.

        Their least singular value is above ``least`` when they are scaled to length one [1].
        """
        rows = self.independent_rows(time, values)
        with np.errstate(all="ignore"):
            lengths = np.linalg.norm(rows, axis=1, keepdims=True)
        if not len(rows) or not np.isfinite(lengths).all() or not lengths.all():
            return False
        return bool(np.linalg.svd(rows / lengths, compute_uv=False)[-1] > least)

    def leverage(self, time: float, values: dict[str, float], dependent: list[str]) -> float:
        """Return the largest rate that a unit independent rate gives a dependent one."""
        _, jacobian, moving = self._at(time, values)
        columns = [k for k, j in enumerate(self._joints) if j.name in set(dependent)]
        return float(self._leverages(jacobian, columns, moving).max(initial=0.0))

    def pivot(self, time: float, values: dict[str, float], dependent: list[str]) -> float:
        """Return the determinant by which the constraints determine the dependent rates."""
        names, jacobian, _ = self._at(time, values)
        columns = [names.index(name) for name in dependent]
        rows = self._kept(jacobian, columns)
        return float(np.linalg.det(jacobian[np.ix_(rows, columns)])) if rows else 0.0

    def pivots(self, times: Array, values: dict[str, Array], dependent: Sequence[str]) -> Array:
        """Return the determinants of :meth:`pivot` at many times, shape (n_times,).

        ``values`` are those of coordinates by name, of shape (n_times,) each.
        """
        columns = [self.names.index(name) for name in dependent]
        q = np.array([values.get(j.name, np.full(len(times), j.start)) for j in self._joints])
        if not len(times):
            return np.zeros(0)
        jacobians = self._gaps.jacobians(times, q)
        rows = self._kept(jacobians[0], columns)
        if not rows:
            return np.zeros(len(times))
        return np.asarray(np.linalg.det(jacobians[:, rows][:, :, columns]))

    def compare(
        self, time: float, values: dict[str, float], dependent: list[str]
    ) -> PartitionComparison:
        """Compare the partition with these dependent rates with the best one.

        Parameters
        ----------
        time
            Time [s].
        values
            Coordinates by name [m, rad]; those that are missing are at their start.
        dependent
            Names of the coordinates whose rates are dependent.
        """
        names, jacobian, moving = self._at(time, values)
        pairs = partition.best_pairs(
            jacobian, moving, must=self._bound, holonomic=self._gaps.holonomic
        )
        columns = [column for _, column in pairs]
        self._rows.setdefault(tuple(columns), [row for row, _ in pairs])
        now = self._leverages(jacobian, [names.index(n) for n in dependent], moving)
        best = self._leverages(jacobian, columns, moving)
        return PartitionComparison(
            float(now.max(initial=0.0)),
            float(best.max(initial=0.0)),
            tuple(names[c] for c in sorted(columns)),
            dependent[int(np.argmax(now))] if now.size else "",
        )

    def _at(self, time: float, values: dict[str, float]) -> tuple[list[str], Array, list[int]]:
        """Return names, Jacobian and the indices of the coordinates that are not driven."""
        q = np.array([values.get(j.name, j.start) for j in self._joints])
        moving = [k for k, j in enumerate(self._joints) if j.role != "driven" and j.type.is_paired]
        return [j.name for j in self._joints], self._gaps.jacobian(time, q), moving

    def _leverages(self, jacobian: Array, columns: list[int], moving: list[int]) -> Array:
        """Return the largest entry of each row of B in q̇_u = B q̇_v."""
        others = [k for k in moving if k not in set(columns)]
        if not columns or not others:
            return np.zeros(len(columns))
        rows = self._kept(jacobian, columns)
        if not rows:
            return np.full(len(columns), np.inf)
        kept = jacobian[rows]
        try:
            found = np.linalg.solve(kept[:, columns], -kept[:, others])
        except np.linalg.LinAlgError:
            return np.full(len(columns), np.inf)
        return np.asarray(np.abs(found).max(axis=1))

    def _kept(self, jacobian: Array, columns: list[int]) -> list[int]:
        """Return the rows that determine some columns, chosen when first asked for.

        None are returned where the columns are not determined at all.
        """
        key = tuple(columns)
        if key not in self._rows:
            pairs = partition.best_pairs(jacobian, columns, holonomic=self._gaps.holonomic)
            if len(pairs) < len(columns):
                return []
            self._rows[key] = [row for row, _ in pairs]
        return self._rows[key]


def freed(system: System, values: dict[str, float], parameters: Array) -> System:
    """Return a system that starts elsewhere, with the choice of the partition left open.

    Parameters
    ----------
    system
        The system.
    values
        Coordinates and rates by name; others stay as they are.
    parameters
        Values of its parameters, which assembly and partition use, shape (n_parameters,).
    """
    entries = [
        replace(entry, value=float(value))
        for entry, value in zip(system.table.entries, parameters, strict=True)
    ]
    bodies, bound = [], bound_to(system)
    for body in system.bodies:
        joints = [_moved(j, values, bound) if isinstance(j, Joint) else j for j in body.joints]
        bodies.append(replace(body, joints=tuple(joints)))
    return replace(system, bodies=tuple(bodies), table=replace(system.table, entries=entries))


def bound_to(system: System) -> set[str]:
    """Return the coordinates declared dependent that only constraints know."""
    bodies = [body for body in system.bodies if body.is_abstract]
    joints = [joint for body in bodies for joint in body.joints if isinstance(joint, Joint)]
    return {joint.name for joint in joints if joint.role == "dependent"}


def _moved(joint: Joint, values: dict[str, float], bound: set[str]) -> Joint:
    keeps = joint.role == "driven" or joint.name in bound or not joint.type.is_paired
    return replace(
        joint,
        start=values.get(joint.name, joint.start) if joint.type.has_position else 0.0,
        start_rate=values.get(joint.rate_name, joint.start_rate),
        role=joint.role if keeps else "auto",
    )
