"""Drives: parts that prescribe a coordinate in time (book, chapter 4.2.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.multibody.model.parts import BasePart, Clock, DrivenMotion, Loads, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class TimeLaw(BasePart):
    """Prescribe a coordinate as a function of time, q(t); rates follow by differentiation.

    ``law`` takes the time [s] and returns the coordinate [m or rad]. Where the law has a
    corner, the acceleration there is the one of either side, without an impulse: give laws
    with continuous rate wherever inertia hangs on the coordinate; runs of systems say where
    there are corners.
    """

    coordinate: str
    law: Callable[[Scalar], Scalar]

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return q(t) and its rate."""
        position, velocity, _ = self._law(clock.time)
        return {self.coordinate: DrivenMotion(position, velocity)}

    def loads(self, situation: Situation) -> Loads:
        """Return the acceleration of the coordinate."""
        return Loads(accelerations={self.coordinate: self._law(situation.time)[2]})

    def _law(self, time: Scalar) -> tuple[Scalar, Scalar, Scalar]:
        position = ops.scalar(self.law(time))
        velocity = ops.derivative(position, time, 1.0)
        return position, velocity, ops.derivative(velocity, time, 1.0)


@dataclass(frozen=True)
class ConstantRate(BasePart):
    """Prescribe a coordinate that grows at a constant rate [m/s or rad/s] from zero."""

    coordinate: str
    rate: Scalar

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return rate · t and the rate."""
        return {self.coordinate: DrivenMotion(self.rate * clock.time, self.rate)}
