"""Slalom: cones in a row, passed left and right in turn by a driver at constant speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from vehicledyn.base.parameters import part, quantity
from vehicledyn.base.registry import register
from vehicledyn.road.drivers.driver import Driver
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre
from vehicledyn.road.manoeuvres.slalom_path import SlalomPath

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SceneItem, SummaryEntry
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "slalom")
class Slalom(RoadManoeuvre):
    """Cones on the x axis, the first passed on the left; the path passes them at its crests."""

    cones: int = Field(description="Number of cones", ge=1, le=1000)
    spacing: float = quantity("m", "Distance between cones", gt=0)
    first_cone: float = quantity("m", "Position x of the first cone", gt=0)
    cone_radius: float = quantity("m", "Radius of a cone's foot", ge=0)
    path_offset: float = quantity("m", "Lateral distance of the path from the cones", gt=0)
    driver: Driver = part("driver", "Who steers")

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with driver and speed control."""
        table = vehicle.system.table
        path = SlalomPath(
            first=table.add("manoeuvre.first_cone", self.first_cone, "m", "First cone"),
            spacing=table.add("manoeuvre.spacing", self.spacing, "m", "Distance between cones"),
            count=self.cones,
            offset=table.add("manoeuvre.path_offset", self.path_offset, "m", "Offset of the path"),
        )
        driven = super().fit(vehicle)
        return driven.with_parts(self.driver.part(driven, path.lateral_position))

    def cone_positions(self) -> list[tuple[float, float]]:
        """Return the positions of the cones, shape (n, 2) [m]."""
        return [(self.first_cone + k * self.spacing, 0.0) for k in range(self.cones)]

    def scene(self, vehicle: RoadVehicle) -> dict[str, SceneItem]:
        """Return the cones and the outline of the body."""
        from vehicledyn.results.store.layout import SceneItem

        cones = SceneItem(
            self.cone_positions(), "m", "Feet of the cones", {"radius": self.cone_radius}
        )
        return {**super().scene(vehicle), "cones": cones}

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the path among the cones."""
        return figures.standard(vehicle, path_title="Path through the slalom")

    def summarise(self, recording: Recording, vehicle: RoadVehicle) -> list[SummaryEntry]:
        """Return the cones cleared, the smallest clearance, and the general key figures."""
        from vehicledyn.results.metrics import clearance
        from vehicledyn.results.store.layout import SummaryEntry

        values, chassis = recording.channels, vehicle.chassis
        x, y, yaw = (values[f"{chassis}.{name}"] for name in ("x", "y", "yaw"))
        cones = self.cone_positions()
        found = clearance(vehicle.outline, x, y, yaw, cones=cones, radius=self.cone_radius)
        cleared = self._cleared(x, y, found.distance, vehicle)
        closest = int(found.distance.argmin())
        entries = [
            SummaryEntry("cones", self.cones, "1", "Cones of the course"),
            SummaryEntry(
                "cones_cleared", sum(cleared), "1", "Cones passed on their side without touch"
            ),
            SummaryEntry(
                "smallest_clearance",
                float(found.distance[closest]),
                "m",
                "Smallest clearance between the body's outline and a cone",
            ),
            SummaryEntry("smallest_clearance_at", closest + 1, "1", "Cone with that clearance"),
        ]
        return [*entries, *super().summarise(recording, vehicle)]

    def _cleared(self, x: Any, y: Any, distance: Any, vehicle: RoadVehicle) -> list[bool]:
        """Return for each cone whether it was passed untouched and on its side."""
        import numpy as np

        rear = min(corner[0] for corner in vehicle.outline)
        cleared = []
        for index, (cone_x, cone_y) in enumerate(self.cone_positions()):
            side = 1.0 if index % 2 == 0 else -1.0
            beside = int(np.argmin(np.abs(x - cone_x)))
            passed = bool(x[-1] + rear > cone_x) and side * (y[beside] - cone_y) > 0.0
            cleared.append(passed and bool(distance[index] > 0.0))
        return cleared
