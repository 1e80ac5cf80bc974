"""Cases that run side by side, from their start to their end."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from vehicledyn.kernel.engine import Count, Figure, Ledger, Status, Vector
from vehicledyn.kernel.lanes import Fate, LaneEngine

_log = logging.getLogger(__name__)


def takes_lanes(solver: Any) -> bool:
    """Return whether cases of a method run side by side: where steps have one size.

    Newmark's family does where the rates close the loops, with a tolerance too.
    """
    return hasattr(solver, "fixed_method") or getattr(solver, "constraints", "") == "reduced"


def suited_lanes(solver: Any, lanes: int | None) -> int | None:
    """Return how many lanes to make for a method: one where its cases run one after the other.

    A note says so where ``lanes`` asks for more; None leaves their number to the processor.
    """
    if takes_lanes(solver):
        return lanes
    if lanes is not None and lanes > 1:
        _log.warning(
            "'%s' with these settings has no lanes; cases run one after the other", solver.kind
        )
    return 1


@dataclass(frozen=True)
class Stopped:
    """Why a lane stopped, when [s], its number of good samples, and place and residual."""

    status: Status
    time: float
    samples: int
    ledger: Ledger


@dataclass
class LaneRun(ABC):
    """Cases that run side by side, changed in place as they advance.

    ``state`` and ``unknowns`` are in lanes; ``good`` counts the good steps of each lane. A lane
    stops where the determinant of a block falls below the part ``weak`` of the largest so far, or
    changes its sign; zero means that none is watched.
    """

    engine: LaneEngine
    start: float
    interval: float
    per_interval: int
    channels: NDArray[np.intc]
    constants: Vector
    state: Vector
    unknowns: Vector
    weak: float = 0.0
    step: int = 0

    def __post_init__(self) -> None:
        """Begin with nothing known."""
        self.watched = self.engine.room(self.engine.n_watched)
        self.fate = Fate.unknown(self.engine.lanes)
        self.good = np.zeros(self.engine.lanes, dtype=np.int64)
        self._begun = np.zeros(self.engine.lanes, dtype=bool)

    def begin(self, samples: Vector) -> bool:
        """Solve the unknowns at the start and write the first sample of each lane.

        ``samples`` has the shape (lanes, n_samples, n_channels); those that are not reached
        keep their values. Return whether any lane goes on.
        """
        arrays = [item.ctypes.data for item in (self.state, self.unknowns, self.constants)]
        room = self._room(samples)
        watched = self.watched.ctypes.data
        going = self.engine.begin(self.start, *arrays, *room, watched, *self.fate.pointers())
        self._begun = self.fate.status == Status.SOLVED
        return going

    @abstractmethod
    def advance(self, n_steps: int, samples: Vector) -> bool:
        """Take steps and write a sample of each lane after each whole interval.

        Return whether any lane goes on.
        """

    @abstractmethod
    def window(
        self, start: float, interval: float, per_interval: int, channels: NDArray[np.intc]
    ) -> Self:
        """Return a run that begins anew from the points that this one has reached."""

    def stopped(self, lane: int) -> Stopped | None:
        """Return why a lane stopped, None if it did not."""
        status, good = Status(self.fate.status[lane]), int(self.good[lane])
        if status is Status.SOLVED:
            return None
        missed = status is Status.INACCURATE or not self._begun[lane]
        whole, rest = divmod(good, self.per_interval)
        ledger = Ledger()
        ledger.counts[Count.WHERE] = self.fate.where[lane]
        ledger.figures[Figure.FAILED_RESIDUAL] = self.fate.residual[lane]
        moment = self.start + self.interval * (whole + rest / self.per_interval)
        return Stopped(status, moment, whole + (0 if missed else 1), ledger)

    def _room(self, samples: Vector) -> list[int]:
        stride = samples.shape[1] * samples.shape[2]
        return [len(self.channels), self.channels.ctypes.data, samples.ctypes.data, stride]


@dataclass
class FixedLaneRun(LaneRun):
    """Cases whose steps the kernel itself takes, by a method of this number."""

    method: int = 0

    def __post_init__(self) -> None:
        """Begin with nothing known of steps before."""
        super().__post_init__()
        self.memory = self.engine.room(1 + 2 * max(1, self.unknowns.shape[0]))

    def advance(self, n_steps: int, samples: Vector) -> bool:
        """Take steps and write samples, see :meth:`LaneRun.advance`."""
        arrays = (self.constants, self.state, self.unknowns, self.memory)
        going = self.engine.advance(
            int(self.method),
            self.step,
            n_steps,
            self.per_interval,
            self.start,
            self.interval,
            *[item.ctypes.data for item in arrays],
            *self._room(samples),
            self.weak,
            self.watched.ctypes.data,
            self.good.ctypes.data,
            *self.fate.pointers(),
        )
        self.step += n_steps
        return going

    def window(
        self, start: float, interval: float, per_interval: int, channels: NDArray[np.intc]
    ) -> FixedLaneRun:
        """Return a run that begins anew here, see :meth:`LaneRun.window`."""
        times = start, interval, per_interval
        points = self.engine.copied(self.state), self.engine.copied(self.unknowns)
        return FixedLaneRun(
            self.engine, *times, channels, self.constants, *points, method=self.method
        )
