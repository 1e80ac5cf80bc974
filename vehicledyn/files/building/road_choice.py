"""What a scenario chooses for the wheels of a model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from vehicledyn.road.surfaces.surface import RoadSurface

if TYPE_CHECKING:
    from vehicledyn.base.parameters import ParameterSet
    from vehicledyn.rail.track.track import Track
    from vehicledyn.road.patches.patch import FrictionPatch


@dataclass(frozen=True)
class RoadChoice:
    """What a scenario chooses for the wheels of a system; None leaves it to the file.

    ``speed`` is the forward speed at the start [m/s], ``patches`` what the manoeuvre lays over
    the road, ``track`` the railway track of the scenario, its files read.
    """

    front_tyre: ParameterSet | None = None
    rear_tyre: ParameterSet | None = None
    surface: ParameterSet | None = None
    patches: tuple[FrictionPatch, ...] = ()
    free_wheels: bool = True
    speed: float = 0.0
    contact: str = "disc"
    relaxation: ParameterSet | None = None
    track: Track | None = None
    creep: ParameterSet | None = None
    rail_contact: ParameterSet | None = None

    def laid(self, road: ParameterSet | None) -> ParameterSet | None:
        """Return a road with the patches of the manoeuvre over its own."""
        if not self.patches or not isinstance(road, RoadSurface):
            return road
        return road.model_copy(update={"patches": [*road.patches, *self.patches]})
