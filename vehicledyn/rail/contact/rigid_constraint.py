"""Constraints of rigid contact: a wheel touches its rail, and where on the track it is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vehicledyn.multibody.model.constraints import BaseConstraint, Geometry
from vehicledyn.multibody.model.cuts import Residual
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.rail.contact.rigid_touch import RigidTouch, TouchingWheel, touch_at
from vehicledyn.rail.track.running import rail_place
from vehicledyn.rail.track.track import Side, Track, TrackFrame
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

FORCE = "vertical_force"
"""Channel of the multiplier of a gap, the part of the normal force out of the track's plane."""

_PARTS, _REFINEMENTS = 8, 2
"""Parts into which the distance of places is divided to look for a finer one, and how often."""

_TANGENT_STEPS = 2
_TANGENT_REACH = 5e-4


@dataclass(frozen=True)
class OnTrack:
    """A body with an axle that moves along a track.

    ``position`` names the coordinate that is its arc coordinate, on straight track not needed.
    """

    body: str
    track: Track
    position: str

    def arc(self, kinematics: Kinematics) -> Scalar:
        """Return the arc coordinate [m]."""
        if self.track.is_straight:
            return kinematics.position(self.body)[0]
        return kinematics.coordinate(self.position)

    def frame(self, kinematics: Kinematics) -> TrackFrame:
        """Return the frame of the track beside the body."""
        return self.track.frame(self.arc(kinematics))

    def axle(self, kinematics: Kinematics) -> Vec:
        """Return the unit axis of the axle, world axes."""
        return kinematics.rotation(self.body)[:, 1]

    def place(self, kinematics: Kinematics) -> Vec:
        """Return the place of the body's origin in the axes of the track [m]."""
        return self.frame(kinematics).place(kinematics.position(self.body))

    def speed(self, kinematics: Kinematics, y: Scalar | None = None) -> Scalar:
        """Return the rate of the arc coordinate, or how fast a place beside the track moves [m/s].

        ``y`` is the place, from the middle of the track to the left [m].
        """
        frame = self.frame(kinematics)
        velocity = frame.rotation.T @ kinematics.velocity(self.body)
        rate = self.track.progress(frame, self.place(kinematics), velocity)
        return rate if y is None else rate * frame.length(y)


@dataclass(frozen=True)
class PositionConstraint(BaseConstraint):
    """The track's frame at the arc coordinate of a body has the body beside it."""

    carrier: OnTrack

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return how far the body is ahead of the frame [m]; no force acts on the coordinate."""
        ahead = self.carrier.place(geometry.kinematics)[0]
        return [Residual(ahead, "m", "", "N", "No force acts on an arc coordinate")]


@dataclass(frozen=True)
class TouchConstraint(BaseConstraint):
    """Wheel and rail touch: gap and tangency vanish, by the contact coordinate ``contact``.

    ``others`` are places on the wheel, close to each other, where it may touch as well; the
    contact is looked for at that of the lowest gap. There are none where the contact is unique.
    """

    carrier: OnTrack
    wheel: TouchingWheel
    side: Side
    contact: str
    others: tuple[float, ...] = ()

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return gap [m] and tangency [1]; no force acts on the contact coordinate."""
        touch = self.touch(geometry.kinematics)
        text = "Part of the normal force square to the plane of the track"
        return [
            Residual(touch.gap, "m", FORCE, "N", text),
            Residual(touch.tangency, "1", "", "N", "No force acts on a contact coordinate"),
        ]

    def guesses(self, geometry: Geometry) -> dict[str, Scalar]:
        """Return the place of the lowest gap, finer than those of the others.

        Beside a place where a second tangency appears the way to the contact may be closed to
        Newton's steps, from as near as a hundredth of a millimetre.
        """
        if not self.others:
            return {}
        place = self.lowest(geometry.kinematics)[1]
        distance = self.others[1] - self.others[0]
        for _ in range(_REFINEMENTS):
            distance /= _PARTS
            beside = [place + k * distance for k in range(-_PARTS, _PARTS + 1)]
            place = self._lowest_of(geometry.kinematics, beside)[1]
        return {self.contact: place}

    def lowest(self, kinematics: Kinematics) -> tuple[Scalar, Scalar]:
        """Return the lowest gap of the places where the wheel may touch, and its place [m, m]."""
        return self._lowest_of(kinematics, self.others)

    def _lowest_of(self, kinematics: Kinematics, places: Sequence[Scalar]) -> tuple[Scalar, Scalar]:
        anywhere = ops.symbol("place")
        gap_of = ops.scalar(self.touch(kinematics, anywhere).gap)
        lowest: Scalar = np.inf
        place = places[0]
        for other in places:
            gap = ops.substitute(gap_of, anywhere, ops.scalar(other))
            place = ops.where(gap < lowest, other, place)
            lowest = ops.minimum(gap, lowest)
        return lowest, place

    def landing(self, kinematics: Kinematics) -> Scalar:
        """Return the place of the lowest gap, tangential to the rail [m]."""
        place, other = self.lowest(kinematics)[1], ops.symbol("place")
        tangency = ops.scalar(self.touch(kinematics, other).tangency)
        step = tangency / ops.derivative(tangency, other, 1.0)
        for _ in range(_TANGENT_STEPS):
            moved = ops.substitute(step, other, ops.scalar(place))
            place = place - ops.minimum(ops.maximum(moved, -_TANGENT_REACH), _TANGENT_REACH)
        return place

    def touch(self, kinematics: Kinematics, place: Scalar | None = None) -> RigidTouch:
        """Return a point of the wheel that may touch, in the axes of the track.

        It is that at the contact coordinate, or at another place on the wheel [m].
        """
        carrier = self.carrier
        frame, beside = carrier.frame(kinematics), carrier.place(kinematics)
        rail = rail_place(carrier.track, self.side, carrier.arc(kinematics))
        across = beside[1] + self.wheel.side * self.wheel.half_distance
        length = frame.length(across)
        climb = rail.vertical_slope + frame.turning[0] * across
        return touch_at(
            self.wheel,
            beside,
            frame.rotation.T @ carrier.axle(kinematics),
            kinematics.coordinate(self.contact) if place is None else place,
            curvature=frame.curvature,
            shift=(rail.lateral, rail.vertical),
            slopes=(rail.lateral_slope / length, climb / length),
        )
