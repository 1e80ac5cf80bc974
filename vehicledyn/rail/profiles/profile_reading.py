"""How a profile is read from a file of measured points: smoothing, defects, tape circle."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.rail.profiles.profile_points import FURTHEST_TAPE_CIRCLE, NEAREST_TAPE_CIRCLE

Defects = Literal["refuse", "mend", "keep"]


class ProfileReading(ParameterSet):
    """How the points of a file become a profile; a profile by name needs none of it.

    Outliers are points that a smooth curve through those around misses by far; gaps are stretches
    without points. ``mend`` leaves outliers out and bridges gaps by a smooth curve, ``keep``
    takes the points as they are.
    """

    smoothing: float = quantity(
        "m", "Wavelength of which smoothing leaves half; 0 for none", default=0.0, ge=0.0, le=0.1
    )
    defects: Defects = Field(
        default="refuse", description="What to do with outliers and gaps: refuse, mend or keep"
    )
    tape_circle: float | None = quantity(
        "m",
        "Distance of the tape circle from the back of the flange, for points counted from there",
        default=None,
        gt=NEAREST_TAPE_CIRCLE,
        lt=FURTHEST_TAPE_CIRCLE,
    )


AS_IT_IS = ProfileReading()
"""No smoothing; defects are refused."""
