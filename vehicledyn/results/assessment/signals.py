"""Signals of a run for an assessment: even samples, filters with exact gains, sliding means."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError

Floats = NDArray[np.float64]
Response = Callable[[Floats], NDArray[np.complex128]]
"""Complex gain of a filter at frequencies [Hz], both of shape (n,)."""

_TAPER, _REST = 1.0, 10.0
"""Time in which a signal is led back to its start, and rests there, before it is filtered [s]."""
_UNEVEN = 1e-6


@dataclass(frozen=True)
class Samples:
    """Channels at even steps of time.

    ``time`` and each channel have shape (n,); ``step`` is in s. Channels are read when asked for,
    so that few of them are in memory at once. ``kept`` is the section that is assessed; filters
    see the whole run, so that they have settled where it begins.
    """

    time: Floats
    step: float
    channels: Mapping[str, Floats]
    kept: slice

    @property
    def rate(self) -> float:
        """Samples a second [Hz]."""
        return 1.0 / self.step

    @property
    def duration(self) -> float:
        """Length of the section [s]."""
        section = self.time[self.kept]
        return float(section[-1] - section[0])

    def section(self, name: str) -> Floats:
        """Return a channel in the section."""
        return self.channels[name][self.kept]


class LazyChannels(Mapping[str, Any]):
    """Channels that are read when they are asked for, and not kept.

    Parameters
    ----------
    names
        Names of the channels.
    read
        Function from a name to the values, shape (n,), SI.
    """

    def __init__(self, names: Iterable[str], read: Callable[[str], Any]) -> None:
        self._names, self._read = dict.fromkeys(names), read

    def __getitem__(self, name: str) -> Any:
        """Return a channel, shape (n,)."""
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
    time: Floats,
    channels: Mapping[str, Any],
    *,
    begin: float | None = None,
    end: float | None = None,
) -> Samples:
    """Return channels at even steps, of which a section is kept.

    Samples of one and the same instant, as at an impact, are one, the last of them. Where the
    steps still differ, values between the samples are interpolated linearly.

    Parameters
    ----------
    time
        Not falling, shape (n,) [s].
    channels
        Values by name, or datasets of a file, shape (n,), SI.
    begin, end
        Limits of the section; the whole run if absent [s].

    Raises
    ------
    InputError
        If fewer than two instants are in the section.
    """
    last = np.append(np.diff(time) > 0.0, True)
    instants = np.asarray(time, dtype=float)[last]
    known = instants
    if len(instants) > 1:
        step = float(np.median(np.diff(instants)))
        count = round((instants[-1] - instants[0]) / step)
        even = instants[0] + step * np.arange(count + 1)
        if len(even) != len(instants) or np.abs(even - instants).max() > _UNEVEN * step:
            instants = even[even <= instants[-1] + _UNEVEN * step]
    else:
        step = 0.0
    kept = _between(instants, step, begin, end)
    if kept.stop - kept.start < 2:
        span = f"{instants[0]:.6g} to {instants[-1]:.6g} s" if len(instants) else "no samples"
        raise InputError(f"nothing to assess there: the run holds {span}")

    def read(name: str) -> Floats:
        column = np.asarray(channels[name], dtype=float)[last]
        return column if instants is known else np.asarray(np.interp(instants, known, column))

    return Samples(instants, step, LazyChannels(channels, read), kept)


def filtered(values: Floats, step: float, response: Response) -> Floats:
    """Return a signal behind a causal linear filter, shape (n,).

    The gain is that of ``response`` exactly at every frequency below half the sampling rate, and
    the filter has been at rest at the first value for ever, so that nothing starts with a jump.

    Parameters
    ----------
    values
        Even samples, shape (n,).
    step
        Between them [s].
    response
        Complex gain of the filter against frequency.
    """
    rise = values - values[0]
    taper = max(round(_TAPER / step), 1)
    back = 0.5 * rise[-1] * (1.0 + np.cos(np.pi * np.arange(1, taper + 1) / taper))
    length = _fast_length(len(rise) + taper + round(_REST / step))
    padded = np.zeros(length)
    padded[: len(rise)] = rise
    padded[len(rise) : len(rise) + taper] = back
    frequency = np.asarray(np.fft.rfftfreq(length, step), dtype=float)
    spectrum = np.multiply(np.fft.rfft(padded), response(frequency))
    still = float(response(np.zeros(1))[0].real) * values[0]
    return np.asarray(still + np.fft.irfft(spectrum, length)[: len(rise)])


def butterworth(cut_off: float, order: int) -> Response:
    """Return a low-pass filter of Butterworth, -3 dB at the cut-off [Hz]."""
    poles = _poles(order)

    def response(frequency: Floats) -> NDArray[np.complex128]:
        place = 1j * np.asarray(frequency) / cut_off
        gain = np.ones(place.shape, dtype=complex)
        for pole in poles:
            gain /= 1.0 - place / pole
        return gain

    return response


def high_pass(cut_off: float, order: int) -> Response:
    """Return a high-pass filter of Butterworth, -3 dB at the cut-off [Hz]."""
    poles = _poles(order)

    def response(frequency: Floats) -> NDArray[np.complex128]:
        place = 1j * np.asarray(frequency) / cut_off
        gain = np.ones(place.shape, dtype=complex)
        for pole in poles:
            gain *= place / (place - pole)
        return gain

    return response


@dataclass(frozen=True)
class SlidingMean:
    """Means over a window of distance, one for each ``place`` in its middle, shape (n,) [m]."""

    place: Floats
    mean: Floats


def sliding_mean(distance: Floats, values: Floats, *, window: float, every: float) -> SlidingMean:
    """Return means over a window that slides along the track; none if the way is shorter.

    The values are linear between the samples, and their integral is exact for that.

    Parameters
    ----------
    distance
        Way along the track, not falling, shape (n,) [m].
    values
        Values there, shape (n,).
    window, every
        Length of the window and its steps [m].
    """
    room = distance[-1] - distance[0] - window
    count = int(np.floor(room / every + 1e-9)) + 1 if room >= 0.0 else 0
    begin = distance[0] + every * np.arange(count)
    ahead = integral_between(distance, values, begin + window)
    behind = integral_between(distance, values, begin)
    return SlidingMean(begin + 0.5 * window, (ahead - behind) / window)


def integral_between(places: Floats, values: Floats, wanted: Floats) -> Floats:
    """Return the integral from the first place to others of what is linear between samples."""
    steps = np.diff(places)
    parts = 0.5 * steps * (values[:-1] + values[1:])
    whole = np.concatenate([[0.0], np.cumsum(parts)])
    at = np.clip(np.searchsorted(places, wanted, side="right") - 1, 0, len(steps) - 1)
    part = np.clip(wanted - places[at], 0.0, steps[at])
    slope = (values[at + 1] - values[at]) / np.where(steps[at] > 0.0, steps[at], 1.0)
    return np.asarray(whole[at] + part * (values[at] + 0.5 * slope * part))


def block_rms(values: Floats, step: float, duration: float) -> Floats:
    """Return root mean squares of successive windows of a duration [s]; an odd rest is left."""
    count = int(np.floor((len(values) - 1) * step / duration + 1e-9))
    edges = np.round(np.arange(count + 1) * duration / step).astype(int)
    return np.array([np.sqrt(np.mean(values[a:b] ** 2)) for a, b in pairwise(edges)])


def _poles(order: int) -> NDArray[np.complex128]:
    """Return the poles of a Butterworth filter with the cut-off 1."""
    angles = np.pi * (2.0 * np.arange(1, order + 1) + order - 1.0) / (2.0 * order)
    return np.asarray(np.exp(1j * angles))


def _between(time: Floats, step: float, begin: float | None, end: float | None) -> slice:
    first = 0 if begin is None else int(np.searchsorted(time, begin - _UNEVEN * step))
    last = len(time) if end is None else int(np.searchsorted(time, end + _UNEVEN * step))
    return slice(first, max(first, last))


def _fast_length(least: int) -> int:
    """Return a length not below this that has only the factors 2, 3 and 5."""
    best = 1 << (least - 1).bit_length()
    for three in (1, 3, 9):
        for five in (1, 5, 25):
            factor = three * five
            rest = -(-least // factor)
            best = min(best, factor << (rest - 1).bit_length())
    return best
