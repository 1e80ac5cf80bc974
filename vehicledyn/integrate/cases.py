"""Many cases of one model: what is given of them, what is wanted and how each ended."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.integrate.estimated_accuracy import Accuracy
from vehicledyn.kernel.engine import Vector

Samples: TypeAlias = NDArray[Any]
"""Values of the chosen channels, float64 or float32, shape (n_cases, n_samples, n_channels)."""


@dataclass(frozen=True)
class Cases:
    """Parameters in SI and starting points, one row a case.

    ``parameters`` (n, n_parameters), ``states`` (n, n_states) and ``unknowns``
    (n, n_unknowns), a guess that is close, in the order of the model's equations.
    """

    parameters: Vector
    states: Vector
    unknowns: Vector

    def __len__(self) -> int:
        """Return the number of cases."""
        return len(self.parameters)

    def part(self, chosen: slice) -> Cases:
        """Return some of the cases."""
        return Cases(self.parameters[chosen], self.states[chosen], self.unknowns[chosen])


@dataclass(frozen=True)
class CaseEnd:
    """How a case ended: ``message`` is empty if it went to its end, else names time and place.

    ``samples`` is the number of good samples, ``time`` that of the last of them [s].
    ``ended_by`` is the name of the terminal event that ended it early; that is no failure.
    ``accuracy`` is what the watch of a fixed step found, where it could look.
    """

    time: float
    samples: int
    message: str = ""
    ended_by: str = ""
    accuracy: Accuracy | None = None

    @property
    def failed(self) -> bool:
        """Whether the case could not go on."""
        return bool(self.message)


@dataclass(frozen=True)
class SamplingPlan:
    """When to take samples, and of which channels."""

    start: float
    interval: float
    n_samples: int
    channels: list[int]

    @cached_property
    def times(self) -> Vector:
        """Times of the samples [s], without rounding that adds up."""
        return np.array([self.start + self.interval * k for k in range(self.n_samples)])
