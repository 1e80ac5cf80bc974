"""Profiles made ready for rigid contact: outlines as tables, and the places where it may be."""

from __future__ import annotations

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.rail.contact.rigid_contact import RigidWheel
from vehicledyn.rail.contact.rigid_touch import TouchingWheel
from vehicledyn.rail.geometry.contact_geometry import MountedWheel, Pose, Rail, wheel_standing
from vehicledyn.rail.profiles.outline import TableOutline
from vehicledyn.rail.profiles.profile_pieces import QuinticTable
from vehicledyn.rail.track.track import Side
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable

OUTLINE_STEP = 1e-4
"""Width of the cells of outlines [m]."""

PLACE_STEP = 5e-4
"""Distance of the places at which a second point of contact is looked for [m]."""

_REACH, _SHIFT_STEP = 0.025, 5e-4
_MARGIN = 2e-3
_LEAP = 4.0 * _SHIFT_STEP


def rigid_wheels(
    wheel: MountedWheel,
    rail: Rail,
    sides: tuple[Side, ...],
    *,
    radius: Scalar,
    half_distance: Scalar,
) -> tuple[RigidWheel, ...]:
    """Return the equal wheels of a body in rigid contact.

    Parameters
    ----------
    wheel, rail
        Profiles in their places.
    sides
        Sides on which there is a wheel.
    radius, half_distance
        Those of the tape circle, numbers or symbols [m].

    Raises
    ------
    InputError
        If the wheel is above its rail at no lateral shift.
    """
    tread, head = outline("wheel", wheel.table), outline("rail", rail.surface)
    visited = visited_places(wheel, rail)
    ends = (
        max(min(visited) - _MARGIN, wheel.table.begin + OUTLINE_STEP),
        min(max(visited) + _MARGIN, wheel.table.end - OUTLINE_STEP),
    )
    leaps = np.abs(np.diff(visited)).max(initial=0.0) > _LEAP
    count = int(np.ceil((ends[1] - ends[0]) / PLACE_STEP))
    places = tuple(map(float, np.linspace(*ends, count + 1))) if leaps else ()
    return tuple(
        RigidWheel(
            TouchingWheel(1.0 if side == "left" else -1.0, tread, head, radius, half_distance),
            start=visited[int(np.argmin(np.abs(visited)))],
            ends=ends,
            places=places,
        )
        for side in sides
    )


def outline(name: str, table: QuinticTable) -> TableOutline:
    """Return a profile with cells of equal width, twice differentiable."""
    count = int(np.floor((table.end - table.begin) / OUTLINE_STEP * (1.0 + 1e-12)))
    places = table.begin + OUTLINE_STEP * np.arange(count + 1, dtype=np.float64)
    heights = table.height(np.clip(places, table.begin, table.end))
    return TableOutline(CurveTable.through(name, table.begin, OUTLINE_STEP, heights))


def visited_places(wheel: MountedWheel, rail: Rail) -> list[float]:
    """Return where a wheel touches its rail, from inner to outer shifts of some centimetres [m].

    Contacts at ends of profiles are left out.

    Raises
    ------
    InputError
        If the wheel touches its rail at no lateral shift.
    """
    found = []
    for shift in np.arange(-_REACH, _REACH, _SHIFT_STEP):
        try:
            touch = wheel_standing(wheel, rail, Pose(float(shift), 0.0, 0.0, 0.0))[1]
        except InputError:
            continue
        if not touch.edge[0]:
            found.append(float(touch.place[0]))
    if not found:
        raise InputError("the wheel touches the rail at no lateral shift")
    return found
