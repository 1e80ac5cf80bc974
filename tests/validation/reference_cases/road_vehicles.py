"""Road vehicles with trailers, on two wheels and off the road, against second formulations."""

from __future__ import annotations

from reference_cases import caravan, motorcycle, off_road_truck, semitrailer
from reference_cases.comparison import Group


def compare():
    """Return the comparisons."""
    parts = (caravan, semitrailer, motorcycle, off_road_truck)
    return Group(
        "Road vehicles: trailers, motorcycle, off-road truck",
        "Bands: 1 % for critical speeds and axle loads, 0.5 % for powers, 0.2 % for statics; "
        "for the motorcycle what tyres that sink in change.",
        tuple(row for part in parts for row in part.rows()),
    )
