"""How a body runs along its track: place, axle and velocities in the axes of the track."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.multibody.model.parts import Situation
from vehicledyn.rail.track.track import Side, Track, TrackFrame
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

TRACK_POSITION = "track_position"
"""Name of the state that holds the arc coordinate where the track is curved."""

LATERAL_SHIFT = "Place of the axle to the left of its nominal one, of a wheelset the track's middle"


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

    def seen_from(self, side: Side) -> SideMotion:
        """Return the motion in axes seen from one side: y points outwards to its field side."""
        sign = -1.0 if side == "right" else 1.0
        rail, bend = self.shifts[side], self.frame.curvature
        return SideMotion(
            sign,
            sign * (self.place[1] - rail.lateral),
            self.place[2] - rail.vertical,
            (sign * self.axle[0], self.axle[1], sign * self.axle[2]),
            polar(sign, self.velocity),
            axial(sign, self.angular_velocity),
            0.0 if ops.is_structurally_zero(ops.scalar(bend)) else sign * bend,
            self.rate,
            self.frame.stretch,
            (sign * rail.lateral_slope, rail.vertical_slope),
            sign * self.frame.turning[0],
        )


@dataclass(frozen=True)
class RailPlace:
    """Displacement of a rail, to the left and upwards [m], and its change a unit of s [1]."""

    lateral: Scalar
    vertical: Scalar
    lateral_slope: Scalar = 0.0
    vertical_slope: Scalar = 0.0


@dataclass(frozen=True)
class SideMotion:
    """A motion seen from one side of the track; for the right side it is the mirror image.

    Attributes
    ----------
    sign
        -1 for the right side, 1 for the left.
    lateral, height
        Place of the body's origin outwards from the rail's design place, and over the rail's [m].
    axle
        Unit vector along the axle, outwards.
    velocity, angular_velocity
        Of the body's origin and of the body [m/s, rad/s].
    curvature
        Curvature of the track, positive when it bends to this side [1/m].
    rate, stretch
        Rate of the arc coordinate [m/s] and length in space a unit of it [1].
    rail_slopes
        How far the rail, displaced from its design place, runs outwards and up a unit of s [1].
    twist
        How far the design place of a rail runs up a unit of s and a unit of its lateral place
        [1/m].
    """

    sign: float
    lateral: Scalar
    height: Scalar
    axle: tuple[Scalar, Scalar, Scalar]
    velocity: Vec
    angular_velocity: Vec
    curvature: Scalar
    rate: Scalar
    stretch: Scalar
    rail_slopes: tuple[Scalar, Scalar]
    twist: Scalar

    @property
    def numbers(self) -> list[Scalar]:
        """All that the motion is but the sign, one by one."""
        velocity, spin = ([v[k] for k in range(3)] for v in (self.velocity, self.angular_velocity))
        way = (self.curvature, self.rate, self.stretch)
        rail = (*self.rail_slopes, self.twist)
        return [self.lateral, self.height, *self.axle, *velocity, *spin, *way, *rail]

    @staticmethod
    def of(numbers: Sequence[Scalar], sign: float) -> SideMotion:
        """Return the motion of these numbers."""
        lateral, height, ex, ey, ez, *others = numbers
        velocity, spin = ops.vector(*others[:3]), ops.vector(*others[3:6])
        curvature, rate, stretch, outwards, upwards, twist = others[6:]
        axle, rail = (ex, ey, ez), (outwards, upwards)
        return SideMotion(
            sign, lateral, height, axle, velocity, spin, curvature, rate, stretch, rail, twist
        )  # fmt: skip

    def speed_at(self, y: Scalar) -> Scalar:
        """Return the speed at which a contact travels at a lateral place [m/s]."""
        return self.rate * (self.stretch - self.curvature * y)

    def slopes_at(self, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return how far the rail runs outwards and up a unit of its length, at a place [1]."""
        length = self.stretch - self.curvature * y
        outwards, upwards = self.rail_slopes
        return outwards / length, (upwards + self.twist * y) / length

    def polar(self, vector: Vec) -> Vec:
        """Return a place, velocity or force turned into the other axes; it is its own inverse."""
        return polar(self.sign, vector)

    def axial(self, vector: Vec) -> Vec:
        """Return an angular velocity or torque turned into the other axes, its own inverse."""
        return axial(self.sign, vector)


def polar(sign: Scalar, vector: Vec) -> Vec:
    """Return a place, velocity or force in the mirror where the sign is -1."""
    return ops.vector(vector[0], sign * vector[1], vector[2])


def axial(sign: Scalar, vector: Vec) -> Vec:
    """Return an angular velocity or torque in the mirror where the sign is -1."""
    return ops.vector(sign * vector[0], vector[1], sign * vector[2])


def running(
    situation: Situation, body: str, track: Track, sides: tuple[Side, ...], guess: Scalar
) -> Running:
    """Return how a body runs.

    ``guess`` is an arc coordinate nearby [m]; on straight track it does not matter.
    """
    kinematics = situation.kinematics
    position, rotation = kinematics.position(body), kinematics.rotation(body)
    s = track.locate(position, guess)
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
        {side: rail_place(track, side, s) for side in sides},
    )


def design_rows(track: Track, s: Scalar) -> list[tuple[str, str, str, Scalar]]:
    """Return name, unit, description and value of what a track that bends is at a place."""
    if track.is_straight:
        return []
    bend, cant = track.line.curvature(s), -track.base * track.frame(s).rotation[2, 1]
    return [
        ("curvature", "1/m", "Curvature of the track at the axle, seen from above", bend),
        ("cant", "m", "Height of the right rail over the left one at the axle", cant),
    ]


def sloping_rails(track: Track) -> tuple[bool, bool, bool]:
    """Return whether rails slope outwards and up from their design, and whether it is twisted."""
    twist = ops.scalar(track.frame(ops.symbol("s")).turning[0])
    return *_displaced(track), not ops.is_structurally_zero(twist)


def _displaced(track: Track) -> tuple[bool, bool]:
    if track.is_perfect:
        return False, False
    sides: tuple[Side, Side] = ("left", "right")
    places = [rail_place(track, side, ops.symbol("s")) for side in sides]
    slopes = [(place.lateral_slope, place.vertical_slope) for place in places]
    across, up = zip(*slopes, strict=True)
    return _any_slope(across), _any_slope(up)


def _any_slope(slopes: Sequence[Scalar]) -> bool:
    return not all(ops.is_structurally_zero(ops.scalar(slope)) for slope in slopes)


def rail_place(track: Track, side: Side, s: Scalar) -> RailPlace:
    """Return how a rail is displaced at an arc coordinate [m]."""
    if track.is_perfect:
        return RailPlace(0.0, 0.0)
    free = ops.symbol("s")
    shift = ops.column(track.rail_shift(side, free))
    both = ops.stacked(shift, ops.jacobian(shift, free))
    found = ops.substitute(both, free, ops.scalar(s))
    return RailPlace(found[0], found[1], found[2], found[3])
