"""What of a run its accuracy is judged by: channels, and key figures made from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeAlias

import numpy as np

from vehicledyn.integrate.channel_ranges import Ranges, watched_channels
from vehicledyn.integrate.kept_samples import KeptSamples
from vehicledyn.kernel.engine import Vector
from vehicledyn.symbolic.equations import Equations

Figures: TypeAlias = Callable[[Vector, Vector], Mapping[str, tuple[float, str]]]
"""Makes key figures, name to value and unit, from times (n,) and channels (n, n_channels)."""


class EnergyBalance(NamedTuple):
    """Largest difference of energy gained and work done, and the energy exchanged [J].

    ``uncertainty`` is the part of the error that may come from what lies between the samples, as
    far as that is estimated [J].
    """

    error: float
    exchanged: float
    uncertainty: float = 0.0

    def distance(self, other: EnergyBalance) -> float:
        """Return how far the error is from that of a better run, as a part of what it exchanges."""
        with np.errstate(all="ignore"):
            found = np.divide(abs(self.error - other.error), other.exchanged)
        return float(found) if np.isfinite(found) else _unlike(self.error, other.error)

    @property
    def part(self) -> float:
        """The error as a part of what is exchanged."""
        return self.distance(EnergyBalance(0.0, self.exchanged))


class EnergyWatch(Protocol):
    """Makes the balance of the energy from the same, None where there is none."""

    def __call__(
        self, times: Vector, values: Vector, *, rough: bool = False
    ) -> EnergyBalance | None:
        """Return the balance, or quickly a rough one."""


_MOST_NUMBERS = 2_000_000
"""Samples of channels that are kept for key figures."""

_NOISE, _NOISE_OF_LIKES = 1e-3, 1e-6
"""Figure below which errors do not count, as a part of the largest judged channel of its unit, and
of the largest channel of that unit at all."""


@dataclass(frozen=True)
class Judged:
    """Channels by number, figures made from them, and whether the run is no case among many.

    Without figures the extremes and means of the channels are judged themselves. ``balance`` is
    that of the energy, ``closely`` says that a run of a few milliseconds is always taken again.
    """

    channels: list[int]
    figures: Figures | None = None
    by_itself: bool = True
    balance: EnergyWatch | None = None
    closely: bool = False

    @staticmethod
    def usual(equations: Equations) -> Judged:
        """Return all channels that can be judged."""
        return Judged(watched_channels(equations))

    def kept(self, n_intervals: int) -> KeptSamples | None:
        """Return where samples are kept for figures; None where there are too many, or none."""
        few = (n_intervals + 1) * len(self.channels) <= _MOST_NUMBERS
        return KeptSamples(n_intervals + 1, self.channels) if self.figures and few else None


@dataclass(frozen=True)
class FigureSizes:
    """What errors of figures are parts of: ranges of channels by name, least sizes by unit."""

    ranges: Mapping[str, float]
    units: Mapping[str, float]
    """Smallest size that counts, by unit."""

    @staticmethod
    def of(equations: Equations, channels: list[int], found: Ranges) -> FigureSizes:
        """Return the sizes of some channels."""
        own = [equations.channels[k] for k in channels]
        units = {unit: _NOISE_OF_LIKES * found.likes[k] for unit, k in found.known.items()}
        for channel, size in zip(own, found.largest().tolist(), strict=True):
            units[channel.unit] = max(units[channel.unit], _NOISE * size)
        names = [channel.name for channel in own]
        return FigureSizes(dict(zip(names, found.scales().tolist(), strict=True)), units)

    def of_figure(self, name: str, value: float, unit: str) -> float:
        """Return the range of the channel that a figure is named after, else its own size.

        Much smaller figures than the largest values of their unit are noise.
        """
        known = self.ranges.get(name.rpartition(".")[0])
        if known is not None and np.isfinite(known):
            return known
        return max(abs(value), self.units.get(unit, 0.0), 1e-6)


def figure_errors(
    own: Mapping[str, tuple[float, str]], other: Mapping[str, tuple[float, str]], sizes: FigureSizes
) -> dict[str, float]:
    """Return how far figures lie from other ones, as parts of sizes; infinite where one lacks."""
    found = {}
    for name, (value, unit) in other.items():
        if name not in own:
            found[name] = np.inf
            continue
        error = abs(own[name][0] - value) / sizes.of_figure(name, value, unit)
        found[name] = float(error) if np.isfinite(error) else _unlike(own[name][0], value)
    return found | {name: np.inf for name in own if name not in other}


def _unlike(one: float, other: float) -> float:
    """Return the error of figures of which one is no finite number."""
    return 0.0 if one == other or (np.isnan(one) and np.isnan(other)) else np.inf
