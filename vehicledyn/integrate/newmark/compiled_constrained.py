"""Steps of Newmark's family on residuals with multipliers, the loop over them compiled.

Residuals are compiled; Jacobians and sparse factors, which serve many steps, are found by Python.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np

from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.integrate.course import MethodState
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.newmark.compiled_steps import CompiledLoop, StateLayout
from vehicledyn.integrate.newmark.constrained_place import ConstrainedPlace
from vehicledyn.integrate.newmark.constrained_steps import ConstrainedSteps
from vehicledyn.integrate.newmark.iteration_matrix import StepFactors
from vehicledyn.integrate.newmark.residual_functions import Instant, residual_functions
from vehicledyn.integrate.newmark.weights import Weights
from vehicledyn.integrate.task import Task
from vehicledyn.kernel.compiled import CompiledEngine
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.newmark.newmark_code import FRESH_JACOBIAN, NewmarkCode, PlaceRecord
from vehicledyn.kernel.point_source import Wanted, compiled
from vehicledyn.symbolic.constrained_equations import ConstrainedEquations


class CompiledConstrainedSteps(CompiledLoop[ConstrainedPlace]):
    """Takes steps as ``ConstrainedSteps`` does, many of them in one call.

    Raises
    ------
    CompilationError
        If the residuals cannot be compiled.
    """

    def __init__(
        self,
        task: Task,
        engine: CompiledEngine,
        weights: Weights,
        code: NewmarkCode,
        steps: ConstrainedSteps,
    ) -> None:
        """Lay out a run of the task, whose kernel has this engine, with the compiled like."""
        self._steps = steps
        self._functions = residual_functions(task.kernel)
        self._is_stabilised = steps.is_stabilised
        super().__init__(task, engine, weights, code)
        _, k, m = self._functions.sizes
        own = self.record.constrained
        own.n_multipliers, own.n_others, own.is_stabilised = m, k, int(self._is_stabilised)
        own.first_order_mass, own.first_order_gamma = (
            weights.first_order_mass,
            weights.first_order_gamma,
        )
        self._tables = TableRows(task.kernel.equations.tables)
        own.close_states, own.close_forces = steps.close, steps.close_forces
        own.residual = _compiled_residual(task)
        own.output = _compiled_output(task) if steps.shows_own else None
        self._give(back=np.zeros(self._functions.sizes[0]))
        own.back_from = np.nan
        if steps.lightness is not None:
            own.spread = _compiled_spread(task)
            pattern = self._functions.equations.spread.sparsity()
            rows, starts = (
                np.array(part, dtype=np.intc) for part in (pattern.row(), pattern.colind())
            )
            self._give(lightness=steps.lightness, arm_columns=rows, arm_starts=starts)
            self._give(arms=np.zeros(2 * len(rows)))
        self._give(given=self._tables.after(np.asarray(task.kernel.parameters, dtype=float)))

    @property
    def _layout(self) -> StateLayout:
        n, k, m = self._functions.sizes
        e = self._functions.equations
        rows = np.array([*e.velocities, *e.others], dtype=np.intp)
        places = rows, list(e.positions), list(e.velocities), np.arange(n)
        room = 8 * n + 6 * k + 8 * m + 2 + len(self.task.kernel.equations.states)
        return StateLayout(*places, n, n + k, 2 * m, room)

    def start(self, point: ConsistentPoint) -> ConstrainedPlace:
        """Return the place from which the motion starts, or starts anew."""
        self.record.matrix[0].is_stale = 1
        return self._steps.start(point)

    def resumed(self, point: ConsistentPoint, numbers: Vector) -> ConstrainedPlace:
        """Return the place from which a run goes on, see :meth:`ConstrainedSteps.resumed`."""
        return self._steps.resumed(point, numbers)

    def carried(self, place: ConstrainedPlace) -> MethodState:
        """Return what a run goes on with behind a place."""
        return self._steps.carried(place)

    def error(self, before: ConstrainedPlace, after: ConstrainedPlace) -> float:
        """Return the largest local error of a step about; the compiled loop finds its own."""
        return self._steps.error(before, after)

    def go_to(self, place: ConstrainedPlace) -> None:
        """Let the run go on from a place."""
        at, arrays, m = self.record.at, self._arrays, self._functions.sizes[2]
        at.time[0], at.size[0] = place.point.time, place.size
        self.record.constrained.back_from = np.nan
        arrays["at.x"][:], arrays["at.z"][:] = place.point.state, place.point.unknowns
        arrays["at.rates"][:] = np.concatenate([place.instant.acceleration, place.other_rate])
        arrays["at.auxiliary"][:] = np.concatenate(place.auxiliary)
        arrays["at.forces"][:m] = place.instant.multiplier
        arrays["at.forces"][m:] = place.correction if self._is_stabilised else 0.0
        arrays["at.change"][:] = 0.0
        change = place.bend if place.change is None else place.change
        if change is not None:
            arrays["at.change"][: len(change)] = change

    def find_jacobian(self) -> None:
        """Find the factors for the step that is wanted, and a Jacobian where it is stale."""
        record, own = self.record, self.record.matrix[0]
        is_new = bool(own.is_stale or not own.has_jacobian)
        size = record.wanted - record.at.time[0]
        place = self.place
        if self._steps.is_resized(place, size):
            self._arrays["back"][:] = self._steps.way_back(place)
            record.constrained.back_from = place.point.time
        self._hand_over(self._steps.factors_for(place, size, is_new=is_new))
        own.is_stale, own.size = 0, size
        if is_new:
            own.has_jacobian = FRESH_JACOBIAN

    def _hand_over(self, found: StepFactors) -> None:
        """Give sparse factors to the compiled code, the diagonal first in L and last in U."""
        own = self.record.constrained
        own.lead, own.scale, own.lever = found.scales
        lower, upper = found.factors.L, found.factors.U
        lower.sort_indices()
        upper.sort_indices()
        self._give(
            l_values=lower.data,
            l_rows=lower.indices,
            l_starts=lower.indptr,
            u_values=upper.data,
            u_rows=upper.indices,
            u_starts=upper.indptr,
            row_place=found.factors.perm_r,
            column_place=found.factors.perm_c,
        )

    def _give(self, **arrays: Any) -> None:
        whole = {
            name: np.ascontiguousarray(array, float if array.dtype.kind == "f" else np.intc)
            for name, array in arrays.items()
        }
        self._hold(self.record.constrained, **whole)

    def _place(self, name: str, at: PlaceRecord) -> ConstrainedPlace:
        n, _, m = self._functions.sizes
        e = self._functions.equations
        x, z, rates, auxiliary, change, forces = (
            self._arrays[f"{name}.{part}"].copy()
            for part in ("x", "z", "rates", "auxiliary", "change", "forces")
        )
        position, velocity, other = (
            x[list(places)] for places in (e.positions, e.velocities, e.others)
        )
        return ConstrainedPlace(
            ConsistentPoint(at.time[0], x, z),
            Instant(at.time[0], position, velocity, rates[:n], forces[:m], other),
            (auxiliary[:n], auxiliary[n:]),
            rates[n:],
            forces[m:] if self._is_stabilised else forces[:0],
            at.size[0],
            change[:n] if at.size[0] else None,
            None if at.size[0] else change[:n],
        )


def _compiled_residual(task: Task) -> int:
    """Return the address of the residuals at points."""

    def parts(e: ConstrainedEquations) -> tuple[Any, ...]:
        return e.force, e.gap, e.opening, e.other_rate

    return _compiled(task, "residuals", parts)


def _compiled_output(task: Task) -> int:
    """Return the address of the channels at points."""

    def parts(e: ConstrainedEquations) -> tuple[Any, ...]:
        return () if e.output is None else (e.output(),)

    return _compiled(task, "channels of steps", parts)


def _compiled_spread(task: Task) -> int:
    """Return the address of the Jacobian of the constraints at points."""
    import casadi

    def parts(e: ConstrainedEquations) -> tuple[Any, ...]:
        return (casadi.vertcat(casadi.SX(0, 1), *e.spread.nonzeros()),)

    return _compiled(task, "Jacobian of the constraints", parts)


def _compiled(
    task: Task, name: str, parts: Callable[[ConstrainedEquations], tuple[Any, ...]]
) -> int:
    """Return the address of functions of points, compiled once for all parameter sets."""
    import casadi

    made = task.kernel.made
    if f"compiled {name}" not in made:
        e = residual_functions(task.kernel).equations
        columns = (e.time, e.position, e.velocity, e.acceleration, e.multiplier, e.other)
        values = casadi.vertcat(*(casadi.densify(x) for x in parts(e)))
        point = casadi.vertcat(*columns)
        wanted = Wanted(values, point, e.parameter, task.kernel.equations.tables, None, False)
        task.progress(f"compiling the {name}", None)
        made[f"compiled {name}"] = compiled(wanted, 1)
    address = ctypes.cast(made[f"compiled {name}"].vd_points, ctypes.c_void_p).value
    return int(address or 0)
