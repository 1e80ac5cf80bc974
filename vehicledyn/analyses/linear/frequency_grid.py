"""Frequencies of a response: a range, a number of points, and how they are spaced."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import InputError

MOST_POINTS = 100_000


@dataclass(frozen=True)
class FrequencyGrid:
    """Frequencies from ``first`` to ``last`` [Hz], evenly on a "log" or "linear" scale.

    Raises
    ------
    InputError
        If the range is empty or reaches zero, or there are too few or too many points.
    """

    first: float
    last: float
    points: int
    spacing: Literal["log", "linear"] = "log"

    def __post_init__(self) -> None:
        """Check the range."""
        if not 0.0 < self.first < self.last < float("inf"):
            raise InputError(
                f"{given('first', self.first)} {given('last', self.last)}: give a range of "
                "frequencies "
                "above zero, the lower one first"
            )
        if not 2 <= self.points <= MOST_POINTS:
            raise InputError(f"{given('points', self.points)}: give from 2 to {MOST_POINTS} points")

    def frequencies(self) -> Any:
        """Return the frequencies, shape (points,) [Hz]."""
        space = np.geomspace if self.spacing == "log" else np.linspace
        return space(self.first, self.last, self.points)
