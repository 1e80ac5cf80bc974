"""Equivalent conicity: the cone that would run along a track with the same wavelength.

A free wheelset that rolls slowly, without slip, follows Klingel's equation

    y'' + Δr(y) / (e r) = 0

where Δr is the difference of the rolling radii, left less right for a shift y to the left, e
the distance of the contacts and r the rolling radius in the middle. Multiplied with y' it has an
integral, which gives the wavelength λ of each motion between two turning points, and with it

    tan γ_e = (π/λ)² 2 e r

as a function of the amplitude, half the distance of the turning points. For a cone Δr = 2 γ y,
so that tan γ_e = γ at any amplitude.

References
----------
EN 15302, Railway applications - Method for determining the equivalent conicity: the equation and
its evaluation by integration; harmonic and regression values are named after UIC 519.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.rail.profiles.profile_pieces import Floats

BASE = 1.5
"""Distance e of the contacts on standard gauge, as EN 15302 takes it [m]."""

LEVEL = 2e-8
"""Rolling radius difference that counts as none: twice the last digit of the standard's [m]."""

_NODES = 2000
_HALVINGS = 60
_EDGE = 1e-9


class LateralMotion(NamedTuple):
    """Turning points of a motion and its wavelength [m]."""

    left: float
    right: float
    wavelength: float


class RadiusDifference:
    """Rolling radius difference against lateral shift, linear between the points of a table.

    Parameters
    ----------
    shift
        Increasing lateral shifts y, positive to the left, shape (n,) [m].
    difference
        Radius of the left contact less that of the right, shape (n,) [m].

    Raises
    ------
    InputError
        If the shifts do not increase, a value is not finite, or the difference has no zero from
        which it rises: the wheelset then has no middle to which it returns.
    """

    def __init__(self, shift: Floats, difference: Floats) -> None:
        self.shift = np.asarray(shift, dtype=float)
        self.difference = np.asarray(difference, dtype=float)
        if self.shift.ndim != 1 or self.shift.shape != self.difference.shape or len(shift) < 3:
            raise InputError("equivalent conicity: a table of at least three points is needed")
        if not (np.isfinite(self.shift).all() and np.isfinite(self.difference).all()):
            raise InputError("equivalent conicity: the table holds values that are not finite")
        if not (np.diff(self.shift) > 0.0).all():
            raise InputError("equivalent conicity: the lateral shifts must increase")
        self.middle = self._middle()
        steps = np.diff(self.shift)
        means = 0.5 * (self.difference[1:] + self.difference[:-1])
        self._integral = np.concatenate([[0.0], np.cumsum(steps * means)])

    def at(self, shift: Floats) -> Floats:
        """Return the difference at shifts, shaped like ``shift`` [m]."""
        return np.asarray(np.interp(shift, self.shift, self.difference))

    def integral(self, shift: Floats) -> Floats:
        """Return the integral of the difference from the table's first shift on [m²]."""
        part = np.clip(np.searchsorted(self.shift, shift) - 1, 0, len(self.shift) - 2)
        along = shift - self.shift[part]
        mean = 0.5 * (self.difference[part] + self.at(shift))
        return np.asarray(self._integral[part] + along * mean)

    def _middle(self) -> float:
        """Return the zero, nearest to no shift, at which the difference rises [m].

        Where the difference is none over a stretch, as between cylindrical treads, its middle.
        """
        sign = np.where(np.abs(self.difference) <= LEVEL, 0.0, np.sign(self.difference))
        known = np.flatnonzero(sign)
        rising = np.flatnonzero((sign[known[:-1]] < 0.0) & (sign[known[1:]] > 0.0))
        if len(rising) == 0:
            raise InputError(
                "equivalent conicity: the rolling radius difference has no zero from which it "
                "rises with the shift; the wheelset does not centre itself"
            )
        zeros = [self._zero(int(known[k]), int(known[k + 1])) for k in rising]
        return min(zeros, key=abs)

    def _zero(self, last: int, first: int) -> float:
        """Return the zero between the last point below and the first above none."""
        if first - last > 2:
            return float(0.5 * (self.shift[last + 1] + self.shift[first - 1]))
        low, high = self.difference[last], self.difference[first]
        if first - last == 2:
            between = self.difference[last + 1]
            last, high = (last, between) if between >= 0.0 else (last + 1, high)
            low = self.difference[last]
        share = 0.0 if high == low else -low / (high - low)
        return float(self.shift[last] + share * (self.shift[last + 1] - self.shift[last]))

    def is_level(self, begin: float, end: float) -> bool:
        """Return whether there is no difference between two shifts."""
        inside = self.shift[(self.shift > begin) & (self.shift < end)]
        places = np.concatenate([[begin], inside, [end]])
        return bool((np.abs(self.at(places)) <= LEVEL).all())


def free_path(
    table: RadiusDifference, amplitude: float, base: float, radius: float
) -> LateralMotion | None:
    """Return the motion of an amplitude, None if the table is too short or there is none.

    Its wavelength is infinite where there is no difference over the whole amplitude.

    Parameters
    ----------
    table
        Rolling radius difference.
    amplitude
        Half the distance of the turning points [m].
    base
        Distance e of the contacts [m].
    radius
        Rolling radius r in the middle [m].
    """
    if table.is_level(table.middle - amplitude, table.middle + amplitude):
        return LateralMotion(table.middle + amplitude, table.middle - amplitude, np.inf)
    left = _turning_point(table, amplitude)
    if left is None:
        return None
    angles = (np.arange(_NODES) + 0.5) / _NODES * np.pi - 0.5 * np.pi
    level = float(np.mean(table.integral(np.array([left, left - 2.0 * amplitude]))))
    below = level - table.integral(left - amplitude + amplitude * np.sin(angles))
    if not (below > 0.0).all():
        return None
    speeds = np.sqrt(2.0 / (base * radius) * below)
    half = np.pi / _NODES * np.sum(amplitude * np.cos(angles) / speeds)
    return LateralMotion(left, left - 2.0 * amplitude, 2.0 * float(half))


def _turning_point(table: RadiusDifference, amplitude: float) -> float | None:
    """Return the left turning point: where both have the same integral over the middle."""
    low = max(table.middle, float(table.shift[0]) + 2.0 * amplitude)
    high = min(table.middle + 2.0 * amplitude, float(table.shift[-1]))
    if low > high + _EDGE:
        return None
    high = max(low, high)

    def excess(left: float) -> float:
        ends = table.integral(np.array([left, left - 2.0 * amplitude]))
        return float(ends[0] - ends[1])

    if low < high and (excess(low) > 0.0 or excess(high) < 0.0):
        return None
    for _ in range(_HALVINGS):
        half = 0.5 * (low + high)
        low, high = (low, half) if excess(half) > 0.0 else (half, high)
    return 0.5 * (low + high)


def equivalent_conicity(
    table: RadiusDifference, amplitudes: Floats, *, radius: float, base: float = BASE
) -> Floats:
    """Return tan γ_e by integration, nan where there is no motion of an amplitude.

    Parameters
    ----------
    table
        Rolling radius difference.
    amplitudes
        Amplitudes of the lateral motion, shape (n,) [m].
    radius
        Rolling radius r in the middle [m].
    base
        Distance e of the contacts [m].

    Returns
    -------
    Floats
        tan γ_e, shape (n,) [1].

    References
    ----------
    EN 15302: integration of the differential equation with the rolling radius difference.
    """
    paths = [free_path(table, float(amplitude), base, radius) for amplitude in amplitudes]
    return np.array(
        [
            np.nan if path is None else (np.pi / path.wavelength) ** 2 * 2.0 * base * radius
            for path in paths
        ]
    )


def conicity_slope(table: RadiusDifference, slopes: Floats, amplitude: float) -> Floats:
    """Return the derivatives of tan γ_e by integration, shape (n_parameters,).

    The turning points move so that the integrals over the middle stay alike; e and r cancel.

    Parameters
    ----------
    table
        Rolling radius difference.
    slopes
        Its derivatives at the shifts of the table, shape (n, n_parameters).
    amplitude
        An amplitude of which there is a motion [m].
    """
    path = free_path(table, amplitude, 1.0, 1.0)
    if path is None or not np.isfinite(path.wavelength):
        return np.full(slopes.shape[1], np.nan)
    angles = (np.arange(_NODES) + 0.5) / _NODES * np.pi - 0.5 * np.pi
    shifts = path.left - amplitude + amplitude * np.sin(angles)
    ends = np.array([path.left, path.right])
    steps = np.diff(table.shift)[:, None]
    sums = np.vstack(
        [np.zeros(slopes.shape[1]), np.cumsum(0.5 * steps * (slopes[1:] + slopes[:-1]), axis=0)]
    )
    moved = _integrals(table.shift, slopes, sums, np.concatenate([shifts, ends]))
    inner, outer = moved[:-2], moved[-2:]
    at_ends, inside = table.at(ends), table.at(shifts)
    left = -(outer[0] - outer[1]) / (at_ends[0] - at_ends[1])
    level = 0.5 * (outer[0] + outer[1]) + 0.5 * (at_ends[0] + at_ends[1]) * left
    below = float(np.mean(table.integral(ends))) - table.integral(shifts)
    by_parameter = level - inner - inside[:, None] * left
    weights = np.cos(angles) / np.sqrt(below)
    part = -0.5 * (weights / below) @ by_parameter / np.sum(weights)
    value = (np.pi / path.wavelength) ** 2 * 2.0
    return np.asarray(-2.0 * value * part)


def _integrals(shift: Floats, slopes: Floats, sums: Floats, places: Floats) -> Floats:
    """Return integrals from the first shift on of functions linear between shifts."""
    part = np.clip(np.searchsorted(shift, places) - 1, 0, len(shift) - 2)
    along = (places - shift[part])[:, None]
    share = along / (shift[part + 1] - shift[part])[:, None]
    here = slopes[part] + share * (slopes[part + 1] - slopes[part])
    return np.asarray(sums[part] + along * 0.5 * (slopes[part] + here))


def harmonic_conicity(table: RadiusDifference, amplitudes: Floats) -> Floats:
    """Return the conicity of harmonic linearisation about the middle, shape (n,) [1].

    γ = 1/(2 π A) ∫ Δr(y_0 + A sin φ) sin φ dφ over a period; nan beyond the table.
    """
    angles = (np.arange(_NODES) + 0.5) / _NODES * 2.0 * np.pi
    return np.array(
        [
            _within(table, a)
            * np.mean(table.at(table.middle + a * np.sin(angles)) * np.sin(angles))
            / a
            for a in map(float, amplitudes)
        ]
    )


def regression_conicity(table: RadiusDifference, amplitudes: Floats) -> Floats:
    """Return half the slope of the straight line through Δr over ± an amplitude, shape (n,) [1].

    The line of least squares over the shifts evenly; nan beyond the table.
    """
    places = (np.arange(_NODES) + 0.5) / _NODES * 2.0 - 1.0
    weight = np.mean(places**2)
    return np.array(
        [
            _within(table, a)
            * 0.5
            * np.mean(table.at(table.middle + a * places) * places)
            / (a * weight)
            for a in map(float, amplitudes)
        ]
    )


def _within(table: RadiusDifference, amplitude: float) -> float:
    room = min(table.middle - table.shift[0], table.shift[-1] - table.middle)
    return 1.0 if amplitude <= room + _EDGE else np.nan
