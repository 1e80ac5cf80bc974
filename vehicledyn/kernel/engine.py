"""What a kernel needs of the machine that runs its functions, compiled or interpreted."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import IntEnum
from operator import is_
from typing import Any, NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

Vector: TypeAlias = NDArray[np.float64]

Sides: TypeAlias = NDArray[np.intc]


Span: TypeAlias = tuple[float, float]
"""Begin and end of a part of something whole, between 0 and 1."""


class Status(IntEnum):
    """How a computation ended; the numbers are those of steps.c and passes.c."""

    SOLVED = 0
    NOT_CONVERGED = 1
    SINGULAR = 2
    NOT_FINITE = 3
    INACCURATE = 4
    EVENT = 5
    WEAK = 6
    CORNER = 7


class Method(IntEnum):
    """Fixed-step methods; the numbers are those of loop.c, ``CHEBYSHEV`` plus its stages.

    ``IMPLICIT`` plus their order are Newmark's methods, whose steps are taken outside of the
    kernel; ``CONSTRAINED`` those of them that step on residuals with multipliers.
    """

    RK4 = 0
    SYMPLECTIC_EULER = 1
    CHEBYSHEV = 100
    IMPLICIT = 1000
    CONSTRAINED = 2000


WEAK_PIVOT = 0.3
"""Determinant of a block, as a part of the largest met in a run, below which it is weak."""


class Count(IntEnum):
    """Places in the array of counts that engines fill; the numbers are those of loop.c."""

    SAMPLES = 0
    STEPS = 1
    EVALUATIONS = 2
    ITERATIONS = 3
    WHERE = 4


class Figure(IntEnum):
    """Places in the array of figures that engines fill; the numbers are those of loop.c."""

    LARGEST_RESIDUAL = 0
    FAILED_RESIDUAL = 1


@dataclass
class Ledger:
    """Counts and figures of a computation, filled by an engine."""

    counts: NDArray[np.int64] = field(default_factory=lambda: np.zeros(len(Count), dtype=np.int64))
    figures: Vector = field(default_factory=lambda: np.zeros(len(Figure)))


class Addresses(NamedTuple):
    """Arrays that an engine was given, and where they lie in memory."""

    arrays: tuple[NDArray[Any], ...]
    numbers: list[int]

    @classmethod
    def of(cls, arrays: tuple[NDArray[Any], ...], known: Addresses | None) -> Addresses:
        """Return the addresses of arrays, the known ones if these are the same arrays."""
        if known is not None and all(map(is_, arrays, known.arrays)):
            return known
        return cls(arrays, [array.ctypes.data for array in arrays])


@dataclass
class March:
    """A run with fixed steps, changed in place as it advances.

    ``method`` is a :class:`Method`, plus the number of stages for ``CHEBYSHEV``.

    ``state`` (n_states,) and ``unknowns`` (n_unknowns,) are consistent and belong to step
    number ``step``, at ``start + interval * step / per_interval``; ``memory`` holds what the
    guesses of the unknowns extrapolate from, so that a run cut into chunks gives the same
    numbers as a run in one piece. ``sides`` (n_events,) are the signs of the functions of the
    events there, see :class:`vehicledyn.integrate.events.EventMonitor`. ``addresses`` are those of
    the last call of an engine, as asking for them takes as long as some steps.
    """

    method: int
    start: float
    interval: float
    per_interval: int
    state: Vector
    unknowns: Vector
    step: int = 0
    memory: Vector = field(default_factory=lambda: np.zeros(0))
    ledger: Ledger = field(default_factory=Ledger)
    sides: Sides = field(default_factory=lambda: np.zeros(0, dtype=np.intc))
    addresses: Addresses | None = field(init=False, default=None, repr=False)

    def __post_init__(self) -> None:
        """Own the arrays that change."""
        self.state = np.array(self.state, dtype=float)
        self.unknowns = np.array(self.unknowns, dtype=float)
        self.memory = np.zeros(1 + 2 * self.unknowns.size)

    def time(self, step: int, part: float = 0.0) -> float:
        """Return the time of a step and a part of the next one [s]."""
        whole, rest = divmod(step, self.per_interval)
        return self.start + self.interval * (whole + (rest + part) / self.per_interval)


@dataclass(frozen=True)
class SampleRows:
    """Room for samples: states, unknowns and outputs, one row a sample."""

    states: Vector
    unknowns: Vector
    outputs: Vector


class KernelEngine(Protocol):
    """Runs the functions of one kernel; ``constants`` come from :meth:`prepare`."""

    def prepare(self, parameters: Vector) -> Vector:
        """Return what depends on the parameters alone."""

    def rates(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the rates of the states."""

    def outputs(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the named outputs."""

    def block(
        self, index: int, time: float, state: Vector, unknowns: Vector, constants: Vector
    ) -> tuple[Vector, Vector]:
        """Return residual and Jacobian of a block."""

    def survey(
        self, times: Vector, states: Vector, unknowns: Vector, constants: Vector
    ) -> tuple[Vector, Vector]:
        """Return largest residual and determinant of each block at some points.

        Times (n,), states and unknowns (n, ...) must be contiguous; both results have the shape
        (n, n_blocks).
        """

    def solve(
        self, time: float, state: Vector, unknowns: Vector, constants: Vector, ledger: Ledger
    ) -> Status:
        """Solve the blocks in order, changing the unknowns in place."""

    def advance(self, march: March, n_steps: int, constants: Vector, rows: SampleRows) -> Status:
        """Take steps and write a row for each whole interval; the counts are those of this call.

        A step in which an event fires is not taken: it ends the call with Status.EVENT.
        """

    def advance_part(self, march: March, part: Span, constants: Vector) -> Status:
        """Take a part of one step, moving state and unknowns but neither step nor sides.

        The guesses of the unknowns are not extrapolated into the part, nor from it.
        """

    def events(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the functions of the events."""

    def resets(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the new values that events give to states."""
