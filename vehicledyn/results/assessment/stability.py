"""Stability after EN 14363: how strongly the sum of guiding forces of a wheelset oscillates.

The sum of Y goes through a band of ± 2 Hz about the frequency at which it oscillates most; of
what is left the root mean square is taken over 100 m of track, every 10 m. The vehicle counts as
unstable where that exceeds half the limit of the sum of Y.

References
----------
EN 14363:2016 and UIC 518:2009, instability criterion of the normal method: band, window and limit
also as the program GENSYS documents them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.assessment.even_samples import EvenSamples
from vehicledyn.results.assessment.filters import (
    Response,
    butterworth,
    filtered_section,
    high_pass,
)
from vehicledyn.results.assessment.running_safety import total_of, track_shift_limit
from vehicledyn.results.assessment.signal import BLOCK, Floats, Signal, combined
from vehicledyn.results.assessment.sliding import sliding_mean

WINDOW, EVERY = 100.0, 10.0
"""Sliding root mean square: length and step [m]."""
HALF_BAND = 2.0
"""Half the width of the band about the frequency of the instability [Hz]."""
FREQUENCIES = (1.0, 15.0)
"""Where the frequency of an instability is looked for [Hz]."""

_ORDER = 8
_LOWEST = 0.4
_FINEST = 0.05


@dataclass(frozen=True)
class AxleStability:
    """Oscillation of the sum of Y of a wheelset.

    ``rms`` is the largest of the sliding root mean squares and ``limit`` half of that of the sum
    [N], ``frequency`` the middle of the band [Hz] and ``place`` the middle of the worst window,
    counted along the way from the start of the run [m].
    """

    name: str
    rms: float
    limit: float
    frequency: float
    place: float


def assess_stability(
    name: str, samples: EvenSamples, distance: Signal, static: float, wheels: tuple[str, ...]
) -> AxleStability | None:
    """Return the stability of an axle; None if the way is shorter than the window.

    Parameters
    ----------
    name
        Axle, such as "front".
    samples
        Channels of the run.
    distance
        Way along the track of the section's samples, not falling, shape (n,) [m].
    static
        Static load Q₀ of one wheel [N].
    wheels
        Its wheels; "name.Y" are their guiding forces.
    """
    total = combined(total_of, *(samples.channels[f"{wheel}.Y"] for wheel in wheels))
    frequency = strongest(total.section(samples.kept), samples.step)
    inside = filtered_section(total, samples.step, band(frequency), samples.kept)
    means = sliding_mean(distance, combined(np.square, inside), window=WINDOW, every=EVERY)
    if not means.mean.count:
        return None
    worst, largest = means.mean.highest()
    rms = float(np.sqrt(max(largest, 0.0)))
    limit = 0.5 * track_shift_limit(static)
    return AxleStability(name, rms, limit, frequency, means.place(worst))


def band(frequency: float) -> Response:
    """Return the band-pass filter of ± 2 Hz about a frequency, 48 dB an octave [Hz]."""
    low = high_pass(max(frequency - HALF_BAND, _LOWEST), _ORDER)
    high = butterworth(frequency + HALF_BAND, _ORDER)

    def response(place: Floats) -> NDArray[np.complex128]:
        return np.multiply(low(place), high(place))

    return response


def strongest(values: Signal, step: float) -> float:
    """Return the frequency at which a signal oscillates most, in steps of 0.05 Hz at most.

    The spectrum is that of the signal less its mean behind a window of Hann. Signals longer than
    a block are cut into equal pieces, whose squared spectra add up.
    """
    pieces = -(-values.count // BLOCK)
    size = values.count // pieces
    length = max(size, round(1.0 / (_FINEST * step)))
    bell = 0.5 - 0.5 * np.cos(2.0 * np.pi * (np.arange(size) + 0.5) / size)
    frequency = np.asarray(np.fft.rfftfreq(length, step))
    inside = (frequency >= FREQUENCIES[0]) & (frequency <= FREQUENCIES[1])
    power = np.zeros(np.count_nonzero(inside))
    for start in range(0, pieces * size, size):
        piece = values.part(start, start + size)
        power += np.abs(np.fft.rfft((piece - np.mean(piece)) * bell, length)[inside]) ** 2
    return float(frequency[inside][np.argmax(power)])
