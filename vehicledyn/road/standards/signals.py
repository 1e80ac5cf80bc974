"""Signals of a driving test, in ISO 8855 axes and SI, as the standards name them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Mapping

Floats = NDArray[np.float64]


_OWN = {
    "steering": "steering_angle.angle",
    "understeer": "steering_angle.understeer_angle",
    "forward_speed": "body.forward_speed",
    "lateral_speed": "body.lateral_speed",
    "yaw_rate": "body.yaw_rate",
    "sideslip": "body.sideslip_angle",
    "longitudinal_acceleration": "accelerometer.longitudinal",
    "lateral_acceleration": "accelerometer.lateral",
}
_CHASSIS = ("x", "y", "yaw", "roll", "pitch", "roll_rate")


def signal_channels(chassis: str) -> list[str]:
    """Return the channels that the signals are read from."""
    return [*_OWN.values(), *(f"{chassis}.{name}" for name in _CHASSIS)]


@dataclass(frozen=True)
class Signals:
    """Signals by time, each of shape (n_times,).

    ``steering`` is the steering-wheel angle, ``understeer`` the angle of the front wheels beyond
    wheelbase times yaw rate over speed, both to the left [rad]; x and y are those of the
    chassis's origin in the world [m], accelerations are horizontal, along and to the left of the
    heading [m/s²].
    """

    time: Floats
    steering: Floats
    understeer: Floats
    forward_speed: Floats
    lateral_speed: Floats
    yaw_rate: Floats
    sideslip: Floats
    longitudinal_acceleration: Floats
    lateral_acceleration: Floats
    x: Floats
    y: Floats
    yaw: Floats
    roll: Floats
    pitch: Floats
    roll_rate: Floats

    @classmethod
    def of(cls, time: Floats, channels: Mapping[str, Floats], chassis: str) -> Signals:
        """Return the signals that some channels hold."""
        found = {field: channels[name][:] for field, name in _OWN.items()}
        found |= {name: channels[f"{chassis}.{name}"][:] for name in _CHASSIS}
        return cls(time=time, **found)

    @property
    def speed(self) -> Floats:
        """Horizontal speed of the chassis's origin [m/s]."""
        return np.hypot(self.forward_speed, self.lateral_speed)

    def at(self, name: str, time: float) -> float:
        """Return a signal at a time [s], linearly between samples."""
        return float(np.interp(time, self.time, getattr(self, name)))

    def between(self, first: float, last: float) -> Signals:
        """Return the samples from one time to another [s]."""
        kept = (self.time >= first - 1e-9) & (self.time <= last + 1e-9)
        values = {name: getattr(self, name)[kept] for name in self.__dataclass_fields__}
        return Signals(**values)
