"""Channels of a run at even steps of time, read block by block."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.results.assessment.signal import BLOCK, Floats, Signal, signal_of

_UNEVEN = 1e-6
_MOST_TIMES = 100
"""As many even steps as samples at most; more stand for gaps of a damaged file."""


@dataclass(frozen=True)
class EvenSamples:
    """Channels at even steps of time.

    ``time`` and each channel have n values; ``step`` is in s. Channels are read when asked for,
    a block at a time. ``kept`` is the section that is assessed; filters see the whole run, so
    that they have settled where it begins.
    """

    time: Signal
    step: float
    channels: Mapping[str, Signal]
    kept: slice

    @property
    def rate(self) -> float:
        """Samples a second [Hz]."""
        return 1.0 / self.step

    @property
    def duration(self) -> float:
        """Length of the section [s]."""
        return self.time.at(self.kept.stop - 1) - self.time.at(self.kept.start)

    def section(self, name: str) -> Signal:
        """Return a channel in the section."""
        return self.channels[name].section(self.kept)


class LazyChannels(Mapping[str, Any]):
    """Channels that are read when they are asked for, and not kept.

    Parameters
    ----------
    names
        Names of the channels.
    read
        Function from a name to the values.
    """

    def __init__(self, names: Iterable[str], read: Callable[[str], Any]) -> None:
        self._names, self._read = dict.fromkeys(names), read

    def __getitem__(self, name: str) -> Any:
        """Return a channel."""
        if name not in self._names:
            raise KeyError(name)
        return self._read(name)

    def __contains__(self, name: object) -> bool:
        """Return whether there is such a channel, without reading it."""
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return iter(self._names)

    def __len__(self) -> int:
        """Return the number of channels."""
        return len(self._names)


def even_samples(
    time: Any,
    channels: Mapping[str, Any],
    *,
    begin: float | None = None,
    end: float | None = None,
) -> EvenSamples:
    """Return channels at even steps, of which a section is kept.

    Samples of one and the same instant, as at an impact, are one, the last of them. Where the
    steps still differ, values between the samples are interpolated linearly.

    Parameters
    ----------
    time
        Not falling, n values that slice like an array [s].
    channels
        Values by name, n each, that slice like arrays, SI.
    begin, end
        Limits of the section; the whole run if absent [s].

    Raises
    ------
    InputError
        If fewer than two instants are in the section.
    """
    known = signal_of(time)
    steps = _Steps.of(known)
    instants, step = known, steps.typical
    if not steps.even:
        count = _even_count(steps, known.count)
        first = steps.first
        instants = Signal(count, lambda a, b: np.asarray(first + step * np.arange(a, b)))
    kept = _between(instants, step, begin, end)
    if kept.stop - kept.start < 2:
        span = f"{steps.first:.6g} to {steps.last:.6g} s" if known.count else "no samples"
        raise InputError(f"nothing to assess there: the run holds {span}")

    def read(name: str) -> Signal:
        column = signal_of(channels[name])
        return column if steps.even else _interpolated(known, column, instants)

    return EvenSamples(instants, step, LazyChannels(channels, read), kept)


def _even_count(steps: _Steps, samples: int) -> int:
    """Return how many even steps replace uneven ones; an InputError if they are far too many."""
    whole = np.floor((steps.last - steps.first) / steps.typical + _UNEVEN) + 1
    if not whole <= _MOST_TIMES * samples:
        raise InputError(
            f"nothing to assess there: {samples} samples from {steps.first:.6g} to "
            f"{steps.last:.6g} s leave gaps beside steps of {steps.typical:.3g} s"
        )
    return int(whole)


@dataclass(frozen=True)
class _Steps:
    """First and last time, the step that is typical [s], and whether all are like it."""

    first: float
    last: float
    typical: float
    even: bool

    @classmethod
    def of(cls, time: Signal) -> _Steps:
        if time.count < 2:
            only = time.at(0) if time.count else 0.0
            return cls(only, only, 0.0, even=True)
        first, last = time.at(0), time.at(-1)
        differences = Signal(time.count - 1, lambda a, b: np.diff(time.part(a, b + 1)))
        repeated = sum(int(np.count_nonzero(d <= 0.0)) for d in differences.blocks())
        rising = differences.count - repeated
        if not rising:
            return cls(first, last, 0.0, even=time.count < 2)
        # Repeated instants are the smallest differences: the median of the others lies higher.
        middle = 100.0 * (repeated + 0.5 * (rising - 1)) / max(differences.count - 1, 1)
        step = differences.percentiles(middle)[0]
        even, start = not repeated, 0
        for block in time.blocks():
            apart = np.abs(first + step * np.arange(start, start + len(block)) - block)
            even = even and bool(apart.max() <= _UNEVEN * step)
            start += len(block)
        return cls(first, last, step, even)


def _interpolated(known: Signal, column: Signal, wanted: Signal) -> Signal:
    """Return a column at other instants, linear between its own; the last of equal ones counts."""
    starts = np.array([known.at(k) for k in range(0, known.count, BLOCK)])

    def read(start: int, stop: int) -> Floats:
        times = wanted.part(start, stop)
        if not len(times):
            return times
        first = max(int(np.searchsorted(starts, times[0])) - 1, 0) * BLOCK
        last = (int(np.searchsorted(starts, times[-1], side="right")) + 1) * BLOCK
        own = known.part(first, last)
        counts = np.append(np.diff(own) > 0.0, True)
        return np.asarray(np.interp(times, own[counts], column.part(first, last)[counts]))

    return Signal(wanted.count, read)


def _between(time: Signal, step: float, begin: float | None, end: float | None) -> slice:
    first = 0 if begin is None else _first_from(time, step, begin - _UNEVEN * step)
    last = time.count if end is None else _first_from(time, step, end + _UNEVEN * step)
    return slice(first, max(first, last))


def _first_from(time: Signal, step: float, limit: float) -> int:
    """Return the first of even instants not below a limit."""
    if not time.count or step <= 0.0:
        return 0
    guess = float(np.clip((limit - time.at(0)) / step, 0.0, time.count))
    near = max(int(guess) - 2, 0)
    return near + int(np.searchsorted(time.part(near, near + 5), limit))
