"""Ranges that channels go through in a run, as the measure of their errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.kernel.engine import Vector
from vehicledyn.symbolic.equations import Equations

_FLOOR, _OWN_FLOOR = 1e-6, 1e-2
"""Smallest range that counts, as a part of the largest value of any channel of that unit, and of
its own: what hardly varies, such as an energy that is conserved, is judged by its size."""


_NOISE, _NOISE_OF_FORCES = 1e-6, 1e-3
"""Smallest range that counts, in SI units: what symmetry makes zero is rounding."""

_MANY = 4
"""Samples per channel above which they are put one channel after the other to be reduced."""

_TRAVELLED = ("m", "rad")
"""Units of what may add up without end, as distances and turns do; they are no measure of noise."""


def watched_channels(equations: Equations) -> list[int]:
    """Return the channels that can be judged: all but energies, powers and errors of constraints.

    These are there to check the computation itself.
    """
    return [k for k, c in enumerate(equations.channels) if _can_be_judged(c.name)]


def _can_be_judged(name: str) -> bool:
    return not name.startswith(("constraints.", "energy.", "power."))


@dataclass
class Ranges:
    """Smallest and largest values and means of some channels, sample by sample."""

    low: Vector
    high: Vector
    total: Vector
    units: NDArray[np.intp]
    noise: Vector
    matters: NDArray[np.bool_]
    likes: Vector
    """Largest value of any channel of a unit that is known, by the number of the unit."""
    known: dict[str, int]
    count: int = 0

    @staticmethod
    def of(equations: Equations, channels: Sequence[int]) -> Ranges:
        """Begin with nothing known of some channels."""
        units = [equations.channels[k].unit for k in channels]
        known = sorted(set(units))
        codes = np.array([known.index(unit) for unit in units], dtype=np.intp)
        n = len(units)
        matters = np.array([_can_be_judged(equations.channels[k].name) for k in channels], bool)
        noise = np.array(
            [_NOISE_OF_FORCES if u.startswith(("N", "J", "W")) else _NOISE for u in units]
        )
        return Ranges(
            np.full(n, np.inf),
            np.full(n, -np.inf),
            np.zeros(n),
            codes,
            noise,
            matters,
            np.zeros(max(1, len(known))),
            {unit: number for number, unit in enumerate(known)},
        )

    def copied(self) -> Ranges:
        """Return the same ranges, which stay as they are when these go on."""
        return replace(self, likes=self.likes.copy())

    def kinds(self, equations: Equations) -> NDArray[np.intp]:
        """Return the number of each channel's unit, shape (n_channels,), -1 for one not judged."""
        return np.array(
            [
                self.known.get(channel.unit, -1)
                if channel.unit not in _TRAVELLED and _can_be_judged(channel.name)
                else -1
                for channel in equations.channels
            ],
            dtype=np.intp,
        )

    def take_likes(self, kinds: NDArray[np.intp], outputs: Vector) -> None:
        """Go on by all channels at one time, shape (n_channels,), of units by number.

        What is zero by symmetry has nothing but noise of its own; other channels of its unit show
        how large quantities of its kind are.
        """
        counts = (kinds >= 0) & np.isfinite(outputs)
        np.maximum.at(self.likes, kinds[counts], np.abs(outputs[counts]))

    def take(self, values: Vector) -> None:
        """Go on by samples, shape (n_samples, n_channels); what is no number does not count."""
        if not len(values):
            return
        if len(values) > _MANY * values.shape[1]:
            values = np.asfortranarray(values)
        with np.errstate(all="ignore"):
            self.low = np.fmin(self.low, np.fmin.reduce(values, axis=0))
            self.high = np.fmax(self.high, np.fmax.reduce(values, axis=0))
            self.total = self.total + values.sum(axis=0)
        self.count += len(values)

    def largest(self) -> Vector:
        """Return the largest absolute value of each channel, shape (n_channels,)."""
        with np.errstate(all="ignore"):
            size = np.fmax(np.abs(self.low), np.abs(self.high))
        return np.nan_to_num(size, posinf=1e300)

    def scales(self) -> Vector:
        """Return the range of each channel, shape (n_channels,), never below what counts.

        It is infinite for channels that cannot be judged, so that no error counts.
        """
        with np.errstate(all="ignore"):
            span = np.nan_to_num(self.high - self.low, posinf=1e300)
        largest = self.likes.copy()
        np.maximum.at(largest, self.units, self.largest())
        floor = np.maximum(_FLOOR * largest[self.units], _OWN_FLOOR * self.largest())
        return np.where(self.matters, np.maximum(np.maximum(span, floor), self.noise), np.inf)

    def distance(self, other: Ranges, span: Vector) -> Vector:
        """Return how far extremes and means lie from those of another run, shape (n_channels,).

        As a part of the extreme or of a tenth of the range ``span``, whichever is larger; a
        mean counts as a part of itself or of the whole range.
        """
        with np.errstate(all="ignore"):
            pairs = [(self.low, other.low), (self.high, other.high)]
            parts = [
                np.abs(own - theirs) / np.maximum(np.abs(theirs), 0.1 * span)
                for own, theirs in pairs
            ]
            means = self.total / max(1, self.count), other.total / max(1, other.count)
            parts.append(np.abs(means[0] - means[1]) / np.maximum(np.abs(means[1]), span))
            worst = np.nan_to_num(np.maximum.reduce(parts), nan=np.inf, posinf=np.inf)
        same = np.isnan(self.total) & np.isnan(other.total)
        return np.where(same | ~self.matters, 0.0, worst)
