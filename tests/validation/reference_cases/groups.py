"""All groups of comparisons, in the order of the report; each is computed once a process."""

from __future__ import annotations

from functools import lru_cache

from reference_cases import (
    book,
    contact_points,
    convergence,
    histories,
    kinematics,
    limit_cycles,
    mechanics,
    modes,
    positions,
    rail_assessment,
    rail_contact,
    rail_geometry,
    rail_wheels,
    repeatability,
    rigid_wheelset,
    road_vehicles,
    slalom,
    standstill,
    suspensions,
    track,
    tyre_tables,
)

GROUPS = {
    "positions": positions.compare,
    "kinematics": kinematics.compare,
    "suspensions": suspensions.compare,
    "book": book.compare,
    "histories": histories.compare,
    "convergence": convergence.compare,
    "modes": modes.compare,
    "mechanics": mechanics.compare,
    "slalom": slalom.compare,
    "standstill": standstill.compare,
    "repeatability": repeatability.compare,
    "contact_points": contact_points.compare,
    "tyre_tables": tyre_tables.compare,
    "road_vehicles": road_vehicles.compare,
    "rail_geometry": rail_geometry.compare,
    "rail_contact": rail_contact.compare,
    "rail_wheels": rail_wheels.compare,
    "track": track.compare,
    "rail_assessment": rail_assessment.compare,
    "rigid_wheelset": rigid_wheelset.compare,
    "limit_cycles": limit_cycles.compare,
}


@lru_cache(maxsize=len(GROUPS))
def computed(name):
    """Return a group of comparisons."""
    return GROUPS[name]()
