"""Ride comfort: mean and continuous comfort of EN 12299, and Sperling's ride index."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from vehicledyn.results.assessment.even_samples import EvenSamples
from vehicledyn.results.assessment.filters import filtered_section
from vehicledyn.results.assessment.signal import Floats
from vehicledyn.results.assessment.sliding import block_rms
from vehicledyn.results.assessment.weighting import LATERAL, VERTICAL, W_B, W_D, Sperling

DIRECTIONS = ("longitudinal", "lateral", "vertical")
WINDOW = 5.0
"""Length of the windows of EN 12299 [s]."""
WINDOWS = 60
"""Number of windows that EN 12299 asks for."""

_WEIGHTINGS = {"longitudinal": W_D, "lateral": W_D, "vertical": W_B}
_FACTORS = {"lateral": LATERAL, "vertical": VERTICAL}


@dataclass(frozen=True)
class Comfort:
    """Comfort at one accelerometer.

    ``continuous`` holds the weighted root mean squares of the windows by direction,
    shape (n_windows,) [m/s²]; ``mean`` is N_MV [1], None where a direction is unknown;
    ``sperling`` is W_z by direction [1].
    """

    name: str
    continuous: Mapping[str, Floats]
    mean: float | None
    sperling: Mapping[str, float]


def assess_comfort(name: str, samples: EvenSamples) -> Comfort:
    """Return the comfort at an accelerometer with channels "name.lateral" and the like.

    Directions without a channel are left out.
    """
    known = {d: f"{name}.{d}" for d in DIRECTIONS if f"{name}.{d}" in samples.channels}
    continuous = {
        direction: block_rms(
            filtered_section(
                samples.channels[channel], samples.step, _WEIGHTINGS[direction], samples.kept
            ),
            samples.step,
            WINDOW,
        )
        for direction, channel in known.items()
    }
    mean = mean_comfort(continuous) if len(continuous) == len(DIRECTIONS) else None
    indices = {
        direction: ride_index(samples, channel, _FACTORS[direction])
        for direction, channel in known.items()
        if direction in _FACTORS
    }
    return Comfort(name, continuous, mean, indices)


def mean_comfort(continuous: Mapping[str, Floats]) -> float:
    """Return the mean comfort N_MV [1] from weighted root mean squares of windows of 5 s.

    N_MV = 6 √(a_XP95² + a_YP95² + a_ZP95²), with the 95th percentiles of the windows [m/s²], each
    of shape (n_windows,).

    References
    ----------
    EN 12299:2009, mean comfort standard method, on the floor.
    """
    percentiles = [float(np.percentile(values, 95.0)) for values in continuous.values()]
    return 6.0 * math.hypot(*percentiles)


def ride_index(samples: EvenSamples, channel: str, factor: float) -> float:
    """Return Sperling's ride index W_z for comfort [1].

    W_z = (2 ∫ B² G df)^0.15 with the power spectral density G of the acceleration in cm²/s³,
    which for one sine of amplitude a is W_z = (a B)^0.3, a in cm/s².

    References
    ----------
    Garg, Dukkipati (1984), Dynamics of Railway Vehicle Systems; the factor of the root mean
    square in m/s² is there rounded to 4.42 = (100 √2)^0.3.
    """
    weighted = filtered_section(
        samples.channels[channel], samples.step, Sperling(factor), samples.kept
    )
    return float((2e4 * weighted.mean_square()) ** 0.15)
