"""What to change in a study whose search found no optimum."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.linear_file import Quantity

Floats = NDArray[np.float64]

_SLIP, _BEYOND = ".longitudinal_slip", 0.3
"""Ending of the channels of a wheel's slip, and a slip beyond the peak of any tyre's force."""


def slip_advice(
    channels: Sequence[Quantity], values: Floats, limited: Collection[str]
) -> list[str]:
    """Return a warning where the last motion of a search has wheels that lock or spin.

    Parameters
    ----------
    channels, values
        Those of the motion and their values over time, (n_times, n_channels) in SI.
    limited
        Names that the study limits.
    """
    slips = {
        item.name: float(np.abs(column).max(initial=0.0))
        for item, column in zip(channels, values.T, strict=True)
        if item.name.endswith(_SLIP) and item.name not in limited
    }
    if not slips or max(slips.values()) < _BEYOND:
        return []
    worst = max(slips, key=lambda name: slips[name])
    return [
        f"warning: {worst} reaches {slips[worst]:.2g} in the last motion, beyond the peak of the "
        "tyre's force, where wheels lock or spin and a search goes astray; limit the slips of "
        f"braked and driven wheels, such as 'limits: {{{worst}: {{from: -0.12, to: 0.12}}}}'"
    ]
