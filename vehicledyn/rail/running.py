"""How a body runs along its track: place, axle and velocities in the axes of the track."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.parts import Situation
from vehicledyn.rail.track import Side, Track, TrackFrame
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

TRACK_POSITION = "track_position"
"""Name of the state that holds the arc coordinate where the track is curved."""


@dataclass(frozen=True)
class Running:
    """Motion of a body beside its track, all vectors in the axes of the track.

    Attributes
    ----------
    position
        Arc coordinate s of the track beside the body [m].
    rate
        Its rate [m/s].
    frame
        Frame of the track there.
    place
        The body's origin from the centre line; its x is zero [m].
    axle
        Unit vector along the y axis of the body.
    velocity, angular_velocity
        Of the body's origin and of the body [m/s, rad/s].
    shifts
        Displacement of the rails, to the left and upwards, and their rates with s, by side.
    """

    position: Scalar
    rate: Scalar
    frame: TrackFrame
    place: Vec
    axle: Vec
    velocity: Vec
    angular_velocity: Vec
    shifts: dict[Side, RailPlace]

    def seen_from(self, side: Side) -> Seen:
        """Return the motion in axes seen from one side: y points outwards to its field side."""
        return Seen(self, side, -1.0 if side == "right" else 1.0)


@dataclass(frozen=True)
class RailPlace:
    """Displacement of a rail, to the left and upwards [m], and its change a unit of s [1]."""

    lateral: Scalar
    vertical: Scalar
    lateral_slope: Scalar = 0.0
    vertical_slope: Scalar = 0.0


@dataclass(frozen=True)
class Seen:
    """A motion seen from one side of the track; for the right side it is the mirror image."""

    running: Running
    side: Side
    sign: float

    @property
    def lateral(self) -> Scalar:
        """Place of the body's origin outwards from the rail's design place [m]."""
        return self.sign * (self.running.place[1] - self.running.shifts[self.side].lateral)

    @property
    def height(self) -> Scalar:
        """Height of the body's origin over the rail's [m]."""
        return self.running.place[2] - self.running.shifts[self.side].vertical

    @property
    def axle(self) -> tuple[Scalar, Scalar, Scalar]:
        """Unit vector along the axle, outwards."""
        axle = self.running.axle
        return self.sign * axle[0], axle[1], self.sign * axle[2]

    @property
    def curvature(self) -> Scalar:
        """Curvature of the track, positive when it bends to this side [1/m]."""
        bend = self.running.frame.curvature
        return 0.0 if ops.is_structurally_zero(ops.scalar(bend)) else self.sign * bend

    @property
    def velocity(self) -> Vec:
        """Velocity of the body's origin [m/s]."""
        return self.polar(self.running.velocity)

    @property
    def angular_velocity(self) -> Vec:
        """Angular velocity of the body [rad/s]."""
        return self.axial(self.running.angular_velocity)

    def speed_at(self, y: Scalar) -> Scalar:
        """Return the speed at which a contact travels at a lateral place [m/s]."""
        frame = self.running.frame
        return self.running.rate * (frame.stretch - self.curvature * y)

    def rail_rate(self) -> tuple[Scalar, Scalar]:
        """Return how fast the rail under the wheel moves outwards and up as it runs on [m/s]."""
        rail, rate = self.running.shifts[self.side], self.running.rate
        return self.sign * rate * rail.lateral_slope, rate * rail.vertical_slope

    def polar(self, vector: Vec) -> Vec:
        """Return a place, velocity or force turned into the other axes; it is its own inverse."""
        return ops.vector(vector[0], self.sign * vector[1], vector[2])

    def axial(self, vector: Vec) -> Vec:
        """Return an angular velocity or torque turned into the other axes, its own inverse."""
        return ops.vector(self.sign * vector[0], vector[1], self.sign * vector[2])


def running(situation: Situation, body: str, track: Track, sides: tuple[Side, ...]) -> Running:
    """Return how a body runs; on curved track a part's state is the guess of its place."""
    kinematics = situation.kinematics
    position, rotation = kinematics.position(body), kinematics.rotation(body)
    s = track.locate(position, situation.states.get(TRACK_POSITION, 0.0))
    frame = track.frame(s)
    to_track = frame.rotation.T
    place = frame.place(position)
    velocity = to_track @ kinematics.velocity(body)
    return Running(
        s,
        track.progress(frame, place, velocity),
        frame,
        place,
        to_track @ rotation[:, 1],
        velocity,
        to_track @ rotation @ kinematics.angular_velocity(body),
        {side: _rail_place(track, side, s) for side in sides},
    )


def _rail_place(track: Track, side: Side, s: Scalar) -> RailPlace:
    if track.is_perfect:
        return RailPlace(0.0, 0.0)
    free = ops.symbol("s")
    shift = ops.column(track.rail_shift(side, free))
    both = ops.stacked(shift, ops.jacobian(shift, free))
    found = ops.substitute(both, free, ops.scalar(s))
    return RailPlace(found[0], found[1], found[2], found[3])
