"""What every manoeuvre of a road vehicle can do: fit itself to a vehicle, and sum up a run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.road.manoeuvres import figures, key_figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.speed_control import SpeedControl

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SceneItem, SummaryEntry
    from vehicledyn.road.patches.patch import FrictionPatch
    from vehicledyn.road.vehicle import RoadVehicle


class RoadManoeuvre(ParameterSet):
    """Base of the manoeuvres; by itself the car goes straight on with the rack held.

    ``speed_control`` drives the wheels; without it nothing does. The summary of a run with a
    ``seat`` has the vibration there.
    """

    speed_control: SpeedControl | None = Field(
        default=None, description="Controller that holds the speed; free wheels only"
    )

    seat: tuple[float, float, float] | None = quantity(
        "m", "Seat in the axes of the chassis, whose vibration ISO 2631-1 assesses", default=None
    )

    coordinate_fields: ClassVar[tuple[str, ...]] = ()
    """Fields that name a coordinate of the vehicle; checked where the scenario is read."""

    def problems(self, *, free_wheels: bool) -> list[str]:
        """Return what in the manoeuvre does not go with the vehicle, one sentence each."""
        if self.speed_control is not None and not free_wheels:
            return ["speed_control needs 'wheel_spin: free'; prescribed wheels are not driven"]
        return []

    def patches(self) -> tuple[FrictionPatch, ...]:
        """Return patches of friction that the manoeuvre lays over those of the road."""
        return ()

    def placed(self, folder: Path) -> RoadManoeuvre:
        """Return the same manoeuvre, with files that it names looked for in a folder."""
        return self

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with steering and drive."""
        if self.speed_control is None:
            return vehicle
        return self.speed_control.fit(vehicle)

    def with_seat(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return a vehicle with a sensor at the seat, if one is given."""
        if self.seat is None:
            return vehicle
        from vehicledyn.multibody.elements.motion_sensors import SeatSensor

        table, words = vehicle.system.table, "Seat in the axes of the chassis"
        place = zip("xyz", self.seat, strict=True)
        point = tuple(table.add(f"seat.{axis}", value, "m", words) for axis, value in place)
        return vehicle.with_parts(SeatSensor("seat", vehicle.chassis, point))

    def scene(self, vehicle: RoadVehicle) -> dict[str, SceneItem]:
        """Return static things to show in pictures."""
        return key_figures.outline_scene(vehicle)

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return descriptions of the standard figures."""
        return figures.standard(vehicle)

    def channels(self, vehicle: RoadVehicle) -> list[str]:
        """Return the channels that the summary is made from."""
        return key_figures.channels(vehicle)

    def summarise(self, recording: Recording, vehicle: RoadVehicle) -> list[SummaryEntry]:
        """Return the key figures of a run."""
        return key_figures.summarise(recording, vehicle)
