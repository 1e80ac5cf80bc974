"""Sensor of the steering angle and of the understeer angle."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.model.parts import BasePart, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class SteeringAngle(BasePart):
    """Shows the steering angle, and by how much it exceeds the one that rolling alone needs."""

    chassis: str
    rack: str
    angle_per_rack: Scalar
    ratio: Scalar
    wheelbase: Scalar

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return steering angle and understeer angle."""
        kinematics = situation.kinematics
        rack = kinematics.coordinate(self.rack)
        angle = rack * self.angle_per_rack
        velocity = kinematics.velocity(self.chassis)
        speed = ops.maximum(ops.smooth_norm(velocity[0], velocity[1], 0.0), 1.0)
        yaw_rate = (kinematics.rotation(self.chassis) @ kinematics.angular_velocity(self.chassis))[
            2
        ]
        rolling = self.wheelbase * yaw_rate / speed
        steering = Channel(f"{self.name}.angle", "rad", "Steering-wheel angle, to the left")
        understeer = Channel(
            f"{self.name}.understeer_angle",
            "rad",
            "Angle of the front wheels beyond wheelbase times yaw rate over speed",
        )
        return (
            Output(steering, self.ratio * angle),
            Output(understeer, angle - rolling),
        )
