"""How a point to linearise about follows the parameters: what balances it, and its given start."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.eigenvalues import LinearPoint
from vehicledyn.analyse.gradients.linear_system import Following, SystemDerivatives
from vehicledyn.analyses.linear.linear_inputs import THRUST
from vehicledyn.analyses.linear.written_starts import WrittenStarts
from vehicledyn.analyses.preparation.prepare import AssembledPoint, reference_start, start_point
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.errors import NumericalError
from vehicledyn.files.scenario.target import Target

Floats = NDArray[np.float64]

_BALANCED = 1e-5
"""Largest rate of a point that counts as balanced, in units of the states per s."""


class ReferenceMotion:
    """How the reference point of a model at a speed follows the parameters.

    Attributes
    ----------
    kind
        How it starts: "nominal", "static" or "steady".
    written
        Start values that follow from parameters.
    """

    def __init__(self, prepared: Prepared, speed: float, target: Target) -> None:
        """Prepare it for a speed [m/s]; the target names the start."""
        choices = target.choices
        subject = prepared.subject
        self._prepared, self._speed = prepared, speed
        self.kind = reference_start(subject, speed, choices.start if choices else None)
        self.written = WrittenStarts(prepared, speed, assembles=self.kind == "nominal")

    def at(self, point: AssembledPoint, parameters: Floats) -> tuple[LinearPoint, Following]:
        """Return the point, and how it follows all parameters.

        Raises
        ------
        NumericalError
            If the point is not balanced.
        """
        prepared, speed = self._prepared, self._speed
        subject, e = prepared.subject, prepared.equations
        balanced_at = 0.0 if self.kind == "static" else speed
        nominal = self.kind == "nominal"
        free, balanced = ([], []) if nominal else subject.balance_pairs(e, balanced_at)
        time, names = subject.balance_time, [p.name for p in e.parameters]
        pushes: tuple[int, ...] = ()
        if THRUST in names and speed > 0.0:
            pushes = (names.index(THRUST),)
            balanced = [*balanced, prepared.index(f"{subject.ports.body}.x_rate")]
        linear = LinearPoint(parameters, time, point.state, point.unknowns, (free, balanced))
        if self.kind == "static":
            still = self._still(point.state, free)
            if not np.array_equal(still, point.state):
                at_rest = LinearPoint(parameters, time, still, point.unknowns, (free, balanced))
                moving = LinearPoint(parameters, time, point.state, point.unknowns)
                return moving, self._set_moving(at_rest, point)
        rates = prepared.kernel.rates(time, point.state, point.unknowns)
        if balanced and np.max(np.abs(np.asarray(rates)[balanced])) > _BALANCED:
            raise NumericalError("the point to linearise about is no equilibrium")
        given = self.written.still(parameters) if self.kind == "static" else self._given(parameters)
        if nominal:
            given = self._with_given_rates(point, parameters, given)
        return linear, Following(pushes, given)

    @cached_property
    def is_given(self) -> bool:
        """Whether parameters move states that no balance finds."""
        subject, e = self._prepared.subject, self._prepared.equations
        at = 0.0 if self.kind == "static" else self._speed
        free = [] if self.kind == "nominal" else subject.balance_pairs(e, at)[0]
        return bool(set(self.written.states).difference(free) or self.written.given_rates())

    def started(self, parameters: Floats, speed: float) -> AssembledPoint:
        """Return the reference point with other parameters, at their speed [m/s]."""
        kernel = self._prepared.kernel.with_parameters(parameters)
        begun = self.written.applied(replace(self._prepared, kernel=kernel))
        return start_point(begun, speed, self.kind)

    def _given(self, parameters: Floats) -> Floats:
        """Return how the states of the start follow the parameters, the speed among them."""
        found = self.written.slopes(parameters)
        subject, e = self._prepared.subject, self._prepared.equations
        names = [p.name for p in e.parameters]
        if "speed" in names and "speed" in subject.parameters_at(self._speed or 1.0):
            here = self._speed or 1.0
            faster = subject.start_state(e, here + 1.0) - subject.start_state(e, here)
            found[:, names.index("speed")] += faster
        return found

    def _still(self, state: Floats, free: list[int]) -> Floats:
        """Return a state as it was balanced, before it was given its velocities."""
        e = self._prepared.equations
        others = [k for k in e.speeds if k not in free]
        found = state.copy()
        found[others] = self._prepared.subject.still_state(e)[others]
        return found

    def _set_moving(self, at_rest: LinearPoint, point: AssembledPoint) -> Following:
        """Return how a point moves that was balanced at rest and then given its velocities."""
        e, parameters = self._prepared.equations, at_rest.parameters
        balance = self._derivatives.at(at_rest, Following((), self.written.still(parameters)))
        found = balance.states.copy()
        others = [k for k in e.speeds if k not in at_rest.pairs[0]]
        found[others] = self._given(parameters)[others]
        found = self._with_given_rates(point, parameters, found)
        loose = np.zeros((len(balance.loose), len(point.state)))
        loose[:, list(at_rest.pairs[0])] = balance.loose
        return Following((), found, loose)

    def _with_given_rates(self, point: AssembledPoint, parameters: Floats, found: Floats) -> Floats:
        begun = self.written.applied(self._prepared)
        return self.written.with_given_rates(begun, point, np.eye(len(parameters)), found)

    @cached_property
    def _derivatives(self) -> SystemDerivatives:
        return SystemDerivatives(self._prepared.equations)
