"""Polynomials of any degree by conditions at both ends and between."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from pydantic import model_validator

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import CurvePiece, PieceCurve

_MOST = 24
"""Highest degree that double precision settles."""


@register("motion_law", "polynomial")
class BoundaryPolynomial(MotionLaw):
    """The polynomial y(u) of least degree from 0 to 1 with given derivatives at its ends.

    Derivatives are those of the share y of the rise by the share u of the angle, the first one
    first; y may also be given at places between.
    """

    start: tuple[float, ...] = quantity(
        "1", "Derivatives y', y'' ... at the start", default=(0.0, 0.0)
    )
    end: tuple[float, ...] = quantity("1", "Derivatives y', y'' ... at the end", default=(0.0, 0.0))
    places: tuple[float, ...] = quantity("1", "Places u between 0 and 1", default=())
    values: tuple[float, ...] = quantity("1", "Values y at these places", default=())

    @model_validator(mode="after")
    def _fitting(self) -> BoundaryPolynomial:
        if len(self.places) != len(self.values):
            raise ValueError(
                f"{len(self.places)} places and {len(self.values)} values; give as many"
            )
        inside = all(0.0 < place < 1.0 for place in self.places)
        if not inside or len(set(self.places)) != len(self.places):
            raise ValueError("places: each between 0 and 1, and none twice")
        if self._degree > _MOST:
            raise ValueError(
                f"{self._degree + 1} conditions make degree {self._degree}; give no more than "
                f"{_MOST + 1}, or take a spline"
            )
        return self

    @property
    def _degree(self) -> int:
        return len(self.start) + len(self.end) + len(self.places) + 1

    def curve(self) -> PieceCurve:
        """Return the polynomial that meets the conditions."""
        size = self._degree + 1
        known = [0.0, *self.start]
        fixed = [value / math.factorial(k) for k, value in enumerate(known)]
        powers = range(len(fixed), size)
        rows: list[list[float]] = []
        sides: list[float] = []
        for order, wanted in enumerate([1.0, *self.end]):
            rows.append([math.perm(p, order) for p in powers])
            sides.append(wanted - sum(math.perm(p, order) * c for p, c in enumerate(fixed)))
        for place, value in zip(self.places, self.values, strict=True):
            rows.append([place**p for p in powers])
            sides.append(value - sum(place**p * c for p, c in enumerate(fixed)))
        rest: Any = np.linalg.solve(np.array(rows, dtype=float), np.array(sides)) if rows else []
        return PieceCurve((CurvePiece(0.0, 1.0, (*fixed, *map(float, rest))),))
