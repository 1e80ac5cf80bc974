"""Transfer functions from a swept sine, a pulse or any other transient (ISO 7401).

Of a transient that begins and ends at rest H(f) = Y(f)/U(f), of one Fourier transform each over the
whole record: no window is needed, and none distorts the response. Where only the input is back at
zero, the output's end value is small and stated by ``leftover``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.road.standards.signals import Floats


@dataclass(frozen=True)
class FrequencyResponse:
    """A response at frequencies, shape (n_frequencies,).

    ``response`` is output over input; ``leftover`` the last value of the output over its largest.
    """

    frequency: Floats
    response: NDArray[np.complex128]
    leftover: float

    @property
    def magnitude(self) -> Floats:
        """Output over input."""
        return np.abs(self.response)

    @property
    def phase(self) -> Floats:
        """Phase of the output before that of the input [rad]."""
        return np.unwrap(np.angle(self.response))

    @property
    def peak_frequency(self) -> float:
        """Frequency of the largest magnitude [Hz]."""
        return float(self.frequency[int(np.argmax(self.magnitude))])

    def bandwidth(self, steady: float) -> float:
        """Return the lowest frequency at which the magnitude falls 3 dB below a steady gain [Hz].

        NaN where it does not within the range.
        """
        below = np.flatnonzero(self.magnitude < abs(steady) / np.sqrt(2.0))
        return float(self.frequency[below[0]]) if below.size else float("nan")


def transient_response(
    time: Floats, given: Floats, answer: Floats, *, frequencies: Floats
) -> FrequencyResponse:
    """Return the response of a transient at frequencies inside the spectrum of its input.

    Parameters
    ----------
    time
        Times at equal distances, shape (n_times,) [s].
    given, answer
        Input and output, zero before the transient, shape (n_times,).
    frequencies
        Where the response is wanted [Hz].

    Raises
    ------
    InputError
        If the input does not excite a frequency.
    """
    spectra = [_transform(time, values, frequencies) for values in (given, answer)]
    weakest = float(np.abs(spectra[0]).min())
    if weakest <= 1e-6 * float(np.abs(given).sum()) * float(time[1] - time[0]):
        k = int(np.argmin(np.abs(spectra[0])))
        raise InputError(f"the steering does not excite {frequencies[k]:.3g} Hz; no response there")
    largest = float(np.abs(answer).max())
    leftover = abs(float(answer[-1])) / largest if largest > 0.0 else 0.0
    return FrequencyResponse(frequencies, spectra[1] / spectra[0], leftover)


def _transform(time: Floats, values: Floats, frequencies: Floats) -> NDArray[np.complex128]:
    """Return the Fourier integral of samples by the trapezoidal rule, shape (n_frequencies,)."""
    step = float(time[1] - time[0])
    weights = np.full(len(time), step)
    weights[[0, -1]] *= 0.5
    turns = np.exp(-2j * np.pi * np.outer(frequencies, time))
    return np.asarray(turns @ (weights * values))
