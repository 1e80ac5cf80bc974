"""Where loops are assembled to with other parameters, and how that follows the parameters.

Coordinates of the role "auto" move from their start values as little as may be when the loops are
assembled, the independent ones among them too, so that a start follows what the loops depend on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.multibody.loops.configuration import LoopAssembly
from vehicledyn.multibody.loops.constraint_equations import Gaps, rows_of_system
from vehicledyn.multibody.loops.loop_closure import AssemblyState, guesses_at, starts_at
from vehicledyn.multibody.model.symbols import declare, locked, motions
from vehicledyn.multibody.model.system import System
from vehicledyn.multibody.model.tree import unfold
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.parameters import Parameter
from vehicledyn.symbolic.sparse_rows import rows_of

Array = NDArray[np.float64]

_POLISHED = 3
"""Newton steps behind an assembly, which ends at gaps of 1e-12."""

_RANK = 1e-10
_MOVABLE = "auto", "dependent"
_SAME = 1e-9
"""Distance of an assembled coordinate from a start that was assembled from it [m, rad]."""

_STEP, _LEAST = 1e-3, 1.0
"""Part of a parameter by which it is changed, and what stands for one that is zero, in SI."""


class AssembledStart:
    """The start of a system whose loops let "auto" coordinates move, at any parameters.

    Parameters
    ----------
    system
        The system, with cuts or constraints; its parameters and starts are where slopes are taken.
    """

    def __init__(self, system: System) -> None:
        self._system, self._symbols = system, declare(system)
        tree, symbols = unfold(system.bodies), self._symbols
        rows = rows_of_system(system, symbols.kinematics(tree), symbols.time)
        self._gaps = Gaps(system, symbols, rows)
        self._motion = motions(system, symbols)
        self._begin = starts_at(system, symbols, self._motion)
        self._guess = guesses_at(system, symbols)
        self._still = locked(system, symbols)
        self.names = [joint.name for joint in symbols.joints]

    def at(self, values: Array, starts: Mapping[str, float] | None = None) -> Array:
        """Return all coordinates with the loops closed, in the order of ``names``.

        Parameters
        ----------
        values
            All parameters of the system, in the order of its table.
        starts
            Start values of coordinates, before they are assembled; as the system has them if None.

        Raises
        ------
        NumericalError
            If the loops cannot be assembled.
        """
        place = LoopAssembly(self._symbols.joints, self._gaps.at(values), 0.0, self._still)
        begin = self._begin(AssemblyState(), values)
        for k, number in zip(self._written, self._starts(values)[:, 0], strict=True):
            begin[k] = number
        for k, name in enumerate(self.names):
            if starts and name in starts and name not in self._motion:
                begin[k] = starts[name]
        return place.assembled_by(begin, self._guess(0.0, values))

    def _polished(self, values: Array) -> Array:
        """Return them with gaps of rounding alone, so that differences are smooth."""
        q, gaps = self.at(values), self._gaps.at(values)
        free = LoopAssembly(self._symbols.joints, gaps, 0.0, self._still).columns(*_MOVABLE)
        for _ in range(_POLISHED):
            slopes = gaps.jacobian(0.0, q)[: gaps.holonomic, free]
            q[free] -= np.linalg.lstsq(slopes, gaps.residual(0.0, q), rcond=_RANK)[0]
        return q

    def slopes(self, values: Array) -> Array:
        """Return the derivatives of all coordinates by the parameters, by Richardson's differences.

        The path to the start matters where loops leave freedom, so that these are of the whole
        search: to about 1e-9.
        """
        found = np.zeros((len(self.names), len(values)))
        for k in self.acting:
            size = _STEP * (abs(values[k]) or _LEAST)
            wide, near = (self._difference(values, k, part * size) for part in (1.0, 0.5))
            found[:, k] = (4.0 * near - wide) / 3.0
        return found

    def _difference(self, values: Array, k: int, step: float) -> Array:
        ends = []
        for side in (step, -step):
            changed = values.copy()
            changed[k] += side
            try:
                ends.append(self._polished(changed))
            except NumericalError as error:
                name, part = self._entries[k].name, side / (abs(values[k]) or _LEAST)
                raise NumericalError(
                    f"how the start follows '{name}' is not known: changed by {part:+.2%} {error}"
                ) from None
        return (ends[0] - ends[1]) / (2.0 * step)

    @property
    def _entries(self) -> list[Parameter]:
        return self._system.table.entries

    @cached_property
    def acting(self) -> list[int]:
        """Places of the parameters that starts and loops depend on."""
        symbols = ops.column([entry.symbol for entry in self._system.table.entries])
        written = [self._system.starts[self.names[k]] for k in self._written]
        driven = [item.position for item in self._motion.values()]
        rows = ops.stacked(self._gaps.expressions, ops.column([*written, *driven]))
        return sorted({k for row in rows_of(ops.jacobian(rows, symbols)) for k in row})

    @cached_property
    def _written(self) -> list[int]:
        """Places of the coordinates whose start is written as an expression."""
        known = self._system.starts
        return [k for k, name in enumerate(self.names) if name in known]

    @cached_property
    def _starts(self) -> Callable[..., Array]:
        written = ops.column([self._system.starts[self.names[k]] for k in self._written])
        return ops.numeric([ops.column([e.symbol for e in self._system.table.entries])], written)


@dataclass(frozen=True)
class DrawnStarts:
    """States that are moved where loops are assembled: ``places`` of their coordinates by name."""

    assembled: AssembledStart
    places: dict[str, int]

    @staticmethod
    def of(system: System, equations: Equations) -> DrawnStarts | None:
        """Return those of a system, None without any.

        There are none where all independent coordinates keep their starts, where parameters of the
        system are numbers in its equations, and where the equations start elsewhere.
        """
        starts = {state.name: state.start for state in equations.states}
        names = {parameter.name for parameter in equations.parameters}
        auto = [j.name for j in system.joints() if j.role == "auto" and j.name in starts]
        entries = system.table.entries
        is_bound = bool(system.cuts or system.constraints)
        if not auto or not is_bound or any(entry.name not in names for entry in entries):
            return None
        assembled = AssembledStart(system)
        found = DrawnStarts(assembled, {name: assembled.names.index(name) for name in auto})
        now = found.at(np.array([entry.value for entry in entries]))
        return found if all(abs(now[name] - starts[name]) < _SAME for name in auto) else None

    def at(self, values: Array, starts: Mapping[str, float] | None = None) -> dict[str, float]:
        """Return the starts by name, see :meth:`AssembledStart.at`."""
        found = self.assembled.at(values, starts)
        return {name: float(found[k]) for name, k in self.places.items()}

    def slopes(self, values: Array) -> Array:
        """Return their derivatives by the parameters of the system, (n, n_parameters)."""
        return self.assembled.slopes(values)[list(self.places.values())]
