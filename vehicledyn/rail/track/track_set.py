"""What every kind of track says in a file: gauge, inclination and profile of its rails."""

from __future__ import annotations

import math
from abc import abstractmethod
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from pydantic import Field, ModelWrapValidatorHandler, PrivateAttr, field_validator, model_validator

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import ParameterSet, part, quantity
from vehicledyn.base.problems import is_count
from vehicledyn.base.slope_text import slope_of
from vehicledyn.rail.profiles.profile_checks import file_problems
from vehicledyn.rail.profiles.profile_names import STANDARD, is_name
from vehicledyn.rail.profiles.profile_reading import AS_IT_IS, ProfileReading
from vehicledyn.rail.track.track import CentreLine, RailShift, Track

if TYPE_CHECKING:
    from vehicledyn.rail.profiles.profile import Profile
    from vehicledyn.rail.track.alignment import Alignment

HEAD_WIDTH = 0.065
"""Width of a rail's head, which gives 1500 mm on standard gauge (EN 13803) [m]."""

STEEPEST_INCLINATION = 0.2
"""Inclination of rails beyond which it is taken for a mistake, such as one in degrees [1]."""


class TrackChoice(ParameterSet):
    """Base of all kinds of track; ``names_files`` says whether it rests on further files."""

    names_files: ClassVar[bool] = False

    in_equations: ClassVar[bool] = True

    @abstractmethod
    def track(self, folder: Path) -> Track:
        """Return the track; files are looked for in a folder.

        Raises
        ------
        InputError
            If a file cannot be read or holds no track.
        """

    def problems_beside(self, folder: Path) -> list[str]:
        """Return what is wrong with the files that it names, one line each."""
        rough = getattr(self, "irregularities", None)
        if not self.names_files and not getattr(rough, "names_files", False):
            return self.rail_problems(folder)
        try:
            track = self.track(folder)
        except InputError as error:
            lines = str(error).splitlines()
            wrong = [line for line in lines if not is_count(line)]
            return wrong + self.rail_problems(folder)
        found = file_problems(track.rail, "rail", track.rail_reading)
        return [f"rail: {line}" for line in found]

    def rail_problems(self, folder: Path) -> list[str]:
        """Return what is wrong with the profile of its rails, one line each."""
        return []

    @abstractmethod
    def rail_profile(self, folder: Path) -> Profile:
        """Return the profile of its rails; files are looked for in a folder.

        Raises
        ------
        InputError
            If there is no such profile.
        """


class TrackSet(TrackChoice):
    """Base of the kinds of track that say what rails they have."""

    gauge: float = quantity("m", "Distance of the running edges of the rails", gt=0.2, lt=3.0)
    gauge_depth: float = quantity(
        "m", "Depth below the tops of the rails where it is measured", default=0.014, gt=0.0, lt=0.1
    )
    inclination: float = quantity(
        "1",
        "Slope by which the rails lean inwards, such as 1/40",
        ge=0.0,
        le=STEEPEST_INCLINATION,
    )
    rail: str = Field(
        description="Profile of the rails: a name such as 60E1, or a file",
        json_schema_extra={"type": ["string", "number"]},  # YAML takes 60E1 for a number
    )
    rail_reading: ProfileReading = Field(
        default=AS_IT_IS, description="How the points of a file become the rails' profile"
    )
    cant_base: float | None = quantity(
        "m",
        "Distance over which cant is measured; gauge and 65 mm if left out",
        default=None,
        gt=0.3,
        lt=3.5,
    )
    irregularities: ParameterSet | None = part(
        "irregularity", "How the rails deviate from their design", default=None
    )

    _inclination_text: str = PrivateAttr(default="")

    @model_validator(mode="wrap")
    @classmethod
    def _keep_written_slope(cls, data: Any, handler: ModelWrapValidatorHandler[Any]) -> Any:
        found = handler(data)
        if isinstance(data, dict):
            found._inclination_text = str(data.get("inclination", "")).strip()
        return found

    @field_validator("inclination", mode="before")
    @classmethod
    def _read_slope(cls, value: Any) -> Any:
        slope = slope_of(value) if isinstance(value, str) else None
        return value if slope is None else slope

    @property
    def base(self) -> float:
        """Distance of the rail heads across which cant is measured [m]."""
        return self.gauge + HEAD_WIDTH if self.cant_base is None else self.cant_base

    @field_validator("rail", mode="before")
    @classmethod
    def _read_name(cls, value: Any) -> Any:
        """Return the name that YAML takes for a number, such as 60E1."""
        if not isinstance(value, float):
            return value
        return next((name for name in STANDARD if _number(name) == value), value)

    def rail_problems(self, folder: Path) -> list[str]:
        """Return what is wrong with the profile of its rails, one line each."""
        found = file_problems(self._rail(folder), "rail", self.rail_reading)
        return [f"rail: {line}" for line in found]

    def rail_profile(self, folder: Path) -> Profile:
        """Return the profile of its rails."""
        from vehicledyn.rail.profiles.open_profile import open_profile

        return open_profile(self._rail(folder), "rail", self.rail_reading)

    def _rail(self, folder: Path) -> str:
        """Return the name of the rails' profile, of a file with its folder."""
        is_file = not is_name(self.rail) and bool(Path(self.rail).suffix)
        beside = folder / self.rail
        return (
            str(beside) if is_file or (beside.is_file() and not is_name(self.rail)) else self.rail
        )

    def on(self, folder: Path, line: CentreLine, *shifts: RailShift) -> Track:
        """Return the track of these rails along a centre line, with its irregularities.

        Parameters
        ----------
        folder
            Where files are looked for.
        line, shifts
            Centre line, and displacements that belong to the design.
        """
        rail = self._rail(folder)
        rough = self.irregularities
        if isinstance(rough, IrregularitySet):
            shifts = (*shifts, rough.shift(folder))
        lean = math.atan(self.inclination)
        reading = self.rail_reading
        return Track(
            self.gauge,
            self.gauge_depth,
            lean,
            rail,
            line,
            shifts,
            self.base,
            reading,
            inclination_text=self._inclination_text,
        )


class IrregularitySet(ParameterSet):
    """Base of the kinds of irregularities; ``names_files`` as with tracks."""

    names_files: ClassVar[bool] = False

    @abstractmethod
    def shift(self, folder: Path) -> RailShift:
        """Return the displacement of the rails; files are looked for in a folder.

        Raises
        ------
        InputError
            If a file cannot be read.
        """


class DesignedTrack(TrackSet):
    """Base of the tracks with a designed alignment."""

    cant_about: Literal["centre_line", "low_rail"] = Field(
        default="centre_line", description="Line about which cant turns the track"
    )

    @abstractmethod
    def alignment(self, folder: Path) -> Alignment:
        """Return the design; files are looked for in a folder."""

    def track(self, folder: Path) -> Track:
        """Return the track."""
        from vehicledyn.rail.track.track_tables import centre_line

        line, widening = centre_line(self.alignment(folder))
        return self.on(folder, line, *([widening] if widening else []))


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
