"""Samples on their way to a file, in blocks of some rows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class SampleBlock(NamedTuple):
    """Times, shape (n,) [s], and channels and states, shape (n, ...), of some samples."""

    times: Floats
    channels: Floats
    states: Floats


def checked_block(
    times: Floats, channels: Floats, states: Floats | None, widths: tuple[int, int], last: float
) -> SampleBlock:
    """Return a copy of samples of the right widths behind a last time [s], else a ValueError."""
    instants = np.array(times, dtype=float)
    table = np.array(channels, dtype=float)
    further = np.empty((len(instants), 0)) if states is None else np.array(states, dtype=float)
    for values, width in zip((table, further), widths, strict=True):
        if values.shape != (len(instants), width):
            raise ValueError(f"shape {values.shape}, expected {(len(instants), width)}")
    if np.any(np.diff(instants, prepend=last) < 0.0):
        raise ValueError("time runs backwards")
    return SampleBlock(instants, table, further)
