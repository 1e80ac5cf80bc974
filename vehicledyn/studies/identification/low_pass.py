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
        from scipy.linalg import expm
        from scipy.signal import butter, tf2ss

        a, b, c, _ = tf2ss(*butter(self.order, 1.0, analog=True))
        steps = 2.0 * np.pi * self.frequency * np.diff(times)
        usual = float(np.median(steps))
        known: dict[float, Floats] = {}
        out, state = np.array(values, dtype=float), np.zeros((self.order, values.shape[1]))
        shifted = values - values[0]
        for k, step in enumerate(steps):
            own = usual if abs(step - usual) <= 1e-9 * usual else float(step)
            if own not in known:
                # The states, the signal, and by how much it grows in the step.
                flow = np.zeros((self.order + 2, self.order + 2))
                flow[: self.order, : self.order + 1] = own * np.hstack([a, b])
                flow[self.order, self.order + 1] = 1.0
                known[own] = expm(flow)[: self.order]
            grown = shifted[k + 1 : k + 2] - shifted[k : k + 1]
            state = known[own] @ np.vstack([state, shifted[k : k + 1], grown])
            out[k + 1] = values[0] + (c @ state)[0]
        return out
