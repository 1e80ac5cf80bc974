"""Splines through points."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from pydantic import Field, model_validator

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import CurvePiece, PieceCurve


@register("motion_law", "spline")
class Spline(MotionLaw):
    """A spline through points, which count from where the law begins.

    The first point is (0, 0), given or not, the last one is at the end of the law. Its ends rest:
    without velocity, that of degree 5 without acceleration too; a periodic one is as smooth there
    as between.
    """

    angles: tuple[float, ...] = quantity("rad", "Angles of the points, growing")
    lifts: tuple[float, ...] | None = quantity("m", "Lift at each of them", default=None)
    swings: tuple[float, ...] | None = quantity("rad", "Swing at each of them", default=None)
    degree: Literal[3, 5] = Field(default=3, description="Degree of the polynomials")
    periodic: bool = Field(default=False, description="Whether the end joins the begin smoothly")

    @model_validator(mode="after")
    def _one_rise(self) -> Any:
        given = [v for v in (self.lifts, self.swings) if v is not None]
        if len(given) != 1 or self.lift is not None or self.swing is not None:
            raise ValueError("give either lifts or swings of the points, and nothing else")
        if len(given[0]) != len(self.angles) or len(self.angles) < 2:
            counts = f"{len(self.angles)} angles and {len(given[0])} values"
            raise ValueError(f"{counts}; give as many, two at least")
        x = self._points[0]
        if not (np.diff(x) > 0.0).all() or abs(x[0]) > 0.0 or abs(x[-1] - self.over) > 1e-9:
            raise ValueError("angles: growing, from 0 to what the law takes, its 'over'")
        if self._points[1][0] != 0.0:
            raise ValueError("the law begins at zero, so the value at angle 0 must be zero")
        if self.periodic and abs(self._points[1][-1]) > 1e-12:
            raise ValueError("a periodic spline ends where it begins: the last value must be zero")
        return self

    @property
    def _points(self) -> tuple[list[float], list[float]]:
        x, y = list(self.angles), list(self.lifts or self.swings or ())
        if x and x[0] > 0.0:
            x, y = [0.0, *x], [0.0, *y]
        return x, y

    @property
    def rise(self) -> float:
        """What it rises by [m or rad]."""
        return self._points[1][-1]

    @property
    def turns(self) -> bool:
        """Whether it is of a rocking follower."""
        return self.swings is not None

    def placed(self, begin: float, value: float) -> PieceCurve:
        """Return the spline from an angle [rad] and value on."""
        pieces = self.curve().pieces
        return PieceCurve(tuple(p.changed(begin + p.begin, p.width, 1.0, value) for p in pieces))

    def curve(self) -> PieceCurve:
        """Return the spline over its angle, in SI units."""
        x, y = map(np.array, self._points)
        return spline_pieces(x, y, self.degree, periodic=self.periodic)


def spline_pieces(x: Any, y: Any, degree: int, *, periodic: bool) -> PieceCurve:
    """Return a spline through points; its ends rest, or join smoothly if it is periodic."""
    from scipy.interpolate import PPoly, make_interp_spline

    at_rest = [(order, 0.0) for order in range(1, (degree + 1) // 2)]
    ends: Any = "periodic" if periodic else (at_rest, at_rest)
    rows = PPoly.from_spline(make_interp_spline(x, y, k=degree, bc_type=ends))
    pieces = []
    for k, (begin, stop) in enumerate(zip(rows.x[:-1], rows.x[1:], strict=True)):
        width = float(stop - begin)
        if width > 0.0:
            scaled = [float(c) * width**p for p, c in enumerate(rows.c[::-1, k])]
            pieces.append(CurvePiece(float(begin), width, tuple(scaled)))
    inside = [p for p in pieces if x[0] <= p.begin < x[-1]]
    return PieceCurve(tuple(inside))
