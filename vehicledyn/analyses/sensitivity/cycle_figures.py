"""Figures of one limit cycle with their derivatives by parameters: period, extremes, means."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.periodic.orbit_slopes import (
    ChannelValues,
    OrbitSlopes,
    ParameterSlopes,
    slopes_at,
)

Floats = NDArray[np.float64]
Figure = tuple[float, Floats]

_BEHIND = 4
"""Points an interval at which extremes are looked for."""
_PLACE = 1e-12
"""Part of the period to which the time of an extreme is found."""


class CycleFigures:
    """Figures of a cycle, each with its derivatives (n_parameters,).

    Parameters
    ----------
    slopes
        Derivatives of the rates and of the channels asked for.
    orbit, along
        The cycle, and how it follows the parameters.
    """

    def __init__(self, slopes: ParameterSlopes, orbit: Orbit, along: OrbitSlopes) -> None:
        self._slopes, self._orbit, self._along = slopes, orbit, along

    def of(self, kind: str, channel: int | None) -> Figure:
        """Return a figure, of a channel by its number among those asked for or of the whole."""
        return self.whole(kind) if channel is None else self.of_channel(kind, channel)

    def size(self, kind: str, channel: int | None) -> float:
        """Return what a figure is measured by: itself, or the largest value of its channel."""
        if channel is None:
            return abs(self.whole(kind)[0])
        return max(abs(self._extremes[channel, top][0]) for top in (False, True))

    def whole(self, kind: str) -> Figure:
        """Return the period [s] or the frequency [Hz]."""
        period, slope = self._orbit.period, self._along.period
        if kind == "cycle_period":
            return period, slope
        return 1.0 / period, -slope / period**2

    def of_channel(self, kind: str, channel: int) -> Figure:
        """Return a figure of a channel, by its number among those asked for."""
        if kind in ("cycle_mean", "cycle_rms"):
            return self._averaged(kind, channel)
        if kind in ("cycle_max", "cycle_min"):
            return self._extremes[channel, kind == "cycle_max"]
        (low, by_low), (high, by_high) = (self._extremes[channel, top] for top in (False, True))
        return 0.5 * (high - low), 0.5 * (by_high - by_low)

    def _averaged(self, kind: str, channel: int) -> Figure:
        """Return the mean over a period, or the root of that of the square."""
        found, moved = self._gauss
        weights = (self._orbit.widths[:, None] * self._orbit.basis.weights).ravel()
        values, change = found.values[:, channel], moved[:, channel]
        if kind == "cycle_mean":
            return float(weights @ values), weights @ change
        size = math.sqrt(float(weights @ values**2))
        slope = weights @ (values[:, None] * change)
        return size, slope / size if size > 0.0 else np.full(len(slope), np.nan)

    @cached_property
    def _gauss(self) -> tuple[ChannelValues, Floats]:
        """The channels at the Gauss points and their derivatives."""
        orbit = self._orbit
        return self._at(orbit.times_of(orbit.mesh)[1])

    @cached_property
    def _extremes(self) -> dict[tuple[int, bool], Figure]:
        """Minimum and maximum of each channel, where it does not change with the phase."""
        orbit = self._orbit
        parts = np.arange(_BEHIND) / _BEHIND
        places = (orbit.mesh[:-1, None] + orbit.widths[:, None] * parts).ravel()
        values, _ = self._values(places)
        found = {}
        for channel in range(values.shape[1]):
            for top in (False, True):
                column = values[:, channel] if top else -values[:, channel]
                place = self._place(places, int(column.argmax()), channel)
                shown, moved = self._at(np.array([place]))
                found[channel, top] = float(shown.values[0, channel]), moved[0, channel]
        return found

    def _place(self, places: Floats, index: int, channel: int) -> float:
        """Return where a channel stands still beside a place, part of the period."""
        from scipy.optimize import brentq

        count = len(places)
        low = places[index - 1] - (1.0 if index == 0 else 0.0)
        high = places[(index + 1) % count] + (1.0 if index == count - 1 else 0.0)

        def rate(place: float) -> float:
            return float(self._values(np.array([place % 1.0]))[1][0, channel])

        if not rate(low) * rate(high) < 0.0:
            return float(places[index])
        return float(brentq(rate, low, high, xtol=_PLACE)) % 1.0

    def _values(self, places: Floats) -> tuple[Floats, Floats]:
        """Return channels and their rates at places, each (n_points, n_channels)."""
        orbit, slopes = self._orbit, self._slopes
        states, unknowns = orbit.sample(places)
        found = slopes.channels(states, unknowns, orbit.parameter)
        rates = slopes.field.evaluate(states, found.unknowns, orbit.parameter).rates
        return found.values, np.einsum("qcs,qs->qc", found.by_state, rates)

    def _at(self, places: Floats) -> tuple[ChannelValues, Floats]:
        """Return channels at places, and their derivatives with the orbit's own change."""
        states, unknowns = self._orbit.sample(places)
        found = self._slopes.channels(states, unknowns, self._orbit.parameter)
        change = slopes_at(self._orbit, self._along.states, places)
        return found, found.by_state @ change + found.by_parameter
