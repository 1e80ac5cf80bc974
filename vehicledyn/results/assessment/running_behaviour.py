"""Running behaviour after EN 14363: accelerations of a body between 0.4 and 10 Hz.

References
----------
EN 14363:2016 and UIC 518:2009, tables of the assessment quantities and their processing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.assessment.even_samples import EvenSamples
from vehicledyn.results.assessment.filters import butterworth, filtered_section, high_pass
from vehicledyn.results.assessment.running_safety import CUT_OFF, ORDER, extreme_of
from vehicledyn.results.assessment.signal import Floats

BAND = (0.4, 10.0)
"""Band-pass filter, -3 dB [Hz]; each side has 24 dB an octave."""
DIRECTIONS = ("lateral", "vertical")


@dataclass(frozen=True)
class BodyAcceleration:
    """Acceleration at one place in one direction [m/s²].

    ``largest`` is the extreme of the 0.15 % and 99.85 % percentiles and ``rms`` the root mean
    square of the band; ``quasi_static`` is the median behind the low-pass filter of 20 Hz.
    """

    name: str
    direction: str
    largest: float
    rms: float
    quasi_static: float


def assess_acceleration(name: str, direction: str, samples: EvenSamples) -> BodyAcceleration:
    """Return the running behaviour at an accelerometer with the channel "name.direction"."""
    values = samples.channels[f"{name}.{direction}"]
    inside = filtered_section(values, samples.step, _band, samples.kept)
    slow = filtered_section(values, samples.step, butterworth(CUT_OFF, ORDER), samples.kept)
    return BodyAcceleration(
        name=name,
        direction=direction,
        largest=extreme_of(inside),
        rms=float(np.sqrt(inside.mean_square())),
        quasi_static=slow.median(),
    )


def _band(frequency: Floats) -> NDArray[np.complex128]:
    low, high = high_pass(BAND[0], ORDER), butterworth(BAND[1], ORDER)
    return np.multiply(low(frequency), high(frequency))
