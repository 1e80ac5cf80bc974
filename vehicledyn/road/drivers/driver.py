"""What a driver is: a part that moves the rack so that the car follows a path."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Part
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar


class Driver(ParameterSet):
    """Base of the drivers of the catalogue."""

    @abstractmethod
    def part(self, vehicle: RoadVehicle, path: Callable[[Scalar], Scalar]) -> Part:
        """Return the part that drives ``vehicle.rack`` along y = path(x) [m]."""
