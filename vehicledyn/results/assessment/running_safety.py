"""Running safety and track loading from the forces Y and Q of wheels on rails, after EN 14363.

Y is the force of a wheel on its rail to the left, Q that downwards; for a single wheel Y counts
outwards, where its flange climbs. All are low-pass filtered at 20 Hz. Sliding means are taken
over 2 m of track, in steps of 0.5 m. Extremes are the 0.15 % and 99.85 % percentiles, quasi-static
values the medians.

References
----------
EN 14363:2016 and UIC 518:2009, tables of the assessment quantities and their processing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.results.assessment.even_samples import EvenSamples
from vehicledyn.results.assessment.filters import butterworth, filtered_section
from vehicledyn.results.assessment.signal import Floats, Signal, combined, stored
from vehicledyn.results.assessment.sliding import sliding_mean

CUT_OFF, ORDER = 20.0, 4
"""Low-pass filter: cut-off frequency [Hz] and order, 24 dB an octave."""
WINDOW, EVERY = 2.0, 0.5
"""Sliding means: length and step [m]."""
LOW, HIGH = 0.15, 99.85
"""Percentiles of the extremes [%]."""

_STRAIGHT = 1e-5
"""Curvature below which a track counts as straight [1/m]."""
_LEVEL = 1e-3
"""Cant below which a track counts as level [m]."""
_LONG_ENOUGH = 0.2
"""Time on straight track that gives the static load [s]."""
_LIFTED = 0.01
"""Part of its static load below which a wheel counts as lifted: Y/Q means nothing [1]."""


@dataclass(frozen=True)
class WheelSafety:
    """Figures of one wheel: forces in N, the rest in 1; Y is positive outwards.

    ``vertical_largest`` is the percentile of Q, ``vertical_smallest`` its smallest value, and
    ``unloading`` 1 - Q/Q₀ there. ``lifted`` is the part of the time in which the wheel has no
    load. ``derailment`` is the extreme of the sliding mean of Y/Q, by its magnitude; None where
    it is not known.
    """

    name: str
    static: float
    guiding_quasi_static: float
    vertical_quasi_static: float
    vertical_largest: float
    vertical_smallest: float
    unloading: float
    lifted: float
    derailment: float | None


@dataclass(frozen=True)
class AxleSafety:
    """Sum of Y of a wheelset: extreme of the sliding mean, positive to the left, and limit [N]."""

    name: str
    track_shift: float
    limit: float


def nadal_limit(flange_angle: float, friction: float) -> float:
    """Return the ratio Y/Q above which a wheel climbs the rail [1].

    Y/Q = (tan γ - µ) / (1 + µ tan γ)

    Parameters
    ----------
    flange_angle
        γ, largest contact angle on the flange [rad].
    friction
        µ, coefficient of friction there [1].

    Raises
    ------
    InputError
        If the angle is not between 0 and a right angle or the friction is negative.

    References
    ----------
    Nadal (1896), Annales des Mines.
    """
    if not 0.0 < flange_angle < 0.5 * math.pi or not friction >= 0.0:
        raise InputError(
            f"Nadal's limit: a flange angle of {math.degrees(flange_angle):g}° with a friction of "
            f"{friction:g}; the angle must lie between 0 and 90°, the friction not below 0"
        )
    slope = math.tan(flange_angle)
    return (slope - friction) / (1.0 + friction * slope)


def track_shift_limit(static: float, factor: float = 1.0) -> float:
    """Return the largest sum of guiding forces that the track bears [N].

    ΣY = k (10 kN + 2 Q₀/3)

    Parameters
    ----------
    static
        Q₀, static load of one wheel [N].
    factor
        k, 1 for passenger vehicles, 0.85 for freight [1].

    References
    ----------
    Prud'homme (1967), Revue Générale des Chemins de Fer; EN 14363.
    """
    return factor * (1e4 + 2.0 * static / 3.0)


def static_samples(samples: EvenSamples, axle: str, curvature: Signal | None) -> Signal | None:
    """Return 1 for each sample of a run that shows an axle's static load; None if too few do.

    They are those in which the axle itself is on straight, level track, be they outside the
    section: in curves and on ramps the load of a wheel is another.

    Parameters
    ----------
    samples
        Channels of the run.
    axle
        Its name; "axle.curvature" and "axle.cant" are used where they are known.
    curvature
        Of the track where the vehicle is, for axles that do not know it [1/m]; None if unknown.
    """
    bend = samples.channels.get(f"{axle}.curvature", curvature)
    if bend is None:
        return None
    even = combined(lambda values: 1.0 * (np.abs(values) < _STRAIGHT), bend)
    cant = samples.channels.get(f"{axle}.cant")
    if cant is not None:
        even = combined(lambda known, values: known * (np.abs(values) < _LEVEL), even, cant)
    count = sum(int(np.count_nonzero(block)) for block in even.blocks())
    return even if count * samples.step >= _LONG_ENOUGH else None


def static_load(samples: EvenSamples, wheels: tuple[str, ...], even: Signal | None) -> float:
    """Return the static load Q₀ of each wheel of an axle: the mean of their median loads [N].

    Parameters
    ----------
    samples
        Channels of the run.
    wheels
        Those of the axle.
    even
        Other than 0 for samples to take, one a time of the run; those of the section if absent.
    """
    return float(np.mean([_chosen(samples, f"{wheel}.Q", even).median() for wheel in wheels]))


def _chosen(samples: EvenSamples, name: str, even: Signal | None) -> Signal:
    if even is None:
        return samples.section(name)
    pairs = zip(samples.channels[name].blocks(), even.blocks(), strict=True)
    return stored(values[taken != 0.0] for values, taken in pairs)


def assess_wheel(
    name: str, samples: EvenSamples, distance: Signal | None, static: float
) -> WheelSafety:
    """Return the figures of a wheel with channels "name.Y" and "name.Q".

    Parameters
    ----------
    name
        Wheel, such as "front.left".
    samples
        Channels of the run.
    distance
        Way along the track of the section's samples, not falling, shape (n,) [m]; None if unknown.
    static
        Static load Q₀ [N].
    """
    guiding, vertical = (_smooth(samples, f"{name}.{force}") for force in ("Y", "Q"))
    guiding = combined(np.negative, guiding) if name.endswith(".right") else guiding
    has_load = sum(int(np.count_nonzero(q > _LIFTED * static)) for q in vertical.blocks())
    median, largest = vertical.percentiles(50.0, HIGH)
    smallest = vertical.smallest()
    ratio = None
    if distance is not None and has_load == vertical.count:
        ratio = _extreme(distance, combined(np.divide, guiding, vertical))
    return WheelSafety(
        name=name,
        static=static,
        guiding_quasi_static=guiding.median(),
        vertical_quasi_static=median,
        vertical_largest=largest,
        vertical_smallest=smallest,
        unloading=1.0 - smallest / static,
        lifted=1.0 - has_load / vertical.count,
        derailment=ratio,
    )


def assess_axle(
    name: str, samples: EvenSamples, distance: Signal, static: float, wheels: tuple[str, ...]
) -> AxleSafety | None:
    """Return the sum of the guiding forces of an axle's wheels; None if the way is too short."""
    total = combined(total_of, *(_smooth(samples, f"{wheel}.Y") for wheel in wheels))
    extreme = _extreme(distance, total)
    return None if extreme is None else AxleSafety(name, extreme, track_shift_limit(static))


def total_of(*parts: Floats) -> Floats:
    """Return the sum of the values of several channels."""
    return np.asarray(np.sum(parts, axis=0))


def extreme_of(values: Signal) -> float:
    """Return the percentile, low or high, of larger magnitude."""
    low, high = values.percentiles(LOW, HIGH)
    return low if abs(low) > abs(high) else high


def _smooth(samples: EvenSamples, channel: str) -> Signal:
    low_pass = butterworth(CUT_OFF, ORDER)
    return filtered_section(samples.channels[channel], samples.step, low_pass, samples.kept)


def _extreme(distance: Signal, values: Signal) -> float | None:
    """Return the extreme of the sliding means, None without any."""
    means = sliding_mean(distance, values, window=WINDOW, every=EVERY).mean
    return extreme_of(means) if means.count else None
