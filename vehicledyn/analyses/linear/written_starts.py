"""Start values that a system writes as expressions of its parameters, with derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepare import Point
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations

Floats = NDArray[np.float64]
Evaluated: TypeAlias = Callable[..., Floats]


class WrittenStarts:
    """The start values of a model at a speed [m/s] that follow from parameters.

    Attributes
    ----------
    states
        Numbers of the states that they are of.
    """

    def __init__(self, prepared: Prepared, speed: float) -> None:
        self._equations, self._subject, self._speed = prepared.equations, prepared.subject, speed
        names = [p.name for p in self._equations.parameters]
        known = [p for p in self._subject.system.table.entries if p.name in names]
        self._parameters = [names.index(p.name) for p in known]
        self._symbols = ops.column([p.symbol for p in known])
        written, places = self._subject.system.starts, dict[str, int]()
        for k, state in enumerate(self._equations.states):
            places[state.name] = k
        own = [name for name in written if name in places]
        self.states = [places[name] for name in own]
        # Of dependent coordinates only rates are given: positions follow from the loops.
        self._others = [name for name in written if name not in places]
        self._starts = ops.column([written[name] for name in (*own, *self._others)])

    def applied(self, prepared: Prepared) -> Prepared:
        """Return the model, prepared with other parameters, with the start that they bring."""
        if not self._subject.system.starts:
            return prepared
        values = self._values(prepared.kernel.parameters[self._parameters])[:, 0]
        given = zip(self._others, map(float, values[len(self.states) :]), strict=True)
        system = self._subject.system.with_starts(dict(given))
        subject = self._subject.with_system(system)
        return replace(prepared, equations=self._started(values), subject=subject)

    def slopes(self, parameters: Floats) -> Floats:
        """Return the derivatives of the start, shape (n_states, n_parameters)."""
        return self._taken(False)[:, None] * self._placed(self._slopes, parameters)

    def still(self, parameters: Floats) -> Floats:
        """Return those of the start at rest, shape the same."""
        return self._taken(True)[:, None] * self._placed(self._slopes, parameters)

    def bent(self, parameters: Floats, direction: Floats, *, is_still: bool = False) -> Floats:
        """Return how the one or the other change along a direction of the parameters."""
        return self._taken(is_still)[:, None] * self._placed(self._bends, parameters, direction)

    def given_rates(self) -> list[str]:
        """Return the dependent coordinates whose rates are given."""
        e = self._equations
        rates = {e.states[k].name for k in e.velocities}
        followed = {c.name for c in e.channels} - rates
        return [name for name in self._subject.given_rates if f"{name}_rate" in followed]

    def with_given_rates(
        self, prepared: Prepared, point: Point, by_parameter: Floats, slopes: Floats
    ) -> Floats:
        """Return derivatives of the start where rates of dependent coordinates are given.

        Those rates stay, or follow what they are written as, so that independent ones follow.

        Parameters
        ----------
        prepared
            The model.
        point
            Its start.
        by_parameter, slopes
            Derivatives of the parameters, and of the start as if no such rate were given.
        """
        e, given = self._equations, prepared.subject.given_rates
        rates = {e.states[k].name: k for k in e.velocities}
        channels = {c.name: k for k, c in enumerate(e.channels)}
        names = [f"{name}_rate" for name in self.given_rates()]
        free = [k for name, k in rates.items() if name.removesuffix("_rate") not in given]
        if not names or not free:
            return slopes
        held, parameters = slopes.copy(), prepared.kernel.parameters
        held[free] = 0.0
        at = prepared.subject.balance_time, point.state, point.unknowns, parameters
        total = Derivatives(e, [p.name for p in e.parameters]).total(*at)
        rows = [channels[name] for name in names]
        moved = -total.outputs[rows] @ held - total.outputs_by_parameter[rows] @ by_parameter
        own = self._slopes(parameters[self._parameters])[len(self.states) :]
        for place, name in enumerate(names):
            if name in self._others:
                row = own[self._others.index(name)]
                moved[place] += row @ by_parameter[self._parameters]
        held[free] = np.linalg.lstsq(total.outputs[np.ix_(rows, free)], moved, rcond=1e-10)[0]
        return held

    @cached_property
    def _values(self) -> Evaluated:
        return ops.numeric([self._symbols], self._starts)

    @cached_property
    def _slopes(self) -> Evaluated:
        return ops.numeric([self._symbols], ops.jacobian(self._starts, self._symbols))

    @cached_property
    def _bends(self) -> Evaluated:
        direction = ops.symbols("direction", len(self._parameters))
        along = ops.jacobian(self._starts, self._symbols) @ direction
        return ops.numeric([self._symbols, direction], ops.jacobian(along, self._symbols))

    def _started(self, values: Sequence[float] | Floats) -> Equations:
        """Return the equations with values of these starts."""
        states = list(self._equations.states)
        for k, value in zip(self.states, map(float, values), strict=False):
            states[k] = replace(states[k], start=value)
        return replace(self._equations, states=tuple(states))

    def _placed(self, function: Evaluated, *at: Floats) -> Floats:
        """Return derivatives of the states that are written, zero for all others."""
        found = np.zeros((len(self._equations.states), len(at[0])))
        own = function(*(item[self._parameters] for item in at))[: len(self.states)]
        found[np.ix_(self.states, self._parameters)] = own
        return found

    def _taken(self, is_still: bool) -> Floats:
        """Return the part of each start that a run takes; the speed or the road gives others."""
        subject, values = self._subject, [self._equations.states[k].start for k in self.states]
        ends = []
        for item in (self._started([value + 1.0 for value in values]), self._equations):
            state = (
                subject.still_state(item) if is_still else subject.start_state(item, self._speed)
            )
            ends.append(state)
        return np.asarray(ends[0] - ends[1], dtype=float)
