"""A frame that follows a track as a function of time, for vehicles described relative to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.multibody.model.parts import BasePart, Clock, DrivenMotion, Loads, Output, Situation
from vehicledyn.rail.track.track import Track
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar

JOINTS = ("T1", "T2", "T3", "R3", "R2", "R1")
"""The chain of joints that carries the frame: x, y, z, yaw, pitch and roll."""


@dataclass(frozen=True)
class TrackFollower(BasePart):
    """Drive the six coordinates of a frame along the centre line of a track.

    Rates and accelerations follow by differentiation. The frame rounds the kinks of the design,
    so that what is described relative to it feels no impulse that it should not.

    Parameters
    ----------
    coordinates
        Names of the frame's coordinates, in the order of :data:`JOINTS`.
    body
        Body that the chain carries; its name begins those of the channels.
    track
        The track.
    law
        Arc coordinate [m] as a function of time [s].
    """

    coordinates: tuple[str, ...]
    body: str
    track: Track
    law: Callable[[Scalar], Scalar]

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return place and orientation of the frame and their rates."""
        place = self._place(clock.time)
        return {
            name: DrivenMotion(place[k], ops.derivative(place[k], clock.time, 1.0))
            for k, name in enumerate(self.coordinates)
        }

    def loads(self, situation: Situation) -> Loads:
        """Return the accelerations of the six coordinates."""
        time, place = situation.time, self._place(situation.time)
        rates = [ops.derivative(item, time, 1.0) for item in place]
        accelerations = [ops.derivative(rate, time, 1.0) for rate in rates]
        return Loads(accelerations=dict(zip(self.coordinates, accelerations, strict=True)))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return where the frame is on the track and how that bends there."""
        s = ops.scalar(self.law(situation.time))
        rate = ops.derivative(s, situation.time, 1.0)
        of = f"of the track frame of {self.body}"
        channels = [
            (Channel(f"{self.name}.position", "m", f"Arc coordinate {of}"), s),
            (Channel(f"{self.name}.speed", "m/s", f"Rate of the arc coordinate {of}"), rate),
        ]
        if not self.track.is_straight:
            bend = self.track.line.curvature(s)
            words = f"Curvature of the track, seen from above, at the track frame of {self.body}"
            channels.append((Channel(f"{self.name}.curvature", "1/m", words), bend))
        return tuple(Output(channel, value) for channel, value in channels)

    def _place(self, time: Scalar) -> list[Scalar]:
        s = ops.scalar(self.law(time))
        return [ops.scalar(value) for value in self.track.line.riding(s)]
