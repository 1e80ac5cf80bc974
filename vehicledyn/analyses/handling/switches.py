"""Switches of a car in a steady turn: gears and the like, as events leave them.

A switch is a state without a rate that events reset. Newton's method cannot find it; the events
decide it, as those of a gearbox that select the gear of a speed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.tested_car import CarPoint, TestedCar
from vehicledyn.kernel.event_signs import fired
from vehicledyn.symbolic.equations import Equations, Event

Firing = tuple[Event, NDArray[np.float64]]

_FIRST, _PAUSE = -1e4, 100.0
"""First time at which events are looked at and time between two [s]; timers end long before 0."""


def switches_of(equations: Equations) -> frozenset[int]:
    """Return the indices of the states that never have a rate."""
    return frozenset(k for k in range(len(equations.states)) if equations.rate[k].is_zero())


class Switches:
    """Resets the switches of a car by the events that its motion has passed."""

    def __init__(self, car: TestedCar) -> None:
        self._car = car
        self.states = switches_of(car.equations)
        self._events = [
            event
            for event in car.equations.events
            if event.resets and all(k in self.states for k, _ in event.resets)
        ]

    def settled(self, point: CarPoint) -> CarPoint | None:
        """Return the point with its switches as events leave them, None if they stay.

        Each event fires once at most, so that a gearbox changes by one gear at a time; a timer
        that it starts has run out at time 0.
        """
        state, time, waiting = point.state.copy(), _FIRST, list(self._events)
        self._car.kernel.set_parameters(point.parameters)
        while waiting:
            firing = self._first(waiting, time, CarPoint(state, point.unknowns, point.parameters))
            if firing is None:
                break
            waiting.remove(firing[0])
            state, time = firing[1], time + _PAUSE
        if np.array_equal(state, point.state):
            return None
        return CarPoint(state, point.unknowns, point.parameters)

    def _first(self, events: list[Event], time: float, point: CarPoint) -> Firing | None:
        """Return the first event that has passed and changes a switch, and the state behind it."""
        kernel = self._car.kernel
        values = kernel.event_values(time, point.state, point.unknowns)
        resets = kernel.reset_values(time, point.state, point.unknowns)
        for event in events:
            here = values[event.index : event.index + 1]
            if not fired([event], -np.sign(here).astype(np.int32), here)[0]:
                continue
            state = point.state.copy()
            for index, row in event.resets:
                state[index] = resets[row]
            if not np.array_equal(state, point.state):
                return event, state
        return None
