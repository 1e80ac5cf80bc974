"""Speed controller that drives all wheels from the chassis, or the vehicle's own driveline."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet, quantity

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadVehicle


class SpeedControl(ParameterSet):
    """Proportional-integral control of the forward speed by drive torque.

    T = K_p (v_0 - v) + K_i ∫ (v_0 - v) dt, shared equally by all wheels, or on the coordinate that
    drives the vehicle where it has a driveline.
    """

    proportional_gain: float = quantity("N*s", "Drive torque a speed error K_p", gt=0)
    integral_gain: float = quantity("N", "Growth of torque a speed error K_i", ge=0)

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with the controller and its driveline."""
        from vehicledyn.road.manoeuvres.speed_drive import SpeedDrive

        gains = vehicle.system.table.add_set("speed_control", self)
        wheels = () if vehicle.drive else tuple(corner.body for corner in vehicle.corners)
        return vehicle.with_parts(
            SpeedDrive(
                "drive",
                vehicle.chassis,
                wheels,
                vehicle.speed,
                gains.proportional_gain,
                gains.integral_gain,
                vehicle.drive,
            )
        )
