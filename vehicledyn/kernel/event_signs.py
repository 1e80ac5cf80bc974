"""On which side of zero the functions of events lie, and when a change of side is an event."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vehicledyn.kernel.engine import Sides, Vector
from vehicledyn.symbolic.equations import Event


def fired(events: Sequence[Event], sides: Sides, values: Vector) -> NDArray[np.bool_]:
    """Return which events fire between a point with these sides and one with these values.

    A value of zero lies on no side: an event fires when its function reaches zero.
    """
    rising = np.array([event.direction != "falling" for event in events], dtype=bool)
    falling = np.array([event.direction != "rising" for event in events], dtype=bool)
    up: NDArray[np.bool_] = (sides < 0) & (values >= 0.0) & rising
    down: NDArray[np.bool_] = (sides > 0) & (values <= 0.0) & falling
    return up | down


def note_sides(sides: Sides, values: Vector) -> None:
    """Make the sides those of the values; where a value is zero its side stays."""
    sides[values > 0.0] = 1
    sides[values < 0.0] = -1
