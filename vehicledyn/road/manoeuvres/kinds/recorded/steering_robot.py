"""Steering robot: the steering wheel by samples of a recorded run, followed with a robot's lag."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from pydantic import model_validator

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.driving_test import DrivingTest

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar

MOST_SAMPLES = 100_000


@register("manoeuvre", "steering_robot")
class SteeringRobot(DrivingTest):
    """Turn the steering wheel as in a recorded run, by samples at equal distances of time.

    Straight lines join the samples; before the first and behind the last the angle is held. The
    robot follows as a damped second-order system with a largest rate. The speed is held
    by the ``speed_control``, or by a towing force at the chassis's origin along its axis, as in
    comparisons with programs that do so.
    """

    interval: float = quantity("s", "Distance of the samples", gt=0)
    angles: tuple[float, ...] = quantity("rad", "Steering-wheel angles to the left, two at least")
    begin: float = quantity("s", "Time of the first sample", default=0.0, ge=0)
    lag_frequency: float = quantity("rad/s", "Bandwidth of the robot ω", default=100.0, gt=0)
    lag_damping: float = quantity("1", "Damping ratio of the robot ζ", default=0.8, gt=0)
    fastest: float | None = quantity("rad/s", "Largest rate of the robot", default=None, gt=0)
    towing_gain: float | None = quantity(
        "N*s/m", "Towing force over the error of speed; none without", default=None, gt=0
    )

    @model_validator(mode="after")
    def _makes_a_record(self) -> SteeringRobot:
        """Refuse what is no record."""
        if not 2 <= len(self.angles) <= MOST_SAMPLES:
            raise ValueError(f"angles: takes 2 to {MOST_SAMPLES} samples, not {len(self.angles)}")
        if self.towing_gain is not None and self.speed_control is not None:
            raise ValueError(
                "towing_gain: leave it or speed_control out; one of them holds the speed"
            )
        return self

    def record(self) -> Callable[[Scalar], Scalar]:
        """Return the recorded angle as a function of time."""
        import numpy as np

        from vehicledyn.symbolic import ops
        from vehicledyn.symbolic.tables import CurveTable

        lines = np.column_stack([self.angles[:-1], np.diff(self.angles)])
        curve = CurveTable("steering", self.begin, self.interval, lines)
        end = self.begin + (len(self.angles) - 1) * self.interval
        return lambda time: curve.value(ops.minimum(ops.maximum(time, self.begin), end))

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with the robot, pedals and towing force."""
        from vehicledyn.road.manoeuvres.robot import Robot, Towing

        table = vehicle.system.table

        def number(name: str, unit: str, text: str) -> Scalar:
            return table.add(f"robot.{name}", getattr(self, name), unit, text)

        fastest = None if self.fastest is None else number("fastest", "rad/s", "Largest rate")
        robot = Robot(
            "robot",
            vehicle.rack,
            vehicle.steering_gain * vehicle.steering_ratio,
            self.record(),
            number("lag_frequency", "rad/s", "Bandwidth of the robot"),
            number("lag_damping", "1", "Damping ratio of the robot"),
            fastest,
        )
        found = self.with_pedals(vehicle).with_parts(robot)
        if self.towing_gain is None:
            return found
        gain = number("towing_gain", "N*s/m", "Towing force over the error of speed")
        return found.with_parts(Towing("towing", vehicle.chassis, lambda _: vehicle.speed, gain))
