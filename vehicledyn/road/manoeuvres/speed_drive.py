"""What a speed controller drives: each wheel from the chassis, or the input of a driveline."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class SpeedDrive(BasePart):
    """Torque about each wheel's axis, taken from the chassis by drive shafts with joints.

    Where there is a coordinate ``shaft``, the torque acts on it alone.
    """

    chassis: str
    wheels: tuple[str, ...]
    target: Scalar
    proportional_gain: Scalar
    integral_gain: Scalar
    shaft: str = ""

    def states(self) -> tuple[Variable, ...]:
        """Return the integral of the speed error."""
        return (Variable("speed_error_integral", "m", "Integral of the speed error"),)

    def loads(self, situation: Situation) -> Loads:
        """Return the torques and the rate of the integral."""
        rates = {"speed_error_integral": self._error(situation)}
        if self.shaft:
            return Loads(joint_forces={self.shaft: self._torque(situation)}, rates=rates)
        torque = situation.hand("torque", self._torque(situation))
        share = torque / len(self.wheels)
        kinematics = situation.kinematics
        nothing = ops.vector(0.0, 0.0, 0.0)
        to_chassis = kinematics.rotation(self.chassis).T
        wrenches = []
        for wheel in self.wheels:
            axis = rotations.axis_vector(2)
            reaction = -share * (to_chassis @ (kinematics.rotation(wheel) @ axis))
            wrenches.append(Wrench(wheel, nothing, share * axis))
            wrenches.append(Wrench(self.chassis, nothing, reaction))
        return Loads(wrenches=tuple(wrenches), rates=rates)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the total torque."""
        of = f"on {self.shaft}" if self.shaft else "of all wheels together"
        channel = Channel(f"{self.name}.torque", "N*m", f"Drive torque {of}")
        return (Output(channel, self._torque(situation)),)

    def _error(self, situation: Situation) -> Scalar:
        velocity = situation.kinematics.velocity(self.chassis)
        heading = situation.kinematics.rotation(self.chassis)[:, 0]
        level = ops.smooth_norm(heading[0], heading[1], 0.0)
        speed = (velocity[0] * heading[0] + velocity[1] * heading[1]) / level
        return self.target - speed

    def _torque(self, situation: Situation) -> Scalar:
        integral = situation.states["speed_error_integral"]
        return self.proportional_gain * self._error(situation) + (self.integral_gain * integral)
