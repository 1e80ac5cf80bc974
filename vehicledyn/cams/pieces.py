"""Curves of pieces: polynomials and sines over an angle, in numbers and in expressions.

All motion laws of cams in use are of this kind, so one class differentiates them exactly.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable

Array = NDArray[np.float64]
ORDERS = 4
"""Value and derivatives that are computed."""
_MOST_PIECES = 24
"""Pieces up to which expressions choose one by comparisons; beyond they look it up in a table."""
_CELLS = 4096


@dataclass(frozen=True)
class CurvePiece:
    """A part of a curve, with u from 0 to 1 over its width.

    y = Σ coefficients[k] uᵏ + Σ a sin(w u + φ) over the ``waves`` (a, w, φ)
    """

    begin: float
    width: float
    coefficients: tuple[float, ...]
    waves: tuple[tuple[float, float, float], ...] = ()

    def derivatives(self, x: Array) -> Array:
        """Return value and derivatives by x, shape (ORDERS, n)."""
        u = (x - self.begin) / self.width
        rows = []
        polynomial = np.polynomial.Polynomial(self.coefficients)
        for order in range(ORDERS):
            total = polynomial(u)
            for a, w, phase in self.waves:
                total = total + a * w**order * np.sin(w * u + phase + 0.5 * math.pi * order)
            rows.append(total / self.width**order)
            polynomial = polynomial.deriv()
        return np.array(rows)

    def value(self, x: Scalar) -> Scalar:
        """Return the value as an expression."""
        u = (x - self.begin) / self.width
        total: Scalar = 0.0
        for coefficient in reversed(self.coefficients):
            total = coefficient + u * total
        for a, w, phase in self.waves:
            total = total + a * ops.sin(w * u + phase)
        return total

    def changed(self, begin: float, width: float, factor: float, offset: float) -> CurvePiece:
        """Return the piece elsewhere, scaled and raised."""
        coefficients = [factor * c for c in self.coefficients]
        coefficients[0] += offset
        waves = tuple((factor * a, w, phase) for a, w, phase in self.waves)
        return CurvePiece(begin, width, tuple(coefficients), waves)


@dataclass(frozen=True)
class PieceCurve:
    """A curve of pieces that follow one another."""

    pieces: tuple[CurvePiece, ...]

    @property
    def begin(self) -> float:
        """Where the first piece begins."""
        return self.pieces[0].begin

    @property
    def end(self) -> float:
        """Where the last piece ends."""
        return self.pieces[-1].begin + self.pieces[-1].width

    @property
    def knots(self) -> list[float]:
        """Where pieces begin, and where the last one ends."""
        return [*(piece.begin for piece in self.pieces), self.end]

    def derivatives(self, x: Array) -> Array:
        """Return value and derivatives by x, shape (ORDERS, n); of the right piece at a knot."""
        x = np.asarray(x, dtype=float)
        begins = np.array([piece.begin for piece in self.pieces]).real
        found: Any = None
        owner = np.clip(np.searchsorted(begins, x, side="right") - 1, 0, len(begins) - 1)
        for k, piece in enumerate(self.pieces):
            inside = owner == k
            if inside.any():
                part = piece.derivatives(x[inside])
                if found is None:
                    found = np.zeros((ORDERS, x.size), dtype=part.dtype)
                elif np.iscomplexobj(part):
                    found = found.astype(complex)
                found[:, inside] = part
        return np.zeros((ORDERS, 0)) if found is None else np.asarray(found)

    def value(self, x: Scalar) -> Scalar:
        """Return the value as an expression, at a place between begin and end."""
        if len(self.pieces) > _MOST_PIECES:
            return self._table.value(x)
        total = self.pieces[0].value(x)
        for piece in self.pieces[1:]:
            total = ops.where(x >= piece.begin, piece.value(x), total)
        return total

    @cached_property
    def _table(self) -> CurveTable:
        """Cells of equal width that share value and two derivatives at their ends."""
        places = np.linspace(self.begin, self.end, _CELLS + 1)
        return hermite_table("cam motion", places, self.derivatives(places)[:3])

    def jumps(self, order: int) -> list[tuple[float, float]]:
        """Return the knots inside and at the end, which joins the begin, with jumps there."""
        found = []
        for k, piece in enumerate(self.pieces):
            after = self.pieces[(k + 1) % len(self.pieces)]
            left = piece.derivatives(np.array([piece.begin + piece.width]))[order, 0]
            right = after.derivatives(np.array([after.begin]))[order, 0]
            found.append((piece.begin + piece.width, float(right - left)))
        return found


def hermite_table(name: str, places: Array, rows: Array) -> CurveTable:
    """Return quintics over equal cells through values, slopes and second derivatives.

    Parameters
    ----------
    name
        What the curve is, for messages.
    places
        Equally distant places, shape (n + 1,).
    rows
        Value, slope and second derivative there, shape (3, n + 1).
    """
    step = float(places[-1] - places[0]) / (len(places) - 1)
    y, v, a = rows[0], rows[1] * step, rows[2] * step**2
    y0, v0, a0, y1, v1, a1 = y[:-1], v[:-1], a[:-1], y[1:], v[1:], a[1:]
    d, e, f = y1 - y0 - v0 - 0.5 * a0, v1 - v0 - a0, a1 - a0
    cells = [
        y0,
        v0,
        0.5 * a0,
        10 * d - 4 * e + 0.5 * f,
        7 * e - 15 * d - f,
        6 * d - 3 * e + 0.5 * f,
    ]
    return CurveTable(name, float(places[0]), step, np.array(cells).T)


def unit_curve(pieces: Sequence[CurvePiece]) -> PieceCurve:
    """Return a curve over 0 to 1 that begins at 0 and ends at 1, whatever its pieces begin with.

    The last value of the pieces must not be the first.
    """
    first = float(pieces[0].derivatives(np.array([pieces[0].begin]))[0, 0])
    last = PieceCurve(tuple(pieces))
    end = float(last.derivatives(np.array([last.end]))[0, 0])
    scale = 1.0 / (end - first)
    return PieceCurve(
        tuple(p.changed(p.begin, p.width, scale, -first * scale) for p in last.pieces)
    )


def from_accelerations(
    program: Sequence[tuple[float, tuple[float, float, float] | float]],
) -> PieceCurve:
    """Return the curve from 0 to 1 whose second derivative is proportional to a program.

    It starts with slope zero; its value and slope are continuous.

    Parameters
    ----------
    program
        Width of each piece, in all 1, and its acceleration: a number, or (a, w, φ) of
        a sin(w u + φ) with u from 0 to 1 over the piece.
    """
    pieces: list[CurvePiece] = []
    begin = value = slope = 0.0
    for width, given in program:
        if isinstance(given, tuple):
            a, w, phase = given
            b = -a * width**2 / w**2
            start, rise = value - b * math.sin(phase), slope * width - b * w * math.cos(phase)
            piece = CurvePiece(begin, width, (start, rise), ((b, w, phase),))
        else:
            piece = CurvePiece(begin, width, (value, slope * width, 0.5 * given * width**2))
        pieces.append(piece)
        begin += width
        value, slope = piece.derivatives(np.array([begin]))[:2, 0].tolist()
    return unit_curve(pieces)
