"""Frequency weightings of accelerations that people feel: W_b, W_c, W_d, W_k, and Sperling's B.

Each W is a product of four transfer functions of the angular frequency s = 2πi f::

    high-pass   s² / (s² + ω₁ s/Q₁ + ω₁²)
    low-pass    ω₂² / (s² + ω₂ s/Q₁ + ω₂²),                    Q₁ = 1/√2
    transition  (1 + s/ω₃) / (1 + s/(Q₂ ω₄) + (s/ω₄)²)
    step        K (1 + s/(Q₃ ω₅) + (s/ω₅)²) / (1 + s/(Q₄ ω₆) + (s/ω₆)²)

W_c and W_d have no step. Two sets of numbers are in use for the vertical: EN 12299 has those of
UIC 513 and ENV 12299, ISO 8041 those of ISO 2631-4 and BS 6841. They differ by up to 12 %, at
16 Hz; N_MV of EN 12299 takes its own.

References
----------
EN 12299:2009, annex C, as open implementations hold it; ISO 8041:2005, table of parameters, as
makers of vibration meters print it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.assessment.signal import Floats

LATERAL, VERTICAL = 0.737, 0.588
"""Factors of Sperling's weighting [1]."""

SPERLING_BAND = (0.5, 30.0)
"""Frequencies that Sperling's index looks at [Hz]."""


@dataclass(frozen=True)
class UpwardStep:
    """The upward step of a weighting: frequencies f₅, f₆ [Hz], qualities Q₃, Q₄ and gain K [1]."""

    low: float
    low_quality: float
    high: float
    high_quality: float
    gain: float


@dataclass(frozen=True)
class Weighting:
    """A weighting W: its name, frequencies f₃ = f₄ [Hz] and quality Q₂ [1] of the transition."""

    name: str
    transition: float
    quality: float
    step: UpwardStep | None = None

    def __call__(self, frequency: Floats) -> NDArray[np.complex128]:
        """Return the complex gain at frequencies [Hz], shape (n,) [1]."""
        s = 1j * np.asarray(frequency, dtype=float)
        gain = s**2 / _quadratic(s, _HIGH_PASS, _FLAT) / _HIGH_PASS**2
        gain = gain / _quadratic(s, _LOW_PASS, _FLAT)
        gain = gain * (1.0 + s / self.transition) / _quadratic(s, self.transition, self.quality)
        if self.step is not None:
            up = _quadratic(s, self.step.low, self.step.low_quality)
            down = _quadratic(s, self.step.high, self.step.high_quality)
            gain = self.step.gain * gain * up / down
        return np.asarray(gain, dtype=complex)


_HIGH_PASS, _LOW_PASS, _FLAT = 0.4, 100.0, 1.0 / math.sqrt(2.0)

W_B = Weighting("W_b", 16.0, 0.63, UpwardStep(2.5, 0.8, 4.0, 0.8, 0.4))
"""Vertical, EN 12299."""
W_B_ISO = Weighting("W_b", 16.0, 0.55, UpwardStep(2.5, 0.9, 4.0, 0.95, 0.4))
"""Vertical, ISO 2631-4; ISO 8041 writes its gain as 1.024 = 0.4 (f₆/f₅)²."""
W_K = Weighting("W_k", 12.5, 0.63, UpwardStep(2.37, 0.91, 3.35, 0.91, (2.37 / 3.35) ** 2))
"""Vertical on the seat, ISO 2631-1."""
W_C = Weighting("W_c", 8.0, 0.63)
"""Forward at the back of a seat, EN 12299 and ISO 2631-1."""
W_D = Weighting("W_d", 2.0, 0.63)
"""Forward and sideways on floor and seat, EN 12299 and ISO 2631-1."""


@dataclass(frozen=True)
class Sperling:
    """Sperling's weighting for comfort, with the factor k LATERAL or VERTICAL.

    B = k √((1.911 f² + (0.25 f²)²) / ((1 - 0.277 f²)² + (1.563 f - 0.0368 f³)²)).

    B is the magnitude of a rational function of i f, which gives it a phase. Nothing passes
    outside the band.
    """

    factor: float

    def __call__(self, frequency: Floats) -> NDArray[np.complex128]:
        """Return the complex gain at frequencies [Hz], shape (n,) [1]."""
        f = np.asarray(frequency, dtype=float)
        above = 1j * math.sqrt(1.911) * f - 0.25 * f**2
        below = 1.0 - 0.277 * f**2 + 1j * (1.563 * f - 0.0368 * f**3)
        inside = (f >= SPERLING_BAND[0]) & (f <= SPERLING_BAND[1])
        return np.where(inside, self.factor * above / below, 0.0)


def _quadratic(
    s: NDArray[np.complex128], frequency: float, quality: float
) -> NDArray[np.complex128]:
    place = s / frequency
    return np.asarray(1.0 + place / quality + place**2)
