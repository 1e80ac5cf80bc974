"""What a model of wheel and rail in contact is: it makes the part that carries a body on rails."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.multibody.model.parts import Part
from vehicledyn.rail.creep.creep_law import CreepLaw
from vehicledyn.rail.track.track import Side, Track
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.parameters import ParameterTable

if TYPE_CHECKING:
    from vehicledyn.rail.geometry.contact_geometry import MountedWheel, Rail
    from vehicledyn.rail.profiles.profile import Profile


@dataclass(frozen=True)
class RailWheels:
    """The wheels that one body has on a track, equal to each other.

    Attributes
    ----------
    name
        Name of the part.
    body
        The body: origin on its axle, y axis along it, to the left.
    sides
        Sides on which it has a wheel.
    profile
        Profile of the wheels.
    radius, tape_circle
        Rolling radius of the tape circle and its distance from the body's origin along the axle,
        numbers or symbols [m].
    radius_number
        The radius as a number [m].
    track
        The track under the wheels.
    creep
        Creep law; its parameters may be symbols.
    guide
        Arc coordinate near the body as a function of time [m], where the motion of its carrier
        gives it.
    first_place
        Arc coordinate at the start where nothing gives it, on a track that is straight up to
        there [m].
    nearest
        Distance of the nearest other axle of the vehicle along the track, zero where there is
        none [m].
    nominal
        Lateral place of the body's origin from which its shift counts, to the left [m].
    """

    name: str
    body: str
    sides: tuple[Side, ...]
    profile: Profile
    radius: Scalar
    tape_circle: Scalar
    radius_number: float
    track: Track
    creep: CreepLaw
    guide: Callable[[Scalar], Scalar] | None = None
    first_place: float = 0.0
    nearest: float = 0.0
    nominal: Scalar = 0.0

    @property
    def finds_its_place(self) -> bool:
        """Whether its place along the track is known but for one step of Newton's method."""
        return self.track.is_straight or self.guide is not None

    def check_fit(self, tape_circle: float) -> None:
        """Refuse a wheelset that does not stand on its treads in the middle of the track.

        Parameters
        ----------
        tape_circle
            Distance of the tape circles from the middle of the axle [m].

        Raises
        ------
        InputError
            If its flanges are on the rails there, or a wheel not on its rail.
        """
        from vehicledyn.rail.geometry.contact_geometry import MountedWheel
        from vehicledyn.rail.geometry.gauge_fit import check_fit
        from vehicledyn.rail.geometry.wheelset_geometry import WheelsetOnTrack

        if len(self.sides) == 1:
            return
        wheel = MountedWheel(self.profile, self.radius_number, tape_circle)
        rail = self.geometry()[1]
        check_fit(WheelsetOnTrack(wheel, wheel, rail, rail), self.track.gauge)

    def geometry(self) -> tuple[MountedWheel, Rail]:
        """Return wheel and rail as numbers, the tape circle over the rail's axis.

        Raises
        ------
        InputError
            If there is no such profile of a rail.
        """
        from vehicledyn.rail.geometry.contact_geometry import MountedWheel, place_rail
        from vehicledyn.rail.profiles.open_profile import open_profile

        track = self.track
        profile = open_profile(track.rail, "rail", track.rail_reading)
        rail = place_rail(profile, track.inclination, track.gauge, track.gauge_depth)
        return MountedWheel(self.profile, self.radius_number, rail.origin[0]), rail


class RailContact(ParameterSet):
    """A model of contact; every one of the catalogue derives from it."""

    @abstractmethod
    def entered(self, table: ParameterTable) -> RailContact:
        """Return the model with the symbols that its quantities are in the equations."""

    @abstractmethod
    def part(self, wheels: RailWheels) -> Part:
        """Return the part that carries a body on its rails.

        Raises
        ------
        InputError
            If wheel and rail do not fit.
        """
