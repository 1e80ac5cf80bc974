"""Integrals and sliding means along the track or in time, block by block."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.results.assessment.signal import BLOCK, Floats, Signal, stored

_LONGEST = 1e7  # m


@dataclass(frozen=True)
class SlidingMean:
    """Means over a window of distance, one every ``every`` from ``first``, its middle [m]."""

    first: float
    every: float
    mean: Signal

    def place(self, number: int) -> float:
        """Return the middle of a window [m]."""
        return self.first + self.every * number


def sliding_mean(distance: Signal, values: Signal, *, window: float, every: float) -> SlidingMean:
    """Return means over a window that slides along the track; none if the way is shorter.

    The values are linear between the samples, and their integral is exact for that.

    Parameters
    ----------
    distance
        Way along the track, not falling, shape (n,) [m].
    values
        Values there, shape (n,).
    window, every
        Length of the window and its steps [m]; the one a multiple of the other.
    """
    begin = distance.at(0)
    room = distance.at(-1) - begin - window
    if not room <= _LONGEST:
        raise InputError(f"{room + window:.3g} m (or s) are too long to assess")
    count = int(np.floor(room / every + 1e-9)) + 1 if room >= 0.0 else 0
    ahead = round(window / every)
    grid = even_places(begin, every, count + ahead if count else 0)

    def means() -> Iterator[Floats]:
        before = np.empty(0)
        for whole in integrals(distance, values, grid):
            joined = np.concatenate([before, whole])
            before = joined[-ahead:]
            if len(joined) > ahead:
                yield (joined[ahead:] - joined[:-ahead]) / window

    return SlidingMean(begin + 0.5 * window, every, stored(means()))


def even_places(begin: float, every: float, count: int) -> Signal:
    """Return places at even steps as a signal."""
    return Signal(count, lambda a, b: np.asarray(begin + every * np.arange(a, b)))


def integrals(places: Signal, values: Signal, wanted: Signal) -> Iterator[Floats]:
    """Yield the integral of what is linear between samples, from the first place to others.

    Parameters
    ----------
    places
        Not falling, shape (n,).
    values
        Values there, shape (n,).
    wanted
        Places between the first and the last, not falling, shape (m,).
    """
    done, whole = 0, 0.0
    for start in range(0, places.count - 1, BLOCK):
        at, own = places.part(start, start + BLOCK + 1), values.part(start, start + BLOCK + 1)
        is_last = start + BLOCK + 1 >= places.count
        while done < wanted.count:
            next_ones = wanted.part(done, done + BLOCK)
            within = len(next_ones)
            if not is_last:
                within = int(np.searchsorted(next_ones, at[-1], side="left"))
            if within:
                yield whole + integral_between(at, own, next_ones[:within])
                done += within
            if within < BLOCK:
                break
        whole += float(integral_between(at, own, at[-1:])[0])


def integral_between(places: Floats, values: Floats, wanted: Floats) -> Floats:
    """Return the integral from the first place to others of what is linear between samples."""
    steps = np.diff(places)
    parts = 0.5 * steps * (values[:-1] + values[1:])
    whole = np.concatenate([[0.0], np.cumsum(parts)])
    at = np.clip(np.searchsorted(places, wanted, side="right") - 1, 0, len(steps) - 1)
    part = np.clip(wanted - places[at], 0.0, steps[at])
    slope = (values[at + 1] - values[at]) / np.where(steps[at] > 0.0, steps[at], 1.0)
    return np.asarray(whole[at] + part * (values[at] + 0.5 * slope * part))


def block_rms(values: Signal, step: float, duration: float) -> Floats:
    """Return root mean squares of successive windows of a duration [s]; an odd rest is left."""
    if step > duration:
        return np.empty(0)
    count = int(np.floor((values.count - 1) * step / duration + 1e-9))
    edges = np.round(np.arange(count + 1) * duration / step).astype(int)
    return np.array([np.sqrt(np.mean(values.part(a, b) ** 2)) for a, b in pairwise(edges)])
