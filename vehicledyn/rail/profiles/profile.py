"""Profiles of wheels and rails: height, slope and curvature along the lateral coordinate.

Axes of every profile here: y grows outwards, to the field side; the flange of a wheel and the
gauge side of a rail lie at negative y. For a wheel z is the increase of the rolling radius over
that of the tape circle at y = 0; for a rail z is the height over its crown, y = 0 its axis,
before the rail is inclined. Profiles of left and right side are mirror images of each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from vehicledyn.rail.profiles.profile_names import Kind
from vehicledyn.rail.profiles.profile_pieces import Floats, ProfilePiece, QuinticTable

STEEPEST = 12.0
"""Slope up to which a profile is followed as a function of y, 85 degrees [1]."""

_EDGE = 1e-9
"""Points this far outside still count as the profile's end [m]."""


@dataclass(frozen=True)
class ProfileMeasurement:
    """What a profile was made of, in its axes.

    ``points`` are those that the curve follows, shape (n, 2), ``distance`` how far each lies
    from it along the normal, shape (n,), ``outliers`` those left out, shape (k, 2), ``bridges``
    the y of both ends of each gap that was bridged, shape (m, 2), ``averaged`` those of the file
    that a mean stands for, as noise puts them out of order, shape (j, 2) [m].
    """

    points: Floats
    distance: Floats
    outliers: Floats
    bridges: Floats
    averaged: Floats


@dataclass(frozen=True)
class Profile:
    """A profile made of pieces in the order of y.

    ``notes`` say how a file was read: unit, axes, what was cut off, smoothing; ``measured`` is
    what it was made of, if from a file.
    """

    name: str
    kind: Kind
    pieces: tuple[ProfilePiece, ...]
    source: str = ""
    notes: tuple[str, ...] = field(default=())
    measured: ProfileMeasurement | None = field(default=None, compare=False)

    @property
    def begin(self) -> float:
        """Smallest y [m]."""
        return self.pieces[0].begin

    @property
    def end(self) -> float:
        """Largest y [m]."""
        return self.pieces[-1].end

    def height(self, y: Floats | float) -> Floats:
        """Return z at lateral places y, nan outside the profile, shaped like ``y`` [m]."""
        return self.values(y)[0]

    def slope(self, y: Floats | float) -> Floats:
        """Return dz/dy [1]."""
        return self.values(y)[1]

    def curvature(self, y: Floats | float) -> Floats:
        """Return the curvature z''/(1 + z'²)^(3/2), positive where the curve bends up [1/m]."""
        _, slope, bend = self.values(y)
        return np.asarray(bend / (1.0 + slope**2) ** 1.5)

    def values(self, y: Floats | float) -> tuple[Floats, Floats, Floats]:
        """Return z [m], dz/dy [1] and d²z/dy² [1/m], nan outside the profile."""
        place = np.asarray(y, dtype=float)
        inside = (place >= self.begin - _EDGE) & (place <= self.end + _EDGE)
        place = np.clip(place, self.begin, self.end)
        found = np.full((3, *place.shape), np.nan)
        starts = np.array([piece.begin for piece in self.pieces])
        number = np.clip(np.searchsorted(starts, place, side="right") - 1, 0, None)
        for k, piece in enumerate(self.pieces):
            here = inside & (number == k)
            if here.any():
                found[:, here] = piece.values(place[here])
        return found[0], found[1], found[2]

    def sampled(self, step: float) -> QuinticTable:
        """Return the profile as a table, exact where pieces meet; parts too steep are cut off.

        Parameters
        ----------
        step
            Largest distance of places [m].
        """
        return tabulated(self.pieces, step)


def tabulated(pieces: Sequence[ProfilePiece], step: float, turn: float = 0.0) -> QuinticTable:
    """Return pieces as one table, turned about the origin; parts too steep are cut off.

    Parameters
    ----------
    pieces
        Pieces in the order of y.
    step
        Largest distance of places before they are turned [m].
    turn
        Angle; positive turns the side of positive y up [rad].
    """
    places, left, right = [], [], []
    for piece in pieces:
        y = np.linspace(
            piece.begin, piece.end, max(2, int(np.ceil((piece.end - piece.begin) / step)) + 1)
        )
        if isinstance(piece, QuinticTable):
            y = np.unique(np.concatenate([y, piece.places]))
            below = _turned(y, *piece.values(y, from_below=True), turn)
        knots = _turned(y, *piece.values(y), turn)
        places.append(knots[0])
        left.append(knots[1:, :-1])
        right.append((below if isinstance(piece, QuinticTable) else knots)[1:, 1:])
    edges = np.concatenate([*(part[:-1] for part in places), places[-1][-1:]])
    begin, end = np.concatenate(left, axis=1), np.concatenate(right, axis=1)
    usable = (np.abs(begin[1]) < STEEPEST) & (np.abs(end[1]) < STEEPEST) & (np.diff(edges) > 0.0)
    first, last = _longest(usable)
    return QuinticTable(edges[first : last + 1], begin[:, first:last], end[:, first:last])


def _turned(y: Floats, z: Floats, slope: Floats, bend: Floats, angle: float) -> Floats:
    """Return place, height, slope and second derivative of turned points, shape (4, n)."""
    c, s = np.cos(angle), np.sin(angle)
    with np.errstate(divide="ignore", invalid="ignore"):
        stretch = c - s * slope  # of y
        risen = np.where(stretch > 0.0, (s + c * slope) / stretch, np.inf)
        return np.array([c * y - s * z, s * y + c * z, risen, bend / stretch**3])


def _longest(usable: Floats) -> tuple[int, int]:
    """Return begin and end of the longest run of true values."""
    marks = np.flatnonzero(np.diff(np.concatenate([[0], usable.astype(int), [0]])))
    runs = marks.reshape(-1, 2)
    first, last = runs[np.argmax(runs[:, 1] - runs[:, 0])]
    return int(first), int(last)
