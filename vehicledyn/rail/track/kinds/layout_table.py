"""Track whose segments are a table."""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field, ValidationError

from vehicledyn.base.files.column_files import ColumnKind, Columns, read_columns
from vehicledyn.base.parameters import read_part
from vehicledyn.base.problems import Problem, refusal
from vehicledyn.base.registry import register
from vehicledyn.base.validation_messages import words_of
from vehicledyn.rail.track.segments import SegmentSet
from vehicledyn.rail.track.track_set import DesignedTrack

if TYPE_CHECKING:
    from pathlib import Path

    from vehicledyn.rail.track.alignment import Alignment

_NUMBERS = ("length", "radius", "cant", "widening")
_COLUMNS = {
    "kind": ColumnKind(None, required=True),
    **{name: ColumnKind("m", required=name == "length") for name in _NUMBERS},
}


@register("track", "layout_table")
class LayoutTable(DesignedTrack):
    """Track made of segments that are the lines of a table.

    Columns kind, length, radius, cant and widening, the last three where there are any; every
    head but kind states its unit, such as ``kind, length [m], radius [m], cant [mm]``. An empty
    cell is a field left out.
    """

    names_files: ClassVar[bool] = True

    file: str = Field(description="Table of the segments, as CSV")

    def alignment(self, folder: Path) -> Alignment:
        """Return the design.

        Raises
        ------
        InputError
            If the table cannot be read or its segments do not fit together.
        """
        from vehicledyn.rail.track.alignment import Alignment
        from vehicledyn.rail.track.layout_pieces import pieces_of

        path = folder / self.file
        columns = read_columns(path, _COLUMNS)
        segments, problems = _segments(columns)
        pieces, faults = ([], []) if problems else pieces_of(segments, self.gauge)
        problems += [columns.problem(f.number, f.field, f.words) for f in faults]
        if problems:
            raise refusal(problems, str(path))
        return Alignment(pieces, self.base, cant_about=self.cant_about)


def _segments(columns: Columns) -> tuple[list[SegmentSet], list[Problem]]:
    segments: list[SegmentSet] = []
    problems: list[Problem] = []
    for row, kind in enumerate(columns.texts["kind"]):
        values = {name: numbers[row] for name, numbers in columns.numbers.items()}
        given: dict[str, Any] = {n: v for n, v in values.items() if not isnan(v)}
        try:
            segment = read_part("segment", {"kind": kind, **given})
        except ValidationError as error:
            for line in error.errors():
                field = str(line["loc"][0]) if line["loc"] else "kind"
                problems.append(columns.problem(row, field, words_of(line)))
        else:
            if isinstance(segment, SegmentSet):
                segments.append(segment)
    return segments, problems
