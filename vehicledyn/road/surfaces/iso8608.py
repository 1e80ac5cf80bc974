"""Random roads by the classes of ISO 8608, with two tracks that know of each other."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator
from scipy.special import gamma, kv, ndtri

from vehicledyn.base.numbers.random_waves import random_phases, summed_waves
from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic.grids import GridTable
from vehicledyn.symbolic.ops import Scalar

CLASSES = {name: 16e-6 * 4.0**index for index, name in enumerate("ABCDEFGH")}
"""Gd(n0) of the classes, geometric means of their limits [m³]; ISO 8608:2016, table C.1."""

REFERENCE_FREQUENCY = 0.1
"""n0 [1/m]."""

LOWEST, HIGHEST = 0.011, 2.83
"""Range of spatial frequencies in which the classes hold [1/m]."""

_STEP = 0.05
_REPEAT = 4.0 / LOWEST
_MOST_LENGTH = 50_000.0
_STREAMS = (8608, 1), (8608, 2)


@register("road", "iso8608")
class Iso8608Road(RoadSurface):
    """Random ground with the spectrum Gd(n) = Gd(n0) (n / n0)^-w of a class of ISO 8608.

    Waves of all multiples of a lowest frequency with random phases add up, so that every record
    has the spectrum of its class. The heights of the two tracks are coherent as on ground that is
    the same in all directions, or as chosen; between and beside them the ground is straight
    across. The ground fades in and out smoothly and is level before and after.
    """

    in_equations: ClassVar[bool] = True

    road_class: Literal["A", "B", "C", "D", "E", "F", "G", "H"] | None = Field(
        default=None, description="Class, very good (A) to very poor; or give roughness"
    )
    roughness: float | None = quantity(
        "m^3", "Gd(n0) at 0.1 waves a metre, in place of a class", gt=0, default=None
    )
    waviness: float = quantity("1", "Exponent w of the spectrum", default=2.0, gt=1, le=4)
    length: float = quantity("m", "Length of the rough ground", gt=0, le=_MOST_LENGTH)
    start: float = quantity("m", "World x where it begins", default=0.0)
    fade: float = quantity("m", "Length over which it fades in and out", ge=0, default=5.0)
    track: float = quantity("m", "Distance of the two tracks across", gt=0, default=1.5)
    coherence: Literal["isotropic", "equal", "independent"] = Field(
        default="isotropic",
        description="Of the two tracks: as on isotropic ground, the same, or none",
    )
    seed: int = Field(default=1, ge=0, le=2**32 - 1, description="Which of all such roads")

    @model_validator(mode="after")
    def _check(self) -> Iso8608Road:
        """Refuse a road without a roughness, or with two, and fades that meet."""
        if (self.road_class is None) == (self.roughness is None):
            raise ValueError("give either road_class or roughness")
        if 2.0 * self.fade > self.length:
            raise ValueError("fade: longer than half the road")
        return self

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        return _grid(self.model_dump_json()).value(x, y)

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the slopes along x and y [1]."""
        return _grid(self.model_dump_json()).slopes(x, y)


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


def tracks(road: Iso8608Road) -> NDArray[np.float64]:
    """Return the heights of the right and the left track at steps of 50 mm, shape (n, 2) [m]."""
    needed = math.ceil(road.length / _STEP)
    count = max(needed, math.ceil(_REPEAT / _STEP))
    count += count % 2
    whole = count * _STEP
    first, last = math.ceil(LOWEST * whole), math.floor(HIGHEST * whole)
    frequency = np.arange(first, last + 1) / whole
    roughness = road.roughness if road.road_class is None else CLASSES[road.road_class]
    assert roughness is not None
    amplitude = np.sqrt(2.0 * spectrum(roughness, road.waviness, frequency) / whole)
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
def _grid(text: str) -> GridTable:
    """Return the ground of a road's parameters."""
    road = Iso8608Road.model_validate_json(text)
    heights = tracks(road)
    along = _STEP * np.arange(len(heights))
    if road.fade > 0.0:
        share = np.clip(np.minimum(along, along[-1] - along) / road.fade, 0.0, 1.0)
        heights = heights * (share**3 * (10.0 + share * (6.0 * share - 15.0)))[:, None]
    sides = np.array([-0.5 * road.track, 0.5 * road.track])
    return GridTable("road", road.start, _STEP, sides, heights)
