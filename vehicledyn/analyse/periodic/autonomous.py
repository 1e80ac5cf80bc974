"""Equations without time as a field of rates with one parameter, and its exact derivatives."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from vehicledyn.analyse.periodic.autonomous_form import autonomous_form
from vehicledyn.analyse.periodic.invariance import states_of_motion
from vehicledyn.base.errors import InputError, NumericalError, unknown_name
from vehicledyn.base.step_memory import Memory
from vehicledyn.codegen.passes.kernel_functions import operations_in
from vehicledyn.codegen.toolchain.compiler import CompilationError
from vehicledyn.kernel.derivatives import TotalDerivatives
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.interpreted import BufferedFunction
from vehicledyn.kernel.path_code import PathCode, StepTrace
from vehicledyn.kernel.path_tangents import PathTangents
from vehicledyn.kernel.point_slopes import CarriedMotions, PointCode
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations

LEAST = 300
"""Operations from which on a field is compiled; of smaller ones collocation takes a few seconds."""

_MOST_WITHIN = 500
"""Steps in which one step of a path may be made again."""

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Field:
    """Rates and derivatives at some points (n_points, ...), the unknowns eliminated.

    ``rates`` f - f_z g_z⁻¹ g, ``by_state`` f_x - f_z g_z⁻¹ g_x, ``by_parameter`` likewise;
    ``gap`` g_z⁻¹ g, ``follow`` g_z⁻¹ g_x and ``follow_parameter`` g_z⁻¹ g_p correct the unknowns:
    δz = -(gap + follow δx + follow_parameter δp).
    """

    rates: Vector
    by_state: Vector
    by_parameter: Vector
    gap: Vector
    follow: Vector
    follow_parameter: Vector


@dataclass(eq=False)
class AutonomousField:
    """The states that matter of some equations, with one free parameter.

    States that no rate depends on (a path travelled, an angle of rotation) follow the others
    and are set apart; ``kept`` are the others. ``values`` are the parameters in SI; a ``memory``
    keeps the results of steps along branches and of simulations.
    """

    equations: Equations
    parameter: str
    values: Vector
    memory: Memory = field(default_factory=Memory)
    kept: list[int] = field(init=False)
    index: int = field(init=False)

    def __post_init__(self) -> None:
        """Find the parameter and the states that matter; refuse time and contacts that jump."""
        self.values = np.array(self.values, dtype=float)
        e = self.equations = autonomous_form(self.equations, self.values)
        jumping = [event.name for event in e.events if event.guesses]
        if jumping:
            raise InputError(
                f"model '{e.name}': contact may jump at the event '{jumping[0]}', where limit "
                "cycles cannot be followed; take a model of contact that goes over gradually, "
                "such as the elastic one of rails"
            )
        names = [item.name for item in e.parameters]
        if self.parameter not in names:
            raise InputError(unknown_name("parameter", self.parameter, names))
        self.index = names.index(self.parameter)
        self.kept = states_of_motion(e, self.values)
        if not self.kept:
            raise InputError(f"model '{e.name}' has no states that influence its motion")
        self._base = np.array([s.start for s in e.states])
        self._evaluations: dict[int, BufferedFunction] = {}

    @property
    def size(self) -> int:
        """Number of states kept."""
        return len(self.kept)

    @property
    def n_unknowns(self) -> int:
        """Number of algebraic unknowns."""
        return len(self.equations.unknowns)

    @property
    def names(self) -> list[str]:
        """Names of the states kept."""
        return [self.equations.states[k].name for k in self.kept]

    @cached_property
    def depends_on_parameter(self) -> bool:
        """Whether rates or residuals contain the free parameter."""
        import casadi

        entry = self.equations.parameter[self.index]
        return bool(casadi.which_depends(self.whole, entry, 1, False)[0])

    def parameters(self, value: float) -> Vector:
        """Return all parameters with a value of the free one."""
        values = self.values.copy()
        values[self.index] = value
        return values

    def reduced(self, state: Vector) -> Vector:
        """Return the states kept of full ones (..., n_states); remember the others."""
        self._base = np.array(np.asarray(state).reshape(-1, len(self.equations.states))[0])
        return np.asarray(state)[..., self.kept]

    def full(self, states: Vector) -> Vector:
        """Return full states (..., n_states) of kept ones, the others as remembered."""
        whole = np.broadcast_to(self._base, (*states.shape[:-1], self._base.size)).copy()
        whole[..., self.kept] = states
        return whole

    def evaluate(self, states: Vector, unknowns: Vector, value: float) -> Field:
        """Return the field at states (n_points, n_kept) with unknowns (n_points, n_unknowns).

        Raises
        ------
        NumericalError
            If a value is not finite or the loops are singular.
        """
        return self._field(states, unknowns, self.parameters(value))

    @property
    def is_carried(self) -> bool:
        """Whether there is compiled code that carries states along their motion."""
        code = self._compiled
        return not self.n_unknowns and code is not None and code.carries_motion

    def carried(
        self,
        states: Vector,
        value: float,
        durations: Vector,
        *,
        scales: Vector,
        tolerance: float,
        trials: int,
    ) -> CarriedMotions | None:
        """Return where motions from some states lead, see :meth:`PointCode.carried`.

        None where the equations have unknowns, there is no compiled code, or steps become many.
        """
        code = self._compiled
        if code is None or not self.is_carried:
            return None
        return code.carried(
            states,
            self.parameters(value),
            durations,
            scales=scales,
            tolerance=tolerance,
            trials=trials,
        )

    def followed(
        self,
        state: Vector,
        value: float,
        durations: Vector,
        *,
        scales: Vector,
        tolerance: float,
        trials: int,
    ) -> StepTrace | None:
        """Return the path of the motion from a state, see :meth:`PathCode.followed`.

        For fields that are carried; None where steps become many.
        """
        return self._path.followed(
            state,
            self.parameters(value),
            durations,
            scales=scales,
            tolerance=tolerance,
            trials=trials,
        )

    def tangents(self, path: StepTrace, value: float, *, scales: Vector) -> PathTangents:
        """Return what finds the tangents along a path, for fields that are carried."""

        def followed(state: Vector, durations: Vector, error: float) -> StepTrace | None:
            return self.followed(
                state, value, durations, scales=scales, tolerance=error, trials=_MOST_WITHIN
            )

        code = self._compiled
        assert code is not None
        values = self.parameters(value)
        return PathTangents(code, path, values, scales=scales, followed=followed)

    def total(
        self, time: float, state: Vector, unknowns: Vector, parameters: Vector
    ) -> TotalDerivatives:
        """Return derivatives of kept rates and unknowns by kept states; no others matter.

        For searches of equilibria, which ask for them often; ``time`` does not matter either.
        """
        n, m = len(self.equations.states), self.n_unknowns
        found = self._field(state[None, self.kept], unknowns[None], parameters)
        rates, follow = np.zeros((n, n)), np.zeros((m, n))
        rates[np.ix_(self.kept, self.kept)] = found.by_state[0]
        follow[:, self.kept] = -found.follow[0]
        none = np.zeros((0, n))
        return TotalDerivatives(rates, follow, none, rates[:, :0], follow[:, :0], none[:, :0])

    def _field(self, states: Vector, unknowns: Vector, parameters: Vector) -> Field:
        n, m, count = self.size, self.n_unknowns, len(states)
        values, by = self._values_and_slopes(states, unknowns, parameters)
        if not (np.isfinite(values).all() and np.isfinite(by).all()):
            raise NumericalError("the rates or their derivatives are no finite numbers")
        if not m:
            empty = np.zeros((count, 0))
            return Field(values, by[:, :, :n], by[:, :, n], empty, np.zeros((count, 0, n)), empty)
        known = np.concatenate([values[:, n:, None], by[:, n:, :n], by[:, n:, n + m :]], axis=2)
        try:
            solved = np.linalg.solve(by[:, n:, n : n + m], known)
        except np.linalg.LinAlgError:
            raise NumericalError("the loops are singular at a point of the motion") from None
        own = np.concatenate([values[:, :n, None], by[:, :n, :n], by[:, :n, n + m :]], axis=2)
        total = own - by[:, :n, n : n + m] @ solved
        return Field(
            total[:, :, 0],
            total[:, :, 1 : n + 1],
            total[:, :, n + 1],
            solved[:, :, 0],
            solved[:, :, 1 : n + 1],
            solved[:, :, n + 1],
        )

    def _values_and_slopes(
        self, states: Vector, unknowns: Vector, parameters: Vector
    ) -> tuple[Vector, Vector]:
        """Return f and g (n_points, n + m), and their derivatives (n_points, n + m, n + m + 1)."""
        n, m, count = self.size, self.n_unknowns, len(states)
        if self._compiled is not None:
            points = np.concatenate([states, unknowns], axis=1)
            return self._compiled.slopes(points, parameters)
        if count not in self._evaluations:
            mapped = self._slopes.map("field", "serial", count, [2], [])
            self._evaluations[count] = BufferedFunction(mapped)
        found, slopes = self._evaluations[count](states.ravel(), unknowns.ravel(), parameters)
        values = found.T if found.ndim == 2 else found.reshape(count, n + m)
        return values, slopes.reshape((n + m, n + m + 1, count), order="F").transpose(2, 0, 1)

    @cached_property
    def _compiled(self) -> PointCode | None:
        return self.compiled(self.whole, index=self.index)

    @cached_property
    def _path(self) -> PathCode:
        e = self.equations
        return PathCode(self.whole, e.state[self.kept], e.parameter, e.tables)

    def compiled(self, values: Any, *, index: int | None = None) -> PointCode | None:
        """Return machine code of a column of functions of the states kept, z and p.

        None where it would not pay, or there is no compiler. With ``index`` it differentiates,
        also by that parameter.
        """
        import casadi

        e = self.equations
        point = casadi.vertcat(e.state[self.kept], e.algebraic)
        if operations_in(casadi.Function("f", [point, e.parameter], [values])) < LEAST:
            return None
        try:
            return PointCode(values, point, e.parameter, e.tables, index=index, often=True)
        except CompilationError as error:
            _log.info("%s; limit cycles are computed interpreted", error)
            return None

    @cached_property
    def whole(self) -> Any:
        """The column of f and g as functions of the states kept, z and p."""
        import casadi

        e = self.equations
        state = [casadi.SX(s.start) for s in e.states]
        for k in self.kept:
            state[k] = e.state[k]
        whole = casadi.vertcat(e.rate[self.kept], e.residual)
        given = [e.time, e.state]
        fixed = [casadi.SX(0.0), casadi.vertcat(*state)]
        return casadi.densify(casadi.substitute([whole], given, fixed)[0])

    @cached_property
    def _slopes(self) -> Any:
        """The function (x, z, p) -> values of f and g, and their derivatives by x, z and p."""
        import casadi

        e, whole = self.equations, self.whole
        chosen = e.state[self.kept]
        by = ops.jacobian(whole, casadi.vertcat(chosen, e.algebraic, e.parameter[self.index]))
        results = casadi.cse([whole, casadi.densify(by)])
        return casadi.Function("slopes", [chosen, e.algebraic, e.parameter], results)
