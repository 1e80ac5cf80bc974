"""Random records of a given spectrum: sums of waves with random phases."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def random_phases(count: int, stream: tuple[int, ...]) -> Array:
    """Return phases drawn evenly from 0 to 2π, the same everywhere for the same stream [rad]."""
    generator = np.random.Generator(np.random.PCG64(np.random.SeedSequence(stream)))
    return generator.uniform(0.0, 2.0 * np.pi, count)


def summed_waves(waves: NDArray[np.complex128], first: int, count: int) -> Array:
    """Return a record of waves Re(w exp(i k 2π s / L)), k from ``first`` on, shape (count + 1,).

    The last value is the first again.
    """
    whole = np.zeros(count // 2 + 1, dtype=complex)
    whole[first : first + len(waves)] = 0.5 * count * waves
    record = np.fft.irfft(whole, count)
    return np.append(record, record[0])


def synthesise(
    spectrum: Array, first: int, *, length: float, count: int, stream: tuple[int, int]
) -> Array:
    """Return a record whose one-sided spectrum is given, shape (count + 1,) [m].

    The sum of waves √(2 S ΔΩ) cos(Ω s + φ) with phases φ drawn evenly from 0 to 2π by the bit
    generator PCG64: the same seed gives the same record everywhere, but for rounding. The
    variance is that of the spectrum whatever the phases; the record is as good as Gaussian where
    there are many waves.

    Parameters
    ----------
    spectrum
        S at the multiples of ΔΩ = 2π / length from the ``first`` on [m²/(rad/m)].
    first
        Number of the first multiple.
    length, count
        Length of the record, after which it repeats, and number of steps in it [m, 1].
    stream
        Seed, and the number of the quantity: all quantities are independent of each other.
    """
    phases = random_phases(len(spectrum), stream)
    amplitudes = np.sqrt(2.0 * spectrum * (2.0 * np.pi / length))
    return summed_waves(amplitudes * np.exp(1j * phases), first, count)
