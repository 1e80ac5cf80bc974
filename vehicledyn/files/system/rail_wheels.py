"""The section of wheels on rails in system files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import Field, field_validator

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.files.expressions.fields import Scalar, SystemSet, measured, reference
from vehicledyn.rail.profiles.profile_checks import file_problems
from vehicledyn.rail.profiles.profile_names import check_name, is_name
from vehicledyn.rail.profiles.profile_reading import AS_IT_IS, ProfileReading

if TYPE_CHECKING:
    from vehicledyn.rail.profiles.profile import Profile

_BOTH = ("left", "right")
_WIDEST_HEAD = 0.08


class RailWheelSet(SystemSet):
    """The equal wheels of one body on the track: one independent wheel or a wheelset."""

    body: str = reference("body", "Its body: origin on the axle, y along the axle to the left")
    wheels: tuple[Literal["left", "right"], ...] = Field(
        description="Sides of the track on which it has a wheel"
    )
    radius: Scalar = measured("m", "Rolling radius of the tape circle", above=0.0)
    tape_circle: Scalar = measured(
        "m", "Distance of the tape circle from the body's origin along the axle, outwards"
    )
    profile: str = Field(description="Profile of the wheels: a name such as S1002, or a file")
    profile_reading: ProfileReading = Field(
        default=AS_IT_IS, description="How the points of a file become the wheels' profile"
    )

    @field_validator("wheels")
    @classmethod
    def _one_or_both(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        if not value or len(set(value)) < len(value):
            raise ValueError("name one side or both, such as [left, right]")
        return value

    @field_validator("profile")
    @classmethod
    def _known_profile(cls, value: str) -> str:
        if is_name(value) or not Path(value).suffix:
            try:
                check_name(value, "wheel")
            except InputError as error:
                raise ValueError(str(error)) from None
        return value

    def check_gauge(self, tape_circle: float, gauge: float) -> None:
        """Refuse a wheelset whose wheels would not stand on the rails.

        Parameters
        ----------
        tape_circle
            Distance of the tape circles from the middle of the axle [m].
        gauge
            Gauge of the track [m].

        Raises
        ------
        InputError
            If the tape circles are not over the heads of the rails.
        """
        beside = tape_circle - 0.5 * gauge
        if len(self.wheels) == len(_BOTH) and not 0.0 < beside < _WIDEST_HEAD:
            raise InputError(
                f"the gauge does not fit: tape circles {2e3 * tape_circle:g} mm apart are "
                f"{1e3 * beside:g} mm outside the running edges of rails {1e3 * gauge:g} mm apart; "
                f"0 to {1e3 * _WIDEST_HEAD:g} mm carry a wheel"
            )

    def problems_beside(self, folder: Path) -> list[str]:
        """Return what is wrong with the file of its profile, one line each."""
        found = file_problems(self._text(folder), "wheel", self.profile_reading)
        return [f"profile: {line}" for line in found]

    def open(self, folder: Path) -> Profile:
        """Return the profile; files are looked for in a folder.

        Raises
        ------
        InputError
            If the file cannot be read or holds no profile.
        """
        from vehicledyn.rail.profiles.open_profile import open_profile

        return open_profile(self._text(folder), "wheel", self.profile_reading)

    def seen_from(self, way: str) -> RailWheelSet:
        """Return the wheels with the file of their profile at the end of a way to its folder."""
        return self.model_copy(update={"profile": self._text(Path(way))})

    def _text(self, folder: Path) -> str:
        """Return the name of the profile, of a file with its folder."""
        is_file = not is_name(self.profile) and bool(Path(self.profile).suffix)
        return str(folder / self.profile) if is_file else self.profile


def missing_choices(creep: ParameterSet | None, contact: ParameterSet | None) -> list[str]:
    """Return what wheels on rails lack of a creep law and a model of contact."""
    wanted = {
        "creep": (creep, "give it a creep law, such as 'kind: polach'"),
        "rail_contact": (contact, "give it a model of contact, such as 'kind: elastic'"),
    }
    words = "missing: the system runs on rails,"
    return [f"{key}: {words} {hint}" for key, (value, hint) in wanted.items() if value is None]
