"""Pieces of a profile: polynomials, circular arcs and tables, each with two derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class ProfilePiece(Protocol):
    """One part of a profile, z(y) on ``begin`` <= y <= ``end`` [m]."""

    @property
    def begin(self) -> float:
        """Smallest y [m]."""

    @property
    def end(self) -> float:
        """Largest y [m]."""

    def values(self, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Return z [m], dz/dy [1] and d²z/dy² [1/m], each shaped like ``y``."""


@dataclass(frozen=True)
class Polynomial:
    """z = Σ c_k y^k, by Horner's scheme in the unit in which the source states it.

    ``coefficients`` are c_0, c_1, ... for lengths in a unit of ``unit`` metres. Scaled to metres
    they would lose digits: those of S1002 cancel heavily.
    """

    begin: float
    end: float
    coefficients: tuple[float, ...]
    unit: float = 1.0

    def values(self, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Return height, slope and second derivative."""
        place = np.asarray(y, dtype=float) / self.unit
        height, slope, bend = (np.zeros_like(place) for _ in range(3))
        for coefficient in reversed(self.coefficients):
            bend = bend * place + slope
            slope = slope * place + height
            height = height * place + coefficient
        return height * self.unit, slope, 2.0 * bend / self.unit


@dataclass(frozen=True)
class Arc:
    """z = z_0 ± √(R² - (y - y_0)²); ``side`` is +1 for the upper half, -1 for the lower."""

    begin: float
    end: float
    centre: tuple[float, float]
    radius: float
    side: int = 1

    def values(self, y: Floats) -> tuple[Floats, Floats, Floats]:
        """Return height, slope and second derivative; the slope is infinite at the very side."""
        along = np.asarray(y, dtype=float) - self.centre[0]
        rise = np.sqrt(np.maximum(self.radius**2 - along**2, 0.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = -self.side * along / rise
            bend = -self.side * self.radius**2 / rise**3
        return self.centre[1] + self.side * rise, slope, bend


@dataclass(frozen=True)
class QuinticTable:
    """Quintic polynomials that take height, slope and second derivative at both ends.

    ``places`` are increasing, shape (n,) [m]; ``left`` and ``right`` hold the three quantities at
    the left and right end of each interval, shape (3, n - 1), so that the second derivative
    may jump at a place, as it does where arcs of unequal radius meet.
    """

    places: Floats
    left: Floats
    right: Floats

    @property
    def begin(self) -> float:
        """Smallest y [m]."""
        return float(self.places[0])

    @property
    def end(self) -> float:
        """Largest y [m]."""
        return float(self.places[-1])

    def values(self, y: Floats, *, from_below: bool = False) -> tuple[Floats, Floats, Floats]:
        """Return height, slope and second derivative, nan outside the table.

        At a place of the table the second derivative is that above it, or ``from_below``.
        """
        u, step, outside, (c0, c1, c2, c3, c4, c5) = self._parts(y, from_below)
        height = c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))))
        slope = c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))
        bend = 2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))
        return (
            np.where(outside, np.nan, height),
            np.where(outside, np.nan, slope / step),
            np.where(outside, np.nan, bend / step**2),
        )

    def height(self, y: Floats) -> Floats:
        """Return the height alone, nan outside the table [m]."""
        u, _, outside, (c0, c1, c2, c3, c4, c5) = self._parts(y)
        return np.where(outside, np.nan, c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))))

    def _parts(
        self, y: Floats, from_below: bool = False
    ) -> tuple[Floats, Floats, NDArray[np.bool_], Floats]:
        """Return place in its interval, length of that, what is outside, and coefficients."""
        place = np.asarray(y, dtype=float)
        part = np.searchsorted(self.places, place, side="left" if from_below else "right") - 1
        part = np.minimum(np.maximum(part, 0), len(self.places) - 2)
        step = self._steps[part]
        outside = ~((place >= self.places[0]) & (place <= self.places[-1]))
        return (place - self.places[part]) / step, step, outside, self._coefficients[:, part]

    @cached_property
    def _steps(self) -> Floats:
        return np.diff(self.places)

    @cached_property
    def _coefficients(self) -> Floats:
        """Coefficients of the powers of u = (y - y_k)/(y_k+1 - y_k), shape (6, n - 1)."""
        step = self._steps
        (p0, v0, a0), (p1, v1, a1) = self.left, self.right
        v0, v1, a0, a1 = v0 * step, v1 * step, a0 * step**2, a1 * step**2
        gap, turn, bow = p1 - p0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0
        return np.array(
            [
                p0,
                v0,
                0.5 * a0,
                10.0 * gap - 4.0 * turn + 0.5 * bow,
                -15.0 * gap + 7.0 * turn - bow,
                6.0 * gap - 3.0 * turn + 0.5 * bow,
            ]
        )


def table(places: Floats, height: Floats, slope: Floats, bend: Floats) -> QuinticTable:
    """Return a table whose derivatives do not jump.

    Parameters
    ----------
    places
        Increasing y, shape (n,) [m].
    height, slope, bend
        z [m], dz/dy [1] and d²z/dy² [1/m] there, shape (n,).
    """
    knots = np.array([height, slope, bend])
    return QuinticTable(np.asarray(places, dtype=float), knots[:, :-1], knots[:, 1:])
