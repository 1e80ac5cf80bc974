"""Settings of the preview driver, see :mod:`vehicledyn.road.drivers.preview_driver`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.drivers.driver import Driver

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Part
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar


@register("driver", "preview")
class Preview(Driver):
    """Driver who looks one preview time ahead along the path."""

    preview_time: float = quantity("s", "How far ahead the driver looks T", gt=0)
    understeer: float = quantity("rad*s^2/m", "Understeer the driver makes up for K", default=0.0)
    lag_frequency: float = quantity("rad/s", "Bandwidth of arms and nerves", gt=0)
    lag_damping: float = quantity("1", "Damping ratio of arms and nerves", gt=0)
    rack_stop: float = quantity("m", "Largest rack displacement", gt=0)

    def part(self, vehicle: RoadVehicle, path: Callable[[Scalar], Scalar]) -> Part:
        """Return the driver at the wheel of a vehicle."""
        from vehicledyn.road.drivers.preview_driver import PreviewDriver

        settings = vehicle.system.table.add_set("driver", self)
        return PreviewDriver("driver", vehicle, settings, path)
