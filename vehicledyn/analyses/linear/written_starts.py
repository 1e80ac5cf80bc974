"""Start values that follow from parameters, as written or since loops are assembled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.errors import InputError
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.multibody.loops.assembled_start import DrawnStarts
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations

Floats = NDArray[np.float64]
Evaluated: TypeAlias = Callable[..., Floats]


_STILL = 1e-9
"""Motion of a start along a direction that is rounding [m, rad]."""


class WrittenStarts:
    """The start values of a model at a speed [m/s] that follow from parameters.

    With ``assembles`` those of independent coordinates too that are moved so that loops close, as
    a start that no equilibrium takes over.

    Attributes
    ----------
    states
        Numbers of the states that they are of.
    """

    def __init__(self, prepared: Prepared, speed: float, *, assembles: bool = False) -> None:
        self._equations, self._subject, self._speed = prepared.equations, prepared.subject, speed
        names = [p.name for p in self._equations.parameters]
        known = [p for p in self._subject.system.table.entries if p.name in names]
        self._parameters = [names.index(p.name) for p in known]
        self._symbols = ops.column([p.symbol for p in known])
        written, places = self._subject.system.starts, dict[str, int]()
        for k, state in enumerate(self._equations.states):
            places[state.name] = k
        system = self._subject.system
        self._drawn = DrawnStarts.of(system, self._equations) if assembles else None
        drawn = self._drawn.places if self._drawn else {}
        own = [name for name in written if name in places and name not in drawn]
        self._n_written = len(own)
        self.states = [places[name] for name in (*own, *drawn)]
        # Of dependent coordinates only rates are given: positions follow from the loops.
        self._others = [name for name in written if name not in places]
        self._starts = ops.column([written[name] for name in (*own, *self._others)])

    def applied(self, prepared: Prepared) -> Prepared:
        """Return the model, prepared with other parameters, with the start that they bring."""
        if not (self._subject.system.starts or self._drawn):
            return prepared
        parameters = prepared.kernel.parameters[self._parameters]
        values = self._values(parameters)[:, 0]
        own, others = values[: self._n_written], values[self._n_written :]
        given = zip(self._others, map(float, others), strict=True)
        system = self._subject.system.with_starts(dict(given))
        subject = self._subject.with_system(system)
        if self._drawn:
            own = np.append(own, [*self._drawn.at(parameters).values()])
        return replace(prepared, equations=self._started(own), subject=subject)

    def slopes(self, parameters: Floats) -> Floats:
        """Return the derivatives of the start, shape (n_states, n_parameters).

        Raises
        ------
        NumericalError
            If loops do not close beside these parameters.
        """
        return self._taken(False)[:, None] * self._all_slopes(parameters)

    def still(self, parameters: Floats) -> Floats:
        """Return those of the start at rest, shape the same."""
        return self._taken(True)[:, None] * self._all_slopes(parameters)

    def bent(self, parameters: Floats, direction: Floats, *, is_still: bool = False) -> Floats:
        """Return how the one or the other change along a direction of the parameters.

        Raises
        ------
        InputError
            If they are drawn by loops.
        """
        moved = self._all_slopes(parameters)[self.states[self._n_written :]] @ direction
        if np.any(np.abs(moved) > _STILL):
            names = ", ".join(f"'{self._equations.states[k].name}'" for k in self.states)
            raise InputError(
                f"along: the start of {names} moves with the loops, which has no second "
                "derivatives; 'role: independent' keeps a start"
            )
        return self._taken(is_still)[:, None] * self._placed(self._bends, parameters, direction)

    def given_rates(self) -> list[str]:
        """Return the dependent coordinates whose rates are given."""
        e = self._equations
        rates = {e.states[k].name for k in e.velocities}
        followed = {c.name for c in e.channels} - rates
        return [name for name in self._subject.given_rates if f"{name}_rate" in followed]

    def with_given_rates(
        self, prepared: Prepared, point: AssembledPoint, by_parameter: Floats, slopes: Floats
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
        own = self._slopes(parameters[self._parameters])[self._n_written :]
        for place, name in enumerate(names):
            if name in self._others:
                row = own[self._others.index(name)]
                moved[place] += row @ by_parameter[self._parameters]
        held[free] = np.linalg.lstsq(total.outputs[np.ix_(rows, free)], moved, rcond=1e-10)[0]
        return held

    def _all_slopes(self, parameters: Floats) -> Floats:
        """Return derivatives of the states that follow, (n_states, n_parameters), else zero."""
        found = self._placed(self._slopes, parameters)
        if self._drawn:
            rows = self.states[self._n_written :]
            found[np.ix_(rows, self._parameters)] = self._drawn.slopes(parameters[self._parameters])
        return found

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
        own = function(*(item[self._parameters] for item in at))[: self._n_written]
        found[np.ix_(self.states[: self._n_written], self._parameters)] = own
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
