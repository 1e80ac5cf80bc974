"""Motion from a table in a file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from vehicledyn.base.registry import register
from vehicledyn.cams.laws.spline import spline_pieces
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import PieceCurve
from vehicledyn.cams.point_tables import read_point_table


@register("motion_law", "table")
class Table(MotionLaw):
    """A spline through the rows of a table: angle and lift, or angle and swing.

    The table is a CSV file with two columns whose heads hold the units, such as ``angle [deg]``
    and ``lift [mm]``. Its first angle is where the law begins.
    """

    file: str = Field(description="The table, relative to the file that names it")
    degree: Literal[3, 5] = Field(default=3, description="Degree of the polynomials")
    periodic: bool = Field(default=True, description="Whether the end joins the begin smoothly")
    _points: Any = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _one_rise(self) -> Any:
        if self.lift is not None or self.swing is not None:
            raise ValueError("the table holds the lift; give neither lift nor swing")
        return self

    def beside(self, folder: Path) -> Table:
        """Return the law with its table read.

        Raises
        ------
        InputError
            If the table cannot be used.
        """
        angles, values, unit = read_point_table(folder / self.file, ("rad",), ("m", "rad"))
        if not (np.diff(angles) > 0.0).all():
            raise ValueError(f"{self.file}: the angles must grow from row to row; sort them")
        found = self.model_copy()
        found._points = (angles - angles[0], values, unit)
        span = angles[-1] - angles[0]
        if abs(span - self.over) > 1e-9 * max(1.0, self.over):
            raise ValueError(
                f"{self.file}: the table spans {math.degrees(span):g} deg, the law takes "
                f"{math.degrees(self.over):g} deg; make them equal"
            )
        if self.periodic and abs(values[-1] - values[0]) > 1e-12:
            raise ValueError(f"{self.file}: ends with another value than it begins with")
        return found

    @property
    def rise(self) -> float:
        """What it rises by [m or rad]."""
        return float(self._read[1][-1] - self._read[1][0])

    @property
    def turns(self) -> bool:
        """Whether it is of a rocking follower."""
        return bool(self._read[2] == "rad")

    def placed(self, begin: float, value: float) -> PieceCurve:
        """Return the spline from an angle [rad] and value on."""
        pieces = self.curve().pieces
        return PieceCurve(tuple(p.changed(begin + p.begin, p.width, 1.0, value) for p in pieces))

    def curve(self) -> PieceCurve:
        """Return the spline over its angle, in SI units."""
        x, y, _ = self._read
        return spline_pieces(x, np.asarray(y) - y[0], self.degree, periodic=self.periodic)

    @property
    def _read(self) -> Any:
        if self._points is None:
            raise ValueError(f"{self.file}: has not been read")
        return self._points
