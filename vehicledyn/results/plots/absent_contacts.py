"""Contacts of wheel and rail that carry no load: where nothing touches there is nothing to draw.

A contact without load is kept at some place of the profile, so that the equations stay smooth.
Its place, angle and radius mean nothing there; its forces are zero and are drawn.
"""

from __future__ import annotations

import re
from collections.abc import Container

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.reader import Result

_GEOMETRY = re.compile(r"(.*\.contact_\d+)\.(place|angle|rolling_radius|approach|.*creepage)")


def load_of(name: str, known: Container[str]) -> str | None:
    """Return the channel whose load says whether a channel of contact geometry means anything."""
    found = _GEOMETRY.fullmatch(name)
    load = f"{found[1]}.normal_force" if found else ""
    return load if load in known else None


def shown_values(result: Result, name: str) -> NDArray[np.float64]:
    """Return the values of a channel in SI, not numbers where its contact carries no load."""
    values = result.channel(name).values
    load = load_of(name, result.channels)
    if load is None:
        return values
    return np.where(result.channel(load).values > 0.0, values, np.nan)
