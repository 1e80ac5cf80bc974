"""Contacts that carry no load: where nothing touches there is nothing to draw.

A contact of a wheel without load is kept where it would touch first, so that the equations stay
smooth. Its place, angle, radius, creepage and slip mean nothing there; its forces are zero and are
drawn, and so are deflection and approach, which are never positive there.
"""

from __future__ import annotations

import re
from collections.abc import Container

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.reader import Result

_ON_RAIL = re.compile(r"(.*\.contact_\d+)\.(place|lateral_place|angle|rolling_radius|.*creepage)")
_ON_ROAD = re.compile(r"(.*)\.(contact_[xyz]|tyre\.(longitudinal_slip|slip_angle))")
_LOADS = ((_ON_RAIL, "normal_force"), (_ON_ROAD, "tyre.normal_force"))


def load_of(name: str, known: Container[str]) -> str | None:
    """Return the channel whose load says whether a channel of contact geometry means anything."""
    for pattern, force in _LOADS:
        found = pattern.fullmatch(name)
        if found and (load := f"{found[1]}.{force}") in known:
            return load
    return None


def shown_values(result: Result, name: str) -> NDArray[np.float64]:
    """Return the values of a channel in SI, not numbers where its contact carries no load."""
    values = result.channel(name).values
    load = load_of(name, result.channels)
    if load is None:
        return values
    return np.where(result.channel(load).values > 0.0, values, np.nan)
