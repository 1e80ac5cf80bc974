"""What is to be said of the point that an analysis starts from or is about."""

from __future__ import annotations

from vehicledyn.analyses.preparation.doubts.bent_beams import bent_at
from vehicledyn.analyses.preparation.doubts.coarse_shapes import coarse_shapes
from vehicledyn.analyses.preparation.doubts.rounded_kinks import rounded_kinks
from vehicledyn.analyses.preparation.prepare import Point
from vehicledyn.analyses.preparation.prepared import Prepared


def doubts_at(prepared: Prepared, point: Point) -> list[str]:
    """Return a sentence about each thing that makes a balanced point doubtful."""
    return [*rounded_kinks(prepared, point), *doubtful_beams(prepared, point)]


def doubtful_beams(prepared: Prepared, point: Point) -> list[str]:
    """Return a sentence about each beam whose shapes do not hold for what happens at a point."""
    return [*bent_at(prepared, point), *coarse_shapes(prepared)]
