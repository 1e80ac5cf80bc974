"""What every kind of track says in a file: gauge, inclination and profile of its rails."""

from __future__ import annotations

import math
from abc import abstractmethod
from pathlib import Path
from typing import Any

from pydantic import Field, field_validator

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.base.slopes import slope_of
from vehicledyn.rail.track import Track

STEEPEST_INCLINATION = 0.2
"""Inclination of rails beyond which it is taken for a mistake, such as one in degrees [1]."""


class TrackSet(ParameterSet):
    """Base of the kinds of track."""

    gauge: float = quantity("m", "Distance of the running edges of the rails", gt=0.3, lt=3.0)
    gauge_depth: float = quantity(
        "m", "Depth below the tops of the rails where it is measured", default=0.014, gt=0.0, lt=0.1
    )
    inclination: float = quantity(
        "1",
        "Slope by which the rails lean inwards, such as 1/40",
        ge=0.0,
        le=STEEPEST_INCLINATION,
    )
    rail: str = Field(description="Profile of the rails: a name such as 60E1, or a file")

    @field_validator("inclination", mode="before")
    @classmethod
    def _read_slope(cls, value: Any) -> Any:
        slope = slope_of(value) if isinstance(value, str) else None
        return value if slope is None else slope

    @abstractmethod
    def track(self, folder: Path) -> Track:
        """Return the track; files are looked for in a folder.

        Raises
        ------
        InputError
            If a file cannot be read or holds no track.
        """

    def lean(self) -> float:
        """Return the angle by which the rails lean inwards [rad]."""
        return math.atan(self.inclination)

    def rail_name(self, folder: Path) -> str:
        """Return the name of the rails' profile, or the path of its file."""
        from vehicledyn.rail.profile_names import is_name

        beside = folder / self.rail
        return str(beside) if not is_name(self.rail) and beside.is_file() else self.rail
