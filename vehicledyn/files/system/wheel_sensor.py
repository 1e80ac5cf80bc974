"""The sensor of wheel angles in system files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from vehicledyn.base.registry import register
from vehicledyn.files.expressions.expressions import origin
from vehicledyn.files.expressions.fields import Scalar, SystemSet, Vector, measured, reference
from vehicledyn.files.system.laws import Values
from vehicledyn.files.system.places import Place
from vehicledyn.files.system.sensors import AllCoordinates, SensorSet
from vehicledyn.multibody.model.ground import GROUND

if TYPE_CHECKING:
    from vehicledyn.multibody.elements.wheel_angles import SteeringAxis
    from vehicledyn.multibody.model.parts import Part


class SteeringAxisSet(SystemSet):
    """The line about which a wheel is steered."""

    lower: Place = Field(description="A point of the line")
    upper: Place = Field(description="A higher point of the line")

    def line(self, value: Values) -> SteeringAxis:
        """Return the line."""
        from vehicledyn.multibody.elements.point_forces import Attachment
        from vehicledyn.multibody.elements.wheel_angles import SteeringAxis

        ends = (Attachment(end.body, value(end.point)) for end in (self.lower, self.upper))
        return SteeringAxis(*ends)


@register("sensor", "wheel_angles")
class WheelAnglesSet(SensorSet):
    """Steer, toe and camber angle of a wheel, its centre and contact point, its steering axis."""

    body: str = reference("body", "The wheel carrier, which does not spin")
    centre: Vector = measured(
        "m", "Wheel centre in the axes of the body", default=origin(), nature="polar"
    )
    axis: Vector = measured(
        "", "Direction of the spin axis out of the car, axes of the body", nature="polar"
    )
    radius: Scalar = measured("m", "Radius of the wheel", above=0.0)
    side: Literal["left", "right"] = Field(default="left", description="Side of the vehicle")
    seen_from: str = reference("body", "Body whose axes all is measured in", default=GROUND)
    steering_axis: SteeringAxisSet | None = Field(
        default=None, description="Two points of the steering axis, where there are such points"
    )

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        from vehicledyn.multibody.elements.wheel_angles import WheelAngles

        line = self.steering_axis
        return WheelAngles(
            name,
            self.body,
            value(self.centre),
            value(self.axis),
            value(self.radius),
            is_left=self.side == "left",
            reference=self.seen_from,
            steering_axis=None if line is None else line.line(value),
        )
