"""Gradients of steady-state cornering over lateral acceleration (ISO 4138)."""

from __future__ import annotations

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.road.standards.signals import Floats


def gradient_at(acceleration: Floats, values: Floats, at: float, *, width: float = 0.5) -> float:
    """Return the slope of values over lateral acceleration at one, by a line through those near.

    Parameters
    ----------
    acceleration, values
        Points of steady cornering, shape (n,) [m/s²].
    at
        Lateral acceleration of the slope [m/s²].
    width
        Points no farther than this are used [m/s²].

    Raises
    ------
    InputError
        If there are fewer than two points near.
    """
    near = np.abs(acceleration - at) <= width
    if near.sum() < 2 or np.ptp(acceleration[near]) == 0.0:
        raise InputError(f"no two points of steady cornering near {at:g} m/s^2 to draw a line by")
    return float(np.polyfit(acceleration[near] - at, values[near], 1)[0])


def initial_gradient(acceleration: Floats, values: Floats, last: float) -> float:
    """Return the slope of a line through all points up to a lateral acceleration [m/s²]."""
    return gradient_at(acceleration, values, 0.5 * last, width=0.5 * last)
