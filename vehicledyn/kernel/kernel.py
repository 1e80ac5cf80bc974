"""The kernel: a model's equations ready to run, whatever engine evaluates them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.kernel.engine import (
    Count,
    Figure,
    KernelEngine,
    Ledger,
    March,
    SampleRows,
    Span,
    Status,
    Vector,
)
from vehicledyn.kernel.failure_messages import describe_failure
from vehicledyn.symbolic.equations import Equations


@dataclass(frozen=True)
class KernelReport:
    """How a kernel came about.

    ``operations`` counts those of prepare, rates, outputs and blocks; the times of deriving
    and printing and of compiling are zero where the entry was in the cache; ``remark`` is one
    line for the user, empty if all went as usual.
    """

    operations: dict[str, int]
    generation_seconds: float = 0.0
    compilation_seconds: float = 0.0
    cached: bool = False
    remark: str = ""


@dataclass(eq=False)
class Kernel:
    """Rates, outputs, blocks and fixed-step runs of one model with one set of parameters.

    ``key`` is the name of its machine code in the cache, empty where it is interpreted. ``made``
    keeps what methods make of the equations, for all kernels with other parameter values.
    """

    equations: Equations
    backend: str
    description: str
    report: KernelReport
    engine: KernelEngine
    key: str = ""
    made: dict[Any, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Start with the equations' own parameter values."""
        self.set_parameters([parameter.value for parameter in self.equations.parameters])

    @property
    def parameters(self) -> Vector:
        """Values of the parameters in SI, shape (n_parameters,); a copy."""
        return self._parameters.copy()

    @property
    def constants(self) -> Vector:
        """What the engine made of the parameters; not to be changed."""
        return self._constants

    def set_parameters(self, values: Any) -> None:
        """Use these parameter values, shape (n_parameters,), from now on.

        Raises
        ------
        InputError
            If there are too few, too many or some that are no finite numbers.
        """
        array = np.array(values, dtype=float).ravel()
        expected = len(self.equations.parameters)
        if array.size != expected:
            raise InputError(
                f"model '{self.equations.name}' has {expected} parameters, {array.size} were given"
            )
        if not np.isfinite(array).all():
            name = self.equations.parameters[int(np.flatnonzero(~np.isfinite(array))[0])].name
            raise InputError(f"parameter '{name}' is not a finite number")
        self._parameters = array
        self._constants = self.engine.prepare(array)

    def with_parameters(self, values: Any) -> Kernel:
        """Return a kernel of the same code with other parameter values."""
        other = replace(self)
        other.set_parameters(values)
        return other

    def rates(self, time: float, state: Any, unknowns: Any) -> Vector:
        """Return the rates of the states, shape (n_states,), in units of the states per s."""
        x, z = self._checked(state, unknowns)
        return self.engine.rates(time, x, z, self._constants)

    def outputs(self, time: float, state: Any, unknowns: Any) -> Vector:
        """Return the values of the channels, shape (n_channels,)."""
        x, z = self._checked(state, unknowns)
        return self.engine.outputs(time, x, z, self._constants)

    def block(self, index: int, time: float, state: Any, unknowns: Any) -> tuple[Vector, Vector]:
        """Return residual (n,) and Jacobian (n, n) of a block."""
        x, z = self._checked(state, unknowns)
        return self.engine.block(index, time, x, z, self._constants)

    def residuals(self, time: float, state: Any, unknowns: Any) -> Vector:
        """Return the residuals of all blocks, shape (n_unknowns,)."""
        parts = [self.block(k, time, state, unknowns)[0] for k in range(len(self.equations.blocks))]
        return np.concatenate(parts) if parts else np.zeros(0)

    def solve_unknowns(self, time: float, state: Any, guess: Any) -> Vector:
        """Return the unknowns that solve the blocks, shape (n_unknowns,).

        Newton's method from a guess that is already close; see
        :func:`vehicledyn.analyse.equilibrium.assemble` for one that is not.

        Raises
        ------
        NumericalError
            If a block is not solved; names it with its residual and the time.
        """
        return self.count_solve(time, state, guess, Ledger())

    def count_solve(self, time: float, state: Any, guess: Any, ledger: Ledger) -> Vector:
        """Do the same as :meth:`solve_unknowns`, keeping account in a ledger."""
        x, z = self._checked(state, guess)
        z = z.copy()
        status = self.engine.solve(time, x, z, self._constants, ledger)
        if status is not Status.SOLVED:
            raise NumericalError(self.failure(status, time, ledger))
        self.check_residuals(time, x, z, ledger)
        return z

    def check_residuals(self, time: float, state: Any, unknowns: Any, ledger: Ledger) -> None:
        """Keep the largest residual in a ledger; raise NumericalError above a tolerance."""
        residuals = self._survey(time, state, unknowns)[0]
        for k, (block, residual) in enumerate(zip(self.equations.blocks, residuals, strict=True)):
            largest = ledger.figures[Figure.LARGEST_RESIDUAL]
            ledger.figures[Figure.LARGEST_RESIDUAL] = max(largest, residual)
            if not residual <= block.tolerance:
                ledger.counts[Count.WHERE] = k
                ledger.figures[Figure.FAILED_RESIDUAL] = residual
                raise NumericalError(self.failure(Status.INACCURATE, time, ledger))

    def pivots(self, times: Any, states: Any, unknowns: Any) -> Vector:
        """Return the determinant of each block at some points, shape (n_times, n_blocks).

        Times have the shape (n_times,), states and unknowns (n_times, ...).
        """
        t, x, z = (np.ascontiguousarray(item, dtype=float) for item in (times, states, unknowns))
        return self.engine.survey(t, x, z, self._constants)[1]

    def _survey(self, time: float, state: Any, unknowns: Any) -> tuple[list[float], Vector]:
        x, z = self._checked(state, unknowns)
        found = self.engine.survey(np.array([time]), x[None], z[None], self._constants)
        return found[0][0].tolist(), found[1][0]

    def evaluate(self, time: float, state: Vector, unknowns: Vector, ledger: Ledger) -> Vector:
        """Solve the unknowns in place and return the rates; arrays must be contiguous.

        Raises
        ------
        NumericalError
            If a block is not solved.
        """
        status = self.engine.solve(time, state, unknowns, self._constants, ledger)
        if status is not Status.SOLVED:
            raise NumericalError(self.failure(status, time, ledger))
        ledger.counts[Count.EVALUATIONS] += 1
        return self.engine.rates(time, state, unknowns, self._constants)

    def advance(self, march: March, n_steps: int, rows: SampleRows) -> Status:
        """Take steps of a run and write its samples into the rows.

        It ends with Status.EVENT before a step in which an event fires.

        ``march`` moves on by the good steps; its counts are those of this call. Rows must
        have room for ``n_steps // march.per_interval + 1`` samples.
        """
        march.ledger.counts[:] = 0
        status = self.engine.advance(march, n_steps, self._constants, rows)
        march.step += int(march.ledger.counts[Count.STEPS])
        return status

    def advance_part(self, march: March, part: Span) -> Status:
        """Take a part of the step, see :class:`vehicledyn.kernel.engine.KernelEngine`."""
        return self.engine.advance_part(march, part, self._constants)

    def event_values(self, time: float, state: Any, unknowns: Any) -> Vector:
        """Return the functions whose sign changes mark the events, shape (n_events,)."""
        x, z = self._checked(state, unknowns)
        return self.engine.events(time, x, z, self._constants)

    def reset_values(self, time: float, state: Any, unknowns: Any) -> Vector:
        """Return the new values that events give to states, shape (n_resets,)."""
        x, z = self._checked(state, unknowns)
        return self.engine.resets(time, x, z, self._constants)

    def failure(self, status: Status, time: float, ledger: Ledger) -> str:
        """Return the message for a computation that did not end well near a time [s]."""
        return describe_failure(self.equations, status, time, ledger)

    def checked_state(self, state: Any) -> Vector:
        """Return a copy of a state vector.

        Raises
        ------
        InputError
            If it has not the right length or holds a value that is not finite.
        """
        x = np.array(state, dtype=float)
        if x.shape != (len(self.equations.states),):
            raise InputError(
                f"model '{self.equations.name}' has {len(self.equations.states)} states, "
                f"{x.size} were given"
            )
        if not np.isfinite(x).all():
            name = self.equations.states[int(np.flatnonzero(~np.isfinite(x))[0])].name
            raise InputError(f"the starting value of state '{name}' is not a finite number")
        return x

    def _checked(self, state: Any, unknowns: Any) -> tuple[Vector, Vector]:
        x = np.ascontiguousarray(state, dtype=float)
        z = np.ascontiguousarray(unknowns, dtype=float)
        if x.shape != (len(self.equations.states),) or z.shape != (len(self.equations.unknowns),):
            raise InputError(
                f"model '{self.equations.name}' has {len(self.equations.states)} states and "
                f"{len(self.equations.unknowns)} unknowns, not {x.size} and {z.size}"
            )
        return x, z
