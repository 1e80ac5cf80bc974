"""Notice that a search for an optimum circles: its objective stands still, but it does not end.

Laws with corners, as of friction that sticks and slips by turns, have points between which
Newton's method goes to and fro: what optimality asks for jumps there.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_ITERATIONS, _STILL = 30, 1e-6
"""Iterations in which the objective of a search that circles changes by less than this part."""


class StandstillError(Exception):
    """A search circles."""


@dataclass(frozen=True)
class Iterate:
    """Variables with their objective, violation of constraints, and gap to the least objective."""

    variables: Floats
    objective: float
    violation: float
    gap: float


@dataclass
class Standstill:
    """The iterates of a search, ``count`` of them, while its objective stands still.

    ``feasible`` is by how much they may miss constraints.
    """

    feasible: float
    best: Iterate | None = None
    count: int = 0
    _objectives: deque[float] = field(default_factory=lambda: deque(maxlen=_ITERATIONS))

    def look(self, iterate: Iterate) -> None:
        """Go on by an iterate.

        Raises
        ------
        StandstillError
            If the search circles about motions that keep the constraints; ``best`` is the one of
            these that keeps them best.
        """
        self.count += 1
        self._objectives.append(iterate.objective)
        low, high = min(self._objectives), max(self._objectives)
        if not high - low <= _STILL * abs(iterate.objective):
            self.best = None
            self._objectives = deque([iterate.objective], maxlen=_ITERATIONS)
        if iterate.violation <= self.feasible and (
            self.best is None or iterate.violation < self.best.violation
        ):
            self.best = iterate
        if len(self._objectives) == _ITERATIONS and self.best is not None:
            raise StandstillError
