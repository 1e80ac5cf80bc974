"""Sensor of how a wheel carrier stands: steer, toe, camber, contact point, steering axis.

Axes are those of a reference body, x forward, y to the left, z up (ISO 8855). With the spin axis
pointing out of the car, and side = 1 on the left, -1 on the right:

- the steer angle is positive to the left, the toe angle where the wheels point inwards in front;
- the camber angle is that of the wheel plane to the vertical as seen from the front, the
  inclination that of the wheel plane to the vertical itself; they differ where the wheel is
  steered; both are positive where the wheel leans outwards at its top;
- the contact point is the lowest point of a thin disc of the given radius;
- the half track is the distance of the contact point from the plane y = 0, positive outwards;
- caster is positive where the steering axis leans backwards at its top, kingpin inclination
  where it leans inwards;
- on the level of the contact point, along the heading of the wheel and across it, the steering
  axis lies the mechanical trail before the contact point and the lateral offset inside it
  (negative: outside); the scrub radius is the distance of the two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.registry import register
from vehicledyn.multibody.elements.point_forces import Attachment
from vehicledyn.multibody.model.declaration import (
    ORIGIN,
    attachment,
    body_name,
    choice,
    group,
    number,
    vector,
)
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.parts import BasePart, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar, Vec

_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class SteeringAxis:
    """The line about which a wheel is steered, through a lower and an upper point."""

    lower: Attachment = attachment("A point of the line")
    upper: Attachment = attachment("A higher point of the line")


@register("sensor_type", "wheel_angles")
@dataclass(frozen=True, kw_only=True)
class WheelAngles(BasePart):
    """Steer, toe and camber angle of a wheel, its centre and contact point, its steering axis.

    The module says how they are measured.
    """

    body: str = body_name("The wheel carrier, which does not spin")
    centre: Sequence[Scalar] = vector("m", "Wheel centre in the axes of the body", default=ORIGIN)
    axis: Sequence[Scalar] = vector(
        "", "Direction of the spin axis out of the car, axes of the body"
    )
    radius: Scalar = number("m", "Radius of the wheel", above=0.0)
    side: Literal["left", "right"] = choice("Side of the vehicle", default="left", nature="side")
    seen_from: str = body_name("Body whose axes all is measured in", default=GROUND)
    steering_axis: SteeringAxis | None = group(
        "Two points of the steering axis, where there are such points", default=None
    )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return angles [rad] and places [m] in the axes of the reference body."""
        centre = self._place(situation, self.body, self.centre)
        out = self._direction(situation)
        side = 1.0 if self.side == "left" else -1.0
        level = ops.sqrt(out[0] * out[0] + out[1] * out[1])
        contact = centre + self.radius * _down(out, level)
        steer = ops.atan2(-side * out[0], side * out[1])
        found = [
            self._output("steer_angle", "rad", "Steer angle, positive to the left", steer),
            self._output("toe_angle", "rad", "Toe angle, positive inwards", -side * steer),
            self._output(
                "camber",
                "rad",
                "Camber angle as seen from the front, positive outwards",
                -ops.atan2(out[2], side * out[1]),
            ),
            self._output(
                "inclination",
                "rad",
                "Angle of the wheel plane to the vertical, positive outwards",
                -ops.atan2(out[2], level),
            ),
            self._output(
                "half_track", "m", "Contact point from the middle plane", side * contact[1]
            ),
            *self._components("", "m", "Wheel centre", centre),
            *self._components("contact_", "m", "Lowest point of the wheel", contact),
            *self._motion(situation, contact),
        ]
        if self.steering_axis is not None:
            heading = (side * out[1] / level, -side * out[0] / level)
            found += self._steering(situation, self.steering_axis, contact, heading)
        return tuple(found)

    def _steering(
        self,
        situation: Situation,
        line: SteeringAxis,
        contact: Vec,
        heading: tuple[Scalar, Scalar],
    ) -> list[Output]:
        side = 1.0 if self.side == "left" else -1.0
        lower = self._place(situation, line.lower.body, line.lower.point)
        up = self._place(situation, line.upper.body, line.upper.point) - lower
        at_ground = lower + up * ((contact[2] - lower[2]) / up[2])
        reach = at_ground - contact
        trail = reach[0] * heading[0] + reach[1] * heading[1]
        offset = side * (reach[0] * heading[1] - reach[1] * heading[0])
        return [
            self._output("caster", "rad", "Caster angle", ops.atan2(-up[0], up[2])),
            self._output(
                "kingpin_inclination", "rad", "Kingpin inclination", ops.atan2(-side * up[1], up[2])
            ),
            self._output("mechanical_trail", "m", "Steering axis before the contact point", trail),
            self._output("lateral_offset", "m", "Steering axis inside the contact point", offset),
            self._output(
                "scrub_radius",
                "m",
                "Steering axis from the contact point",
                ops.sqrt(trail * trail + offset * offset),
            ),
        ]

    def _place(self, situation: Situation, body: str, point: Sequence[Scalar]) -> Vec:
        """Return a point in the axes of the reference body."""
        k = situation.kinematics
        place = ops.vector(*_three(point)) if body == GROUND else k.position(body, point)
        if self.seen_from == GROUND:
            return place
        return k.rotation(self.seen_from).T @ (place - k.position(self.seen_from))

    def _direction(self, situation: Situation) -> Vec:
        """Return the spin axis out of the car, a unit vector in the axes of the reference."""
        k = situation.kinematics
        turned = k.rotation(self.body) @ ops.unit(ops.vector(*_three(self.axis)))
        return turned if self.seen_from == GROUND else k.rotation(self.seen_from).T @ turned

    def _motion(self, situation: Situation, contact: Vec) -> list[Output]:
        """Return how the carrier moves to the reference: what instant axes are found from."""
        k = situation.kinematics
        turning = k.rotation(self.body) @ k.angular_velocity(self.body)
        to_world = ops.vector(0.0, 0.0, 0.0)
        if self.seen_from != GROUND:
            rotation = k.rotation(self.seen_from)
            turning = rotation.T @ turning - k.angular_velocity(self.seen_from)
            to_world = k.position(self.seen_from)
            contact = rotation @ contact
        place = to_world + contact
        arm = k.rotation(self.body).T @ (place - k.position(self.body))
        speed = k.velocity(self.body, arm)
        if self.seen_from != GROUND:
            rotation = k.rotation(self.seen_from)
            carried = k.velocity(self.seen_from, rotation.T @ (place - to_world))
            speed = rotation.T @ (speed - carried)
        return [
            *self._components("turning_", "rad/s", "Angular velocity of the carrier", turning),
            *self._components(
                "contact_velocity_",
                "m/s",
                "Velocity of the carrier's point at the contact point",
                speed,
            ),
        ]

    def _components(self, head: str, unit: str, text: str, vector: Vec) -> list[Output]:
        return [
            self._output(f"{head}{axis}", unit, f"{text}, {axis}", vector[k])
            for k, axis in enumerate(_AXES)
        ]

    def _output(self, name: str, unit: str, text: str, value: Scalar) -> Output:
        return Output(Channel(f"{self.name}.{name}", unit, text, self.seen_from), value)


def _down(out: Vec, level: Scalar) -> Vec:
    """Return the steepest direction down within the plane across a unit vector."""
    return ops.vector(out[0] * out[2] / level, out[1] * out[2] / level, -level)


def _three(vector: Sequence[Scalar] | Vec) -> list[Scalar]:
    return [vector[0], vector[1], vector[2]]
