"""Channels of inverse dynamics with the powers of the drives, their key figures and figures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.equations.inverse_dynamics import PRESCRIBED, InverseDynamics
from vehicledyn.results.store.layout import SummaryEntry
from vehicledyn.symbolic.equations import Channel

Array = NDArray[np.float64]
_LINES = 6
_SHOWN_IN = {"rad": "deg", "rad/s": "deg/s"}


@dataclass(frozen=True)
class DriveFigure:
    """A key figure: the largest magnitude of a channel, or its integral over time."""

    name: str
    unit: str
    description: str
    channel: str
    is_integral: bool = False


@dataclass(frozen=True)
class DriveColumns:
    """Channels of the result: those of the equations and the power of each drive."""

    channels: tuple[Channel, ...]
    kept: tuple[int, ...]
    forces: tuple[tuple[int, int], ...]
    coordinates: tuple[str, ...]

    @classmethod
    def of(cls, inverse: InverseDynamics) -> DriveColumns:
        """Return the channels; states of the prescribed motion are left out."""
        everything = inverse.equations.channels
        kept = tuple(k for k, c in enumerate(everything) if not c.name.startswith(PRESCRIBED))
        own = [everything[k] for k in kept]
        index = {c.name: k for k, c in enumerate(own)}
        driven = inverse.equations.structure["driven"]
        pairs = {
            n: (index[f"{n}_force"], index[f"{n}_rate"]) for n in driven if f"{n}_force" in index
        }
        powers = [Channel(f"{n}_power", "W", f"Power of the drive of {n}", "joint") for n in pairs]
        return cls((*own, *powers), kept, tuple(pairs.values()), tuple(pairs))

    def complete(self, row: Array) -> Array:
        """Return a row of the channels kept, with the powers."""
        row = row[list(self.kept)]
        return np.concatenate([row, [row[force] * row[rate] for force, rate in self.forces]])

    def figures(self) -> Iterator[DriveFigure]:
        """Yield the key figures: the largest force and power of each drive, and its work."""
        for k, name in enumerate(self.coordinates):
            unit, text = self.channels[self.forces[k][0]].unit, f"drive of {name}"
            force, power = f"{name}_force", f"{name}_power"
            yield DriveFigure(f"{name}.force", unit, f"Largest force, {text}", force)
            yield DriveFigure(f"{name}.power", "W", f"Largest power, {text}", power)
            words = f"Work, {text}, as far as the samples tell"
            yield DriveFigure(f"{name}.work", "J", words, power, is_integral=True)

    def summary(self, times: Array, table: Array) -> Iterator[SummaryEntry]:
        """Yield the values of the key figures."""
        places = {channel.name: k for k, channel in enumerate(self.channels)}
        for figure in self.figures():
            values = table[:, places[figure.channel]]
            if not figure.is_integral:
                value = float(np.abs(values).max())
            else:
                value = float(np.trapezoid(values, times)) if len(times) > 1 else 0.0
            yield SummaryEntry(figure.name, value, figure.unit, figure.description)

    def plots(self) -> list[dict[str, Any]]:
        """Return figures of motion, forces and power of the drives."""
        names = list(self.coordinates)
        units = {c.name: c.unit for c in self.channels}
        wanted = {
            "motion": ("Prescribed motion", "Coordinate", names),
            "rates": ("Rates of the prescribed motion", "Rate", [f"{n}_rate" for n in names]),
            "forces": ("Forces of the drives", "Force", [f"{n}_force" for n in names]),
            "power": ("Power of the drives", "Power", [f"{n}_power" for n in names]),
        }
        return [
            {"name": key, "title": title, "kind": "time", "panels": panels}
            for key, (title, label, channels) in wanted.items()
            if (panels := list(_panels(label, channels, units)))
        ]


def _panels(label: str, channels: list[str], units: dict[str, str]) -> Iterator[dict[str, Any]]:
    for unit in dict.fromkeys(units[name] for name in channels):
        lines = [name for name in channels if units[name] == unit][:_LINES]
        yield {"label": label, "unit": _SHOWN_IN.get(unit, unit), "channels": lines}
