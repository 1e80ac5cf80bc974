"""Figures of a mode with their derivatives, from those of its eigenvalue."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.linear_file import Quantity

Found: TypeAlias = list[tuple[Quantity, float, NDArray[np.float64]]]
"""Figures with their values and derivatives, shape (n_parameters,)."""


def mode_figures(number: int, value: complex, slope: Any) -> Found:
    """Return growth of a mode and, of an oscillation, its frequencies and damping.

    With λ = a + ib, d|λ| = Re(λ* dλ) / |λ| and d(-a / |λ|) = b Im(λ* dλ) / |λ|³.

    Parameters
    ----------
    number
        Number of the mode, in its name.
    value, slope
        Eigenvalue [1/s] and its derivatives by all parameters, shape (n_parameters,).
    """
    name, words = f"mode_{number}", f"of mode {number}"
    found: Found = [
        (Quantity(f"{name}.growth", "1/s", f"Real part {words}"), value.real, slope.real)
    ]
    if not value.imag:
        return found
    turns, size, along = 2.0 * np.pi, abs(value), np.conj(value) * slope
    frequency = Quantity(f"{name}.frequency", "Hz", f"Frequency {words}, as it is damped")
    undamped = Quantity(f"{name}.undamped_frequency", "Hz", f"Undamped frequency {words}")
    damping = Quantity(f"{name}.damping_ratio", "1", f"Damping ratio {words}")
    return [
        *found,
        (frequency, value.imag / turns, slope.imag / turns),
        (undamped, size / turns, along.real / size / turns),
        (damping, -value.real / size, value.imag * along.imag / size**3),
    ]
