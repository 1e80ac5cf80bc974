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
    import numpy as np
    from numpy.typing import NDArray

    from vehicledyn.results.store.layout import SceneItem, SummaryEntry
    from vehicledyn.road.vehicle import RoadVehicle

    Floats = NDArray[np.float64]


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
        from vehicledyn.results.store.layout import SummaryEntry

        names = [f"{vehicle.chassis}.{name}" for name in ("x", "y", "yaw")]
        passage = _Passage(self.cone_positions(), vehicle, self.cone_radius)
        for block in recording.blocks(names):
            passage.take(*(block.channels[name] for name in names))
        cleared = passage.cleared()
        closest = int(passage.distance.argmin())
        entries = [
            SummaryEntry("cones", self.cones, "1", "Cones of the course"),
            SummaryEntry(
                "cones_cleared", sum(cleared), "1", "Cones passed on their side without touch"
            ),
            SummaryEntry(
                "smallest_clearance",
                float(passage.distance[closest]),
                "m",
                "Smallest clearance between the body's outline and a cone",
            ),
            SummaryEntry("smallest_clearance_at", closest + 1, "1", "Cone with that clearance"),
        ]
        return [*entries, *super().summarise(recording, vehicle)]


class _Passage:
    """How a vehicle passes cones, pose by pose."""

    def __init__(
        self, cones: list[tuple[float, float]], vehicle: RoadVehicle, radius: float
    ) -> None:
        import numpy as np

        self._cones, self._outline, self._radius = cones, vehicle.outline, radius
        self.distance = np.full(len(cones), np.nan)
        self._away, self._beside = np.full(len(cones), np.inf), np.zeros(len(cones))
        self._x = 0.0

    def take(self, x: Floats, y: Floats, yaw: Floats) -> None:
        """Take further poses, shape (n,) [m, m, rad]."""
        import numpy as np

        from vehicledyn.results.metrics import clearance

        found = clearance(self._outline, x, y, yaw, cones=self._cones, radius=self._radius)
        self.distance = np.fmin(self.distance, found.distance)
        for index, (cone_x, _) in enumerate(self._cones):
            away = np.abs(x - cone_x)
            nearest = int(np.argmin(away))
            if np.minimum(self._away[index], away[nearest]) != self._away[index]:
                self._away[index], self._beside[index] = away[nearest], y[nearest]
        self._x = float(x[-1])

    def cleared(self) -> list[bool]:
        """Return for each cone whether it was passed untouched and on its side."""
        rear = min(corner[0] for corner in self._outline)
        cleared = []
        for index, (cone_x, cone_y) in enumerate(self._cones):
            side = 1.0 if index % 2 == 0 else -1.0
            passed = self._x + rear > cone_x and side * (self._beside[index] - cone_y) > 0.0
            cleared.append(bool(passed and self.distance[index] > 0.0))
        return cleared
