"""The railway track as wheels meet it: the frame that runs along it, and where its rails lie.

The arc coordinate s is the length of the centre line seen from above (the chainage), zero at
the start of the track, where the frame is that of the world. Lengths in space are longer by
``stretch``, the secant of the gradient's angle. The centre line lies halfway between the two
running edges, at the height of their tops. The frame has x forward along the centre line, y to
the left in the plane of the rails' tops and z up (ISO 8855); it leans with the cant. Positive
curvature is a curve to the left; positive cant raises the right rail, as a curve to the left
wants it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, Protocol

from vehicledyn.rail.profiles.profile_reading import AS_IT_IS, ProfileReading
from vehicledyn.symbolic import frames, labels, ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

Side = Literal["left", "right"]


@dataclass(frozen=True)
class TrackFrame:
    """The frame of the track at one arc coordinate.

    Parameters
    ----------
    position
        Point of the centre line, world axes [m].
    rotation
        R with v_world = R v_track.
    stretch
        Length of the centre line in space a unit of s, never less than one [1].
    turning
        How the frame turns a unit of s, in its own axes: twist, vertical curvature (positive
        with the nose going down) and curvature to the left [rad/m].
    """

    position: Vec
    rotation: Mat
    stretch: Scalar
    turning: Vec

    def __post_init__(self) -> None:
        """Label place and rotation with their axes, see :mod:`vehicledyn.symbolic.frames`."""
        place = labels.in_axes(self.position, frames.WORLD)
        rotation = labels.turning(self.rotation, to=frames.WORLD, of="the track")
        object.__setattr__(self, "position", place)
        object.__setattr__(self, "rotation", rotation)

    @property
    def curvature(self) -> Scalar:
        """Curvature in the plane of the rails, positive to the left [1/m]."""
        return self.turning[2]

    def place(self, position: Vec) -> Vec:
        """Return a point given in world axes in those of the track, from the centre line [m]."""
        return self.rotation.T @ (position - self.position)

    def length(self, y: Scalar) -> Scalar:
        """Return the length of a rail a unit of s, at y to the left in their plane [1]."""
        return self.stretch - self.curvature * y

    def advance(self, place: Vec) -> Scalar:
        """Return how far a point moves ahead a unit of s, while it moves with the frame [1].

        d/ds of the point's x is stretch + Ω_y z - Ω_z y: in a curve the inner side is shorter.

        Parameters
        ----------
        place
            The point in the axes of the track, from the centre line, shape (3, 1) [m].
        """
        return self.stretch + self.turning[1] * place[2] - self.turning[2] * place[1]


class CentreLine(Protocol):
    """Where the centre line runs and how the track leans, as expressions of s."""

    @property
    def is_straight(self) -> bool:
        """Whether it is straight and level, and the frame that of the world but for x."""

    @property
    def length(self) -> float:
        """Chainage beyond which it does not change; it begins at zero [m]."""

    @property
    def tightest(self) -> float:
        """Largest curvature to either side [1/m]."""

    def frame(self, s: Scalar) -> TrackFrame:
        """Return the frame at an arc coordinate [m]."""

    def curvature(self, s: Scalar) -> Scalar:
        """Return the curvature seen from above, positive to the left [1/m]."""

    def riding(self, s: Scalar) -> tuple[Scalar, ...]:
        """Return x, y, z [m], yaw, pitch and roll [rad] of a frame with smooth accelerations.

        It follows that of the track, R = Rz Ry Rx, and rounds its kinks.
        """


class RailShift(Protocol):
    """Displacement of rails from their design places, as expressions of s."""

    @property
    def ends(self) -> tuple[float, float]:
        """Chainages before which and beyond which it does not change [m]."""

    def at(self, side: Side, s: Scalar) -> tuple[Scalar, Scalar]:
        """Return how far a rail is shifted to the left and upwards [m]."""


@dataclass(frozen=True)
class StraightLine:
    """A centre line that is straight and level for ever."""

    is_straight: bool = True
    length: float = 0.0
    tightest: float = 0.0

    def frame(self, s: Scalar) -> TrackFrame:
        """Return the frame of the world, moved along x."""
        nothing = ops.vector(0.0, 0.0, 0.0)
        return TrackFrame(ops.vector(s, 0.0, 0.0), rotations.identity(), 1.0, nothing)

    def curvature(self, s: Scalar) -> Scalar:
        """Return zero [1/m]."""
        return 0.0

    def riding(self, s: Scalar) -> tuple[Scalar, ...]:
        """Return the coordinates of the frame of the world, moved along x."""
        return s, 0.0, 0.0, 0.0, 0.0, 0.0


@dataclass(frozen=True)
class Track:
    """A railway track.

    Parameters
    ----------
    gauge
        Design distance of the running edges of the rails [m].
    gauge_depth
        Depth below the tops of the rails down to which the gauge is measured [m].
    inclination
        Angle by which the rails lean inwards [rad].
    rail
        Profile of the rails, a name or a file.
    line
        The centre line.
    shifts
        Widening and irregularities, which add up.
    base
        Distance of the rail heads, across which cant is a difference of heights [m].
    rail_reading
        How the points of a file become the rails' profile.
    inclination_text
        The inclination as it was written, such as 1/40; empty where it was not.
    """

    gauge: float
    gauge_depth: float
    inclination: float
    rail: str
    line: CentreLine = StraightLine()
    shifts: tuple[RailShift, ...] = ()
    base: float = 1.5
    rail_reading: ProfileReading = AS_IT_IS
    inclination_text: str = field(default="", compare=False)

    @property
    def is_straight(self) -> bool:
        """Whether the centre line is straight and level; rails may have irregularities."""
        return self.line.is_straight

    @property
    def is_perfect(self) -> bool:
        """Whether the rails lie where the design has them."""
        return not self.shifts

    @property
    def ends(self) -> tuple[float, float]:
        """Chainages between which there is something to see [m]."""
        ends = [(0.0, self.line.length), *(shift.ends for shift in self.shifts)]
        return min(begin for begin, _ in ends), max(end for _, end in ends)

    def frame(self, s: Scalar) -> TrackFrame:
        """Return the frame at an arc coordinate [m]; on straight track it costs nothing."""
        return self.line.frame(s)

    def locate(self, position: Vec, guess: Scalar) -> Scalar:
        """Return the arc coordinate whose frame has a point beside it, x = 0 in its axes [m].

        One step of Newton's method from the guess: on a circle the error is κ²/3 times the cube
        of the guess's. On straight track it is the point's x, whatever the guess.

        Parameters
        ----------
        position
            The point in world axes, shape (3, 1) [m].
        guess
            An arc coordinate nearby [m].
        """
        if self.is_straight:
            return position[0]
        frame = self.frame(guess)
        place = frame.place(position)
        return guess + place[0] / frame.advance(place)

    def progress(self, frame: TrackFrame, place: Vec, velocity: Vec) -> Scalar:
        """Return the rate of the arc coordinate of a point beside the frame [m/s].

        Parameters
        ----------
        frame
            Frame at the point's arc coordinate.
        place
            The point in the axes of the frame, with x = 0, shape (3, 1) [m].
        velocity
            Its velocity in the axes of the frame, shape (3, 1) [m/s].
        """
        return velocity[0] / frame.advance(place)

    def rail_shift(self, side: Side, s: Scalar) -> tuple[Scalar, Scalar]:
        """Return how far a rail is from its design place, to the left and upwards [m]."""
        lateral: Scalar = 0.0
        vertical: Scalar = 0.0
        for shift in self.shifts:
            across, up = shift.at(side, s)
            lateral, vertical = lateral + across, vertical + up
        return lateral, vertical
