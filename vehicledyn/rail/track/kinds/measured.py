"""Track from a table along its chainage."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar

from pydantic import Field

from vehicledyn.base.files.column_files import ColumnKind
from vehicledyn.base.registry import register
from vehicledyn.rail.track.pieces import Grade, TrackPiece
from vehicledyn.rail.track.track_set import DesignedTrack

if TYPE_CHECKING:
    from pathlib import Path

    from vehicledyn.rail.track.alignment import Alignment, Array

_COLUMNS = {
    "s": ColumnKind("m", required=True),
    "curvature": ColumnKind("1/m", required=True),
    "cant": ColumnKind("m"),
    "gradient": ColumnKind("1"),
    "gauge": ColumnKind("m"),
}


@register("track", "measured")
class MeasuredTrack(DesignedTrack):
    """Track from a table of s, curvature, cant, gradient and gauge, straight lines in between.

    The columns but s and curvature may be left out; every head states its unit, such as
    ``s [m], curvature [1/km], cant [mm], gradient [permil], gauge [mm]``. Curvature is positive
    to the left, cant where the right rail is higher. The track begins at the first line, where
    its chainage is zero. Of a gauge beyond the nominal one either rail takes half.
    """

    names_files: ClassVar[bool] = True

    file: str = Field(description="Table of the track, as CSV")

    def alignment(self, folder: Path) -> Alignment:
        """Return the design: pieces from line to line, with changes of gradient at each.

        Raises
        ------
        InputError
            If the table cannot be read or is none of a track.
        """
        from vehicledyn.base.problems import refusal
        from vehicledyn.rail.track.alignment import Alignment
        from vehicledyn.rail.track.layout_pieces import HIGHEST_CANT, STEEPEST, TIGHTEST, WIDEST
        from vehicledyn.rail.track.track_columns import read_along

        path = folder / self.file
        largest = {
            "curvature": (1.0 / (TIGHTEST * self.gauge), f"a gauge of {1e3 * self.gauge:g} mm"),
            "cant": (HIGHEST_CANT * self.gauge, f"a gauge of {1e3 * self.gauge:g} mm"),
            "gradient": (STEEPEST, "rails"),
        }
        columns, values = read_along(path, _COLUMNS, largest)
        s = values["s"]
        none = 0.0 * s
        bend, cant = values["curvature"], values.get("cant", none)
        widening = values["gauge"] - self.gauge if "gauge" in values else none
        if (abs(widening) > WIDEST).any():
            row = int(abs(widening).argmax())
            words = f"a gauge of {1e3 * values['gauge'][row]:g} mm is not one of nominally "
            words += f"{1e3 * self.gauge:g} mm; is the unit in the head right?"
            raise refusal([columns.problem(row, "gauge", words)], str(path))
        rails = 0.5 * widening, -0.5 * widening
        pairs = [list(pairwise(map(float, v))) for v in (bend, cant, *rails)]
        lengths = s[1:] - s[:-1]
        pieces = [TrackPiece(float(n), *ends) for n, *ends in zip(lengths, *pairs, strict=True)]
        grades = _grades(s - s[0], values.get("gradient", none))
        return Alignment(pieces, self.base, grades, self.cant_about)


def _grades(s: Array, slopes: Array) -> list[Grade]:
    """Return the changes of a gradient that changes evenly from line to line."""
    if not slopes.any():
        return []
    grades = [Grade(0.0, float(slopes[0]))]
    for k in range(1, len(s)):
        change = abs(slopes[k] - slopes[k - 1])
        if change > 0.0:
            radius = float((s[k] - s[k - 1]) / change)
            grades.append(Grade(float(0.5 * (s[k - 1] + s[k])), float(slopes[k]), radius))
    return grades
