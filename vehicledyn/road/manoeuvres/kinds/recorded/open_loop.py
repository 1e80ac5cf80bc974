"""Open loop: steering, drive and brakes by tables of time that the scenario holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import model_validator

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.driving_test import PREFIX, DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal
from vehicledyn.road.manoeuvres.time_table import KNOTS, TimeTable

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadVehicle

_LISTS = ("angles", "hand_torques", "drive_torques", "brake_torques")


@register("manoeuvre", "open_loop")
class OpenLoop(DrivingTest):
    """Steer, drive and brake by lists of values at the same times, with straight lines between.

    A list that is left out is zero. Torques act as in the standards' tests: a car with pedals of
    its own has them pressed by torque over that of the full pedal. With a speed control the drive
    torque is added to what it wants.

    With ``hand_torques`` the steering wheel is free and moves by these torques (free control);
    torques of zero let it go. ``angles`` must then be left out.
    """

    times: tuple[float, ...] = quantity("s", f"Times, growing, {KNOTS} at most")
    angles: tuple[float, ...] = quantity("rad", "Steering-wheel angles to the left", default=())
    hand_torques: tuple[float, ...] = quantity(
        "N*m", "Torques of the hands on a free steering wheel, to the left", default=()
    )
    drive_torques: tuple[float, ...] = quantity("N*m", "Drive torques", default=())
    brake_torques: tuple[float, ...] = quantity(
        "N*m", "Brake torques of all wheels together", default=()
    )

    @model_validator(mode="after")
    def _fit_together(self) -> OpenLoop:
        """Refuse lists of other lengths and times that do not grow."""
        for name in _LISTS:
            if len(getattr(self, name)) not in (0, len(self.times)):
                count = f"{len(getattr(self, name))} values and {len(self.times)} times"
                raise ValueError(f"{name}: {count}; give as many")
        if self.angles and self.hand_torques:
            raise ValueError("hand_torques: the steering wheel has angles already; give one list")
        if not 0 < len(self.times) <= KNOTS:
            raise ValueError(f"times: takes 1 to {KNOTS} times, not {len(self.times)}")
        if any(b <= a for a, b in zip(self.times, self.times[1:], strict=False)):
            raise ValueError("times: must grow; sort the table")
        return self

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle steered by angle, or by torque where there are any."""
        if not self.hand_torques:
            return super().fit(vehicle)
        from vehicledyn.multibody.elements.coordinate_forces import CoordinateForce

        table, name = vehicle.system.table, f"{PREFIX}.hand_torque"
        torque = self._table(self.hand_torques).enter(table, name, "N*m", "torque of the hands")
        per_rack = vehicle.steering_gain * vehicle.steering_ratio
        hands = CoordinateForce("hands", vehicle.rack, lambda seen: torque(seen.time) * per_rack)
        return self.with_pedals(vehicle.with_free_steering()).with_parts(hands)

    def steering(self) -> SteeringSignal:
        """Return the steering by the table."""
        return SteeringSignal(knots=self._table(self.angles))

    def drive_torque(self) -> TimeTable:
        """Return the drive torque by the table."""
        return self._table(self.drive_torques)

    def brake_torque(self) -> TimeTable:
        """Return the brake torque by the table."""
        return self._table(self.brake_torques)

    def brakes_to_rest(self) -> bool:
        """Return whether there are brake torques, of zero too: they may be changed."""
        return bool(self.brake_torques)

    def _table(self, values: tuple[float, ...]) -> TimeTable:
        return TimeTable(self.times, values) if values else TimeTable()
