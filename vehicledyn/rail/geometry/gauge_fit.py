"""Whether a wheelset fits a gauge: said before anything else is computed."""

from __future__ import annotations

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.rail.geometry.contact_geometry import GapMinima, MountedWheel, Rail
from vehicledyn.rail.geometry.wheelset_geometry import WheelsetOnTrack, stand_level

FLANGE_LEVEL = 0.01
"""Height over the tape circle at which the thickness of flanges is measured [m]."""

CLIMBED = 5e-3
"""How far the tip of a flange is outside the gauge face when it has climbed the rail [m]."""


def check_fit(wheelset: WheelsetOnTrack, gauge: float) -> None:
    """Raise an InputError if a wheelset in the middle of the track does not stand on its treads.

    Parameters
    ----------
    wheelset
        Wheels and rails.
    gauge
        Gauge of the track, for the message [m].
    """
    active = _active_gauge(wheelset)
    words = f"; the flanges are {1e3 * active:.1f} mm apart" if active else ""
    text = f"gauge {1e3 * gauge:g} mm does not fit the wheelset{words}"
    try:
        standing = stand_level(wheelset, 0.0)
    except InputError as error:
        raise InputError(f"{text}: {error}") from None
    for side in ("left", "right"):
        touch: GapMinima = getattr(standing, side)
        wheel: MountedWheel = getattr(wheelset, f"{side}_wheel")
        if float(wheel.table.height(touch.place[:1])[0]) > FLANGE_LEVEL:
            raise InputError(f"{text}: in the middle of the track the {side} flange is on the rail")
        if touch.edge[0]:
            raise InputError(
                f"{text}: in the middle of the track the {side} wheel meets its rail only where "
                "a profile ends"
            )
        if active and _falls_between(wheel, getattr(wheelset, f"{side}_rail"), gauge - active):
            raise InputError(
                f"{text}: with the other flange on its rail the {side} wheel is no longer on "
                "the crown of its own"
            )


def climbed_side(wheelset: WheelsetOnTrack, lateral: float) -> str | None:
    """Return the side whose flange stands over its rail at a lateral shift [m], if one does."""
    for side, sign in (("left", 1.0), ("right", -1.0)):
        wheel: MountedWheel = getattr(wheelset, f"{side}_wheel")
        rail: Rail = getattr(wheelset, f"{side}_rail")
        places, height, _ = wheel.scan
        tip = wheel.half_distance + float(places[np.argmax(height)]) + sign * lateral
        if height.max() > FLANGE_LEVEL and tip > rail.surface.begin + CLIMBED:
            return side
    return None


def _falls_between(wheel: MountedWheel, rail: Rail, play: float) -> bool:
    """Return whether the tread ends inside the rail's axis when all play is on its side."""
    return wheel.half_distance + wheel.table.end - 0.5 * play < rail.origin[0]


def _active_gauge(wheelset: WheelsetOnTrack) -> float | None:
    """Return the distance of the flanges at the level where they guide, None without flanges."""
    total = 0.0
    for wheel in (wheelset.left_wheel, wheelset.right_wheel):
        places, height, _ = wheel.scan
        beyond = np.flatnonzero(height > FLANGE_LEVEL)
        if len(beyond) == 0:
            return None
        total += wheel.half_distance + float(places[beyond[-1]])
    return total
