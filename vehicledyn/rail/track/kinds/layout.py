"""Track made of segments."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pydantic import Field, model_validator

from vehicledyn.base.parameters import ParameterSet, part, quantity
from vehicledyn.base.registry import register
from vehicledyn.base.validation_messages import Complaint, complain
from vehicledyn.rail.track.layout_pieces import grade_faults, pieces_of
from vehicledyn.rail.track.pieces import Grade
from vehicledyn.rail.track.segments import SegmentSet
from vehicledyn.rail.track.track_set import DesignedTrack

if TYPE_CHECKING:
    from pathlib import Path

    from vehicledyn.rail.track.alignment import Alignment


class GradeSet(ParameterSet):
    """A change of the gradient."""

    at: float = quantity("m", "Where the tangents meet, from the start of the track")
    slope: float = quantity("1", "Slope from there on, positive uphill, such as 12 permil")
    radius: float = quantity("m", "Radius of the arc that rounds the change", default=0.0, ge=0.0)


@register("track", "layout")
class LayoutTrack(DesignedTrack):
    """Track made of straights, arcs and transitions one after the other, with gradients."""

    segments: tuple[SegmentSet, ...] = part("segment", "Segments in their order")
    gradients: tuple[GradeSet, ...] = Field(
        default=(), description="Changes of the gradient in their order; level before the first"
    )

    @model_validator(mode="after")
    def _fits_together(self) -> LayoutTrack:
        if not self.segments:
            raise complain("track", [Complaint(("segments",), "give at least one segment", [])])
        found = {
            "segments": pieces_of(self.segments, self.gauge)[1],
            "gradients": grade_faults(self._grades),
        }
        wrong = [
            Complaint((name, fault.number, fault.field), fault.words, None)
            for name, faults in found.items()
            for fault in faults
        ]
        if wrong:
            raise complain("track", wrong)
        return self

    @property
    def _grades(self) -> list[Grade]:
        return [Grade(g.at, g.slope, g.radius) for g in self.gradients]

    def alignment(self, folder: Path) -> Alignment:
        """Return the design."""
        from vehicledyn.rail.track.alignment import Alignment

        pieces, _ = pieces_of(self.segments, self.gauge)
        return Alignment(pieces, self.base, self._grades, self.cant_about)
