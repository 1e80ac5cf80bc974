"""Causal filters with exact gains, of signals of any length."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.assessment.signal import BLOCK, Floats, Signal, stored

Response = Callable[[Floats], NDArray[np.complex128]]
"""Complex gain of a filter at frequencies [Hz], both of shape (n,)."""

_TAPER, _REST = 1.0, 10.0
"""Time in which a signal is led back to its start, and rests there, before it is filtered [s]."""
_SETTLED = 60.0
"""Time after which no filter in use remembers what was before, to 1e-12 [s]."""


def filtered_section(signal: Signal, step: float, response: Response, kept: slice) -> Signal:
    """Return a section of a signal behind a causal linear filter, computed once.

    What fits into one block is filtered as a whole by :func:`filtered`. Of longer signals each
    block is, with 60 s before and behind it, in which all filters here settle but Sperling's:
    its band ends abruptly, which moves his index by less than 1e-4.

    Parameters
    ----------
    signal
        Even samples, shape (n,).
    step
        Between them [s].
    response
        Complex gain of the filter against frequency.
    kept
        The section to return.
    """
    if signal.count <= BLOCK:
        return stored([filtered(signal.part(0, signal.count), step, response)[kept]])
    margin = round(_SETTLED / step)

    def blocks() -> Iterator[Floats]:
        size = max(BLOCK, 2 * margin)
        for start in range(kept.start, kept.stop, size):
            stop = min(start + size, kept.stop)
            first = max(start - margin, 0)
            window = filtered(signal.part(first, stop + margin), step, response)
            yield window[start - first : stop - first]

    return stored(blocks())


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


def _poles(order: int) -> NDArray[np.complex128]:
    """Return the poles of a Butterworth filter with the cut-off 1."""
    angles = np.pi * (2.0 * np.arange(1, order + 1) + order - 1.0) / (2.0 * order)
    return np.asarray(np.exp(1j * angles))


def _fast_length(least: int) -> int:
    """Return a length not below this that has only the factors 2, 3 and 5."""
    best = 1 << (least - 1).bit_length()
    for three in (1, 3, 9):
        for five in (1, 5, 25):
            factor = three * five
            rest = -(-least // factor)
            best = min(best, factor << (rest - 1).bit_length())
    return best
