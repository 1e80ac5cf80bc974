"""How tangents pass events, whose instants move and which may give states new values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector
from vehicledyn.symbolic.equations import Equations

Matrix = NDArray[np.float64]

_GRAZING = 1e-6
"""Rate of an event function at its zero, as a part of its mean rate in the step before it."""


class EventTangents:
    """Tangents at an instant at which events happen.

    Parameters
    ----------
    equations
        The model.
    names
        The events.
    slopes
        Tangents of functions and new values of all events (n, n_directions); the last direction
        is time.
    time
        The instant [s].

    Raises
    ------
    NumericalError
        If several happen at once and their order matters.
    """

    def __init__(
        self, equations: Equations, names: Sequence[str], slopes: Matrix, time: float
    ) -> None:
        known = [event.name for event in equations.events]
        events = [equations.events[known.index(name)] for name in names]
        if len(events) > 1 and any(event.resets for event in events):
            both = " and ".join(f"'{name}'" for name in names)
            raise NumericalError(
                f"the events {both} happen at once at t = {time:.9g} s: which comes first "
                "decides how the motion goes on, so no derivative exists behind them"
            )
        self.place, self._event = known.index(names[0]), events[0]
        self._slopes, self._time, self._n_events = slopes, time, len(known)

    def moment(self, earlier: float, seconds: float) -> Vector:
        """Return how the instant moves (n_directions,) [s].

        Parameters
        ----------
        earlier, seconds
            The value of the first event's function some time ago, and that time [s].

        Raises
        ------
        NumericalError
            If the motion only grazes the event.
        """
        by_event = self._slopes[self.place]
        rate = by_event[-1]
        if not abs(rate) * seconds > _GRAZING * abs(earlier):
            raise NumericalError(
                f"event '{self._event.name}' only grazes its limit at t = {self._time:.9g} s: a "
                "smaller motion would miss it, so no derivative exists behind it; change the "
                "parameters or end the run before"
            )
        return np.append(-by_event[:-1] / rate, 0.0)

    def behind(self, tangents: Matrix, moment: Vector) -> Matrix:
        """Return the tangents of the states behind the instant, from those before it."""
        found = tangents + np.outer(tangents[:, -1], moment)
        found[:, -1] = 0.0
        total = self._slopes + np.outer(self._slopes[:, -1], moment)
        for index, row in self._event.resets:
            found[index] = total[self._n_events + row]
            found[index, -1] = 0.0
        return found
