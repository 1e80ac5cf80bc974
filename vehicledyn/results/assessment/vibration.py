"""Vibration of a seated person by ISO 2631-1: weighted accelerations, running rms, dose."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from vehicledyn.results.assessment.comfort import DIRECTIONS
from vehicledyn.results.assessment.even_samples import EvenSamples
from vehicledyn.results.assessment.filters import filtered_section
from vehicledyn.results.assessment.signal import Signal, combined
from vehicledyn.results.assessment.sliding import sliding_mean
from vehicledyn.results.assessment.weighting import W_D, W_K, Weighting

WINDOW = 1.0
"""Time over which the running root mean square is taken [s]."""
HIGHEST = 80.0
"""Frequency up to which the standard weights vibration [Hz]."""
LARGEST_CREST = 9.0
"""Crest factor above which the root mean square alone underrates the vibration [1]."""

_WEIGHTINGS: Mapping[str, Weighting] = {"longitudinal": W_D, "lateral": W_D, "vertical": W_K}
_REACTIONS = (
    ("not uncomfortable", 0.0, 0.315),
    ("a little uncomfortable", 0.315, 0.63),
    ("fairly uncomfortable", 0.5, 1.0),
    ("uncomfortable", 0.8, 1.6),
    ("very uncomfortable", 1.25, 2.5),
    ("extremely uncomfortable", 2.0, math.inf),
)


@dataclass(frozen=True)
class AxisVibration:
    """Weighted acceleration in one direction at a seat.

    ``rms`` is its root mean square over the section [m/s²], ``dose`` the fourth power vibration
    dose value VDV [m/s^1.75], ``transient`` the maximum transient vibration value MTVV, the
    largest root mean square of 1 s, NaN in a shorter section [m/s²]; ``crest_factor`` is the
    largest value over the rms, NaN where nothing vibrates [1].
    """

    rms: float
    dose: float
    transient: float
    crest_factor: float


@dataclass(frozen=True)
class Vibration:
    """Vibration at one seat by direction, and the total value a_v of all three [m/s²]."""

    name: str
    axes: Mapping[str, AxisVibration]
    total: float | None

    @property
    def reaction(self) -> str:
        """What passengers of public transport say of the total value, as the bands overlap."""
        value = self.total or 0.0
        return " to ".join(text for text, low, high in _REACTIONS if low <= value < high)


def assess_vibration(name: str, samples: EvenSamples) -> Vibration:
    """Return the vibration at a sensor with channels "name.vertical" and the like.

    a_w = (1/T ∫ a_w²(t) dt)^½,  VDV = (∫ a_w⁴(t) dt)^¼,  MTVV = max (1/τ ∫_{t-τ}^{t} a_w² dt)^½
    with τ = 1 s, and a_v² = a_wx² + a_wy² + a_wz², weighted by W_d horizontally and by W_k
    vertically: comfort of a seated person, on the seat, all factors k = 1. Directions without a
    channel are left out, and with them the total.

    References
    ----------
    ISO 2631-1:1997, Mechanical vibration and shock - Evaluation of human exposure to whole-body
    vibration: basic evaluation by weighted rms acceleration, running rms method, fourth power
    vibration dose method, and the guide to effects on comfort.
    """
    axes = {d: _axis(f"{name}.{d}", _WEIGHTINGS[d], samples)
            for d in DIRECTIONS if f"{name}.{d}" in samples.channels}  # fmt: skip
    whole = math.hypot(*(axis.rms for axis in axes.values()))
    return Vibration(name, axes, whole if len(axes) == len(DIRECTIONS) else None)


def vibration_remarks(found: Vibration, samples: EvenSamples) -> Iterator[str]:
    """Yield what limits the figures of a seat."""
    if 0.5 * samples.rate < HIGHEST:
        yield (
            f"{found.name}: {samples.rate:.4g} samples a second hold vibration up to "
            f"{0.5 * samples.rate:.3g} Hz; ISO 2631-1 weights it up to {HIGHEST:g} Hz: set "
            "output.interval to 5 ms"
        )
    for direction, axis in found.axes.items():
        if axis.crest_factor > LARGEST_CREST:
            yield (
                f"{found.name}: the crest factor of its {direction} vibration, "
                f"{axis.crest_factor:.3g}, is above {LARGEST_CREST:g}: judge by MTVV and VDV"
            )


def _axis(channel: str, weighting: Weighting, samples: EvenSamples) -> AxisVibration:
    weighted = filtered_section(samples.channels[channel], samples.step, weighting, samples.kept)
    rms = math.sqrt(weighted.mean_square())
    dose = sum(float(np.sum(block**4)) for block in weighted.blocks()) * samples.step
    largest = max(float(np.abs(block).max()) for block in weighted.blocks())
    crest = largest / rms if rms > 0.0 else math.nan
    return AxisVibration(rms, dose**0.25, _transient(weighted, samples.step), crest)


def _transient(weighted: Signal, step: float) -> float:
    """Return the largest root mean square over a window of 1 s; NaN in a shorter signal."""
    every = WINDOW / max(round(WINDOW / step), 1)
    time = Signal(weighted.count, lambda a, b: np.asarray(step * np.arange(a, b)))
    squares = combined(lambda values: values**2, weighted)
    means = sliding_mean(time, squares, window=WINDOW, every=every).mean
    return math.sqrt(max(means.highest()[1], 0.0)) if means.count else math.nan
