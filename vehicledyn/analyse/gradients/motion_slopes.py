"""A motion with its derivatives, and the samples of one under way."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class EventSlope:
    """An event: its name, its instant [s], and that one's derivatives (n_directions,)."""

    name: str
    time: float
    slope: Vector


@dataclass(frozen=True)
class CornerPassed:
    """A corner of a law: when its step begins [s], and how far this ends beside the motion.

    ``missed`` is a part of the state's size; ``jumps`` says whether rates jump there.
    """

    time: float
    missed: float
    jumps: bool


@dataclass
class MotionSlopes:
    """A motion and its derivatives by n directions.

    ``times`` (n_times,), ``values`` (n_times, n_channels), ``slopes`` (n_times, n_channels,
    n_directions) of the chosen channels, ``state`` and ``state_slopes`` (n_states, n_directions)
    at the end, ``events`` in their order. Where an event ended the run, the last sample moves with
    it. ``changes`` are times at which other coordinates became dependent [s]; ``corners`` those of
    laws that are passed, ``left_whole`` whether there are so many that steps were not divided.
    """

    times: Vector
    values: Matrix
    slopes: Matrix
    state: Vector
    state_slopes: Matrix
    events: list[EventSlope]
    ended_by: str
    changes: list[float] = field(default_factory=list)
    corners: list[CornerPassed] = field(default_factory=list)
    left_whole: bool = False

    @property
    def end_slope(self) -> Vector:
        """How the time of the last sample moves, with the event that ends the run, if any [s]."""
        ends = [event.slope for event in self.events if event.name == self.ended_by]
        return ends[-1] if ends else np.zeros(self.slopes.shape[2])


@dataclass
class SlopeRecorder:
    """Keeps the samples of the first channels and directions."""

    n_channels: int
    n_directions: int
    times: list[Vector] = field(default_factory=list)
    values: list[Matrix] = field(default_factory=list)
    slopes: list[NDArray[np.float64]] = field(default_factory=list)
    looks: list[tuple[Vector, Matrix, Matrix]] = field(default_factory=list)
    """Times, states and unknowns of samples."""

    def take(self, times: Vector, values: Matrix, slopes: NDArray[np.float64]) -> None:
        """Keep samples: times (n,), values (n, ...) and slopes (n, ..., ...)."""
        self.times.append(times)
        self.values.append(values[:, : self.n_channels])
        self.slopes.append(slopes[:, : self.n_channels, : self.n_directions])
