"""The low-pass that a sensor sends its signal through, applied to what a model foretells."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MOST_ORDER = 8
"""Highest order of a filter."""


class LowPass(NamedTuple):
    """A Butterworth filter of some order with its corner at a frequency [Hz]."""

    frequency: float
    order: int = 2

    def applied(self, times: Floats, values: Floats) -> Floats:
        """Return signals behind the filter, which is at rest with their first values.

        Exact for signals that are straight lines between their samples (first-order hold); linear,
        so that derivatives pass through it as the signals do.

        Parameters
        ----------
        times
            Growing times of the samples, shape (m,) [s].
        values
            Signals, shape (m, n).
        """
        from scipy.signal import butter, cont2discrete, tf2ss

        system = tf2ss(*butter(self.order, 1.0, analog=True))
        steps = 2.0 * np.pi * self.frequency * np.diff(times)
        usual = float(np.median(steps))
        known: dict[float, tuple[Floats, ...]] = {}
        out, state = np.array(values, dtype=float), np.zeros((self.order, values.shape[1]))
        shifted = values - values[0]
        for k, step in enumerate(steps):
            own = usual if abs(step - usual) <= 1e-9 * usual else float(step)
            if own not in known:
                known[own] = cont2discrete(system, own, method="foh")[:4]
            a, b, c, d = known[own]
            # This state lags by one sample: the next output needs the next input.
            state = a @ state + b @ shifted[k : k + 1]
            out[k + 1] = values[0] + (c @ state + d @ shifted[k + 1 : k + 2])[0]
        return out
