"""Where a model is steered, driven and watched."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class WheelPort:
    """A wheel of a model: its name, its spin coordinate, and where it stands."""

    name: str
    spin: str
    is_front: bool
    is_left: bool


@dataclass(frozen=True)
class Ports:
    """Places of a model that analyses steer, load and watch; empty for what a model has not.

    ``body`` is the body that runs along a road, with coordinates ``<body>.x`` and so on;
    ``steering`` the driven coordinate that steers, ``steering_gain`` the angle of the road wheels
    to the left that it gives, in rad a unit; ``speed`` the symbol of the forward speed [m/s].
    """

    body: str = ""
    steering: str = ""
    steering_gain: Scalar = 1.0
    speed: Scalar | None = None
    wheels: tuple[WheelPort, ...] = ()
