"""A steering robot: the steering wheel follows a recorded angle, with lag and a largest rate."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.multibody.model.parts import (
    BasePart,
    Clock,
    DrivenMotion,
    Loads,
    Output,
    Situation,
    Wrench,
)
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class Robot(BasePart):
    """Two states, angle δ and rate of the steering wheel.

    δ̈ = 2 ζ ω (v - δ̇) with v = ω/(2 ζ) (δ_wanted - δ), no larger than the robot can turn.
    ``per_rack`` is the steering-wheel angle over the rack [rad/m].
    """

    rack: str
    per_rack: Scalar
    wanted: Callable[[Scalar], Scalar]
    frequency: Scalar
    damping: Scalar
    fastest: Scalar | None = None

    def states(self) -> tuple[Variable, ...]:
        """Return angle and rate."""
        return (
            Variable("angle", "rad", "Steering-wheel angle of the robot"),
            Variable("angle_rate", "rad/s", "Rate of the steering wheel of the robot"),
        )

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return the rack as the robot's states."""
        angle, rate = (clock.states[name] / self.per_rack for name in ("angle", "angle_rate"))
        return {self.rack: DrivenMotion(angle, rate)}

    def loads(self, situation: Situation) -> Loads:
        """Return the acceleration towards the angle wanted."""
        angle, rate = (situation.states[name] for name in ("angle", "angle_rate"))
        speed = self.frequency / (2.0 * self.damping) * (self.wanted(situation.time) - angle)
        if self.fastest is not None:
            speed = ops.minimum(ops.maximum(speed, -self.fastest), self.fastest)
        acceleration = 2.0 * self.damping * self.frequency * (speed - rate)
        return Loads(
            rates={"angle": rate, "angle_rate": acceleration},
            accelerations={self.rack: acceleration / self.per_rack},
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the angle wanted."""
        channel = Channel(f"{self.name}.wanted_angle", "rad", "Steering-wheel angle of the record")
        return (Output(channel, self.wanted(situation.time)),)


@dataclass(frozen=True)
class Towing(BasePart):
    """A force at the chassis's origin along its x axis that holds the speed, F = k (v_0 - v_x).

    ``target`` gives v_0 by the motion.
    """

    chassis: str
    target: Callable[[Situation], Scalar]
    gain: Scalar

    def loads(self, situation: Situation) -> Loads:
        """Return the force."""
        nothing = ops.vector(0.0, 0.0, 0.0)
        force = ops.vector(self._force(situation), 0.0, 0.0)
        return Loads(wrenches=(Wrench(self.chassis, force, nothing),))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the force."""
        channel = Channel(f"{self.name}.force", "N", "Force that holds the speed", self.chassis)
        return (Output(channel, self._force(situation)),)

    def _force(self, situation: Situation) -> Scalar:
        kinematics = situation.kinematics
        along = kinematics.rotation(self.chassis)[:, 0]
        return self.gain * (
            self.target(situation) - ops.dot(kinematics.velocity(self.chassis), along)
        )
