"""Roll centre and motion ratio of a wheel while a drive moves it, from velocity ratios.

Both are ratios of velocities along the drive, exact at each place. With the velocity v of the
carrier's point at the contact point, which lies y to the left of the middle plane, the *roll
centre* of an axle with the same wheel on its other side lies in the middle plane, on the line
across v through the contact point. Its height above the contact point is

    h = y v_y / v_z.

A lateral force there and at the contact points does no work on the suspension (principle of
virtual power): it rolls nothing and lifts nothing. The *motion ratio* of a spring or damper is
its compression by the travel of the wheel centre upwards,

    i = -(dl/ds) / (dz/ds).

References
----------
Milliken, Milliken (1995), Race Car Vehicle Dynamics, SAE, sections 17.2 (roll centre) and 16.2
(motion ratio, there wheel rate = spring rate times i²).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.symbolic.equations import Channel

Array = NDArray[Any]
_LENGTH = ".length"
_STILL = 1e-9
"""Share of the other velocity ratios below which a wheel does not rise."""


@dataclass(frozen=True)
class _Wheel:
    """Where a wheel's quantities lie among values and velocity ratios, None where they are zero."""

    name: str
    offset: int
    height: int
    sideways: int | None
    upwards: int


@dataclass(frozen=True)
class AxleColumns:
    """Wheels, and the lengths of springs and dampers among the channels by their names."""

    wheels: tuple[_Wheel, ...]
    lengths: tuple[tuple[str, int], ...]

    def channels(self, drive: str) -> Iterator[Channel]:
        """Yield the channels along a drive: roll centres first, motion ratios after them."""
        for wheel in self.wheels:
            words = f"Height of the roll centre above the contact point of {wheel.name}"
            yield Channel(f"roll_centre.{drive}.{wheel.name}", "m", words)
        for wheel in self.wheels:
            for name, _ in self.lengths:
                words = f"Compression of {name} by the travel of {wheel.name}"
                yield Channel(f"motion_ratio.{drive}.{wheel.name}.{name}", "1", words)

    def values(self, values: Array, ratios: Array) -> list[Any]:
        """Return the values at a place, not numbers where the drive does not lift the wheel.

        Parameters
        ----------
        values
            Channels at the place, shape (n_channels,).
        ratios
            Velocity ratios by the drive, shape (n_channels + n_speeds,).
        """
        found: list[Any] = []
        for wheel in self.wheels:
            side = 0.0 if wheel.sideways is None else ratios[wheel.sideways]
            up = ratios[wheel.upwards]
            lifts = abs(up) > _STILL * abs(side)
            found.append(values[wheel.offset] * side / up if lifts else np.nan)
        largest = float(np.nanmax(np.abs(ratios), initial=0.0))
        for wheel in self.wheels:
            travel = ratios[wheel.height]
            lifts = abs(travel) > _STILL * largest
            found += [-ratios[k] / travel if lifts else np.nan for _, k in self.lengths]
        return found


def axle_columns(
    sensors: Sequence[str], channels: Sequence[Channel], speeds: Sequence[Channel]
) -> AxleColumns:
    """Return the columns of wheel sensors that rise, and of the lengths of force elements."""
    names = [channel.name for channel in channels]
    moving = [channel.name for channel in speeds]
    wheels = []
    for sensor in sensors:
        places = [f"{sensor}.contact_y", f"{sensor}.z"]
        side, up = (f"{sensor}.contact_velocity_{axis}" for axis in "yz")
        if {*places} <= {*names} and up in moving:
            sideways = len(names) + moving.index(side) if side in moving else None
            offset, height = (names.index(place) for place in places)
            upwards = len(names) + moving.index(up)
            wheels.append(_Wheel(sensor, offset, height, sideways, upwards))
    lengths = [
        (channel.name.removesuffix(_LENGTH), k)
        for k, channel in enumerate(channels)
        if channel.unit == "m" and channel.name.endswith(_LENGTH)
    ]
    return AxleColumns(tuple(wheels), tuple(lengths) if wheels else ())
