"""The Iltis of the catalogue: its parameters, and what is loaded once it is built."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import find, register
from vehicledyn.vehicles.iltis_parameters import DATA_FILE, IltisParameters, default_parameters

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadOptions, RoadVehicle


@register("model", "iltis")
class Iltis:
    """VW/Bombardier Iltis 4x4, the IAVSD road-vehicle benchmark of 1990."""

    parameter_class: ClassVar[type[ParameterSet]] = IltisParameters
    parameter_file: ClassVar[Path] = DATA_FILE
    needs: ClassVar[tuple[str, ...]] = ("tyres", "road", "wheel_spin")

    @classmethod
    def default_parameters(cls) -> dict[str, Any]:
        """Return the parameters of the data file, with units."""
        return default_parameters()

    @classmethod
    def standard_options(cls) -> RoadOptions:
        """Return the parts of the benchmark: its tyres on a flat road, wheels prescribed."""
        from vehicledyn.road.vehicle import RoadOptions

        tyre = find("tyre", "calspan")()
        flat = find("road", "flat")()
        return RoadOptions(tyre, tyre, flat, free_wheels=False, speed=0.0, contact="vertical")

    @classmethod
    def build(cls, parameters: IltisParameters, options: RoadOptions) -> RoadVehicle:
        """Return the vehicle on its road, without steering or drive."""
        from vehicledyn.vehicles.iltis_vehicle import build_iltis

        return build_iltis(parameters, options)
