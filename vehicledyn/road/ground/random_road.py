"""Random records of road heights with the spectrum of ISO 8608, for two tracks."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.special import gamma, kv, ndtri

from vehicledyn.base.numbers.random_waves import random_phases, summed_waves
from vehicledyn.symbolic.grids.grid_table import GridTable

REFERENCE_FREQUENCY = 0.1
"""n0 [1/m]."""

LOWEST, HIGHEST = 0.011, 2.83
"""Range of spatial frequencies in which the classes hold [1/m]."""

ROUNDING = 0.05
"""Half of the width inside of each track over which the ground becomes level [m]."""

_STEP = 0.05
_REPEAT = 4.0 / LOWEST
_STREAMS = (8608, 1), (8608, 2)


@dataclass(frozen=True)
class RandomRoad:
    """What a random road is made from.

    Parameters
    ----------
    roughness, waviness
        Gd(n0) [m³] and exponent w of the spectrum.
    length, start, fade
        Of the rough ground along x [m].
    track
        Distance of the two tracks [m].
    coherence
        Of the two tracks: "isotropic", "equal" or "independent".
    seed
        Which of all such roads.
    """

    roughness: float
    waviness: float
    length: float
    start: float
    fade: float
    track: float
    coherence: str
    seed: int


def spectrum(
    roughness: float, waviness: float, frequency: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the one-sided spectrum Gd(n) [m³] at spatial frequencies n [1/m]."""
    return np.asarray(roughness * (frequency / REFERENCE_FREQUENCY) ** -waviness)


def isotropic_coherence(
    frequency: NDArray[np.float64], distance: float, waviness: float
) -> NDArray[np.float64]:
    """Return the coherence of two tracks on ground alike in all directions [1].

    With the spectrum n^-w the cross spectrum of tracks at a distance B is that of one track times
    2^(1-ν)/Γ(ν) z^ν K_ν(z), z = 2π n B, ν = w/2 (z K₁(z) for w = 2): the integral of the
    surface's spectrum over the frequencies across (Dodds and Robson 1973, J. Sound Vib. 31,
    175-183; solved for a power law).

    Parameters
    ----------
    frequency
        n along the tracks, positive [1/m].
    distance
        B [m].
    waviness
        w, above 1.
    """
    order, z = 0.5 * waviness, 2.0 * math.pi * frequency * distance
    with np.errstate(over="ignore", under="ignore"):
        whole = 2.0 ** (1.0 - order) / gamma(order) * z**order * kv(order, z)
    return np.asarray(np.clip(whole, 0.0, 1.0))


def tracks(road: RandomRoad) -> NDArray[np.float64]:
    """Return the heights of the right and the left track at steps of 50 mm, shape (n, 2) [m]."""
    needed = math.ceil(road.length / _STEP)
    count = max(needed, math.ceil(_REPEAT / _STEP))
    count += count % 2
    whole = count * _STEP
    first, last = math.ceil(LOWEST * whole), math.floor(HIGHEST * whole)
    frequency = np.arange(first, last + 1) / whole
    amplitude = np.sqrt(2.0 * spectrum(road.roughness, road.waviness, frequency) / whole)
    coherence = {"equal": np.ones(len(frequency)), "independent": np.zeros(len(frequency))}.get(
        road.coherence, isotropic_coherence(frequency, road.track, road.waviness)
    )
    phases = random_phases(len(frequency), (road.seed, *_STREAMS[0]))
    lags = _phase_lags(coherence, (road.seed, *_STREAMS[1]))
    sides = [amplitude * np.exp(1j * (phases + sign * 0.5 * lags)) for sign in (-1.0, 1.0)]
    records = np.column_stack([summed_waves(side, first, count) for side in sides])
    return np.asarray(records[: needed + 1])


def _phase_lags(coherence: NDArray[np.float64], stream: tuple[int, ...]) -> NDArray[np.float64]:
    """Return random lags of phase whose mean of exp(i lag) is the coherence [rad].

    They are normal, with a variance of -2 ln(coherence), so that every wave of both tracks keeps
    its amplitude and every record its spectrum.
    """
    with np.errstate(divide="ignore"):
        spread = np.sqrt(-2.0 * np.log(coherence))
    evenly = random_phases(len(coherence), stream)
    normal = np.minimum(spread, 1e3) * ndtri(np.clip(evenly / (2.0 * math.pi), 1e-12, 1 - 1e-12))
    return np.asarray(np.where(coherence < 1e-12, evenly, normal))


@lru_cache(maxsize=8)
def ground(road: RandomRoad) -> GridTable:
    """Return the surface of a random road."""
    heights = tracks(road)
    along = _STEP * np.arange(len(heights))
    if road.fade > 0.0:
        share = np.clip(np.minimum(along, along[-1] - along) / road.fade, 0.0, 1.0)
        heights = heights * (share**3 * (10.0 + share * (6.0 * share - 15.0)))[:, None]
    inset = min(ROUNDING, 0.1 * road.track)
    side = 0.5 * road.track - inset
    sides = np.array([-side, side])
    return GridTable("road", road.start, _STEP, sides, heights, rounding=inset)
