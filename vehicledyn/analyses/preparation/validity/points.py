"""Warnings about the point that an analysis starts from or is about."""

from __future__ import annotations

from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.preparation.validity.bent_beams import bent_at
from vehicledyn.analyses.preparation.validity.coarse_shapes import coarse_shapes
from vehicledyn.analyses.preparation.validity.rounded_kinks import rounded_kinks


def validity_warnings(prepared: Prepared, point: AssembledPoint) -> list[str]:
    """Return a warning about each thing that the model does not hold for at a balanced point."""
    return [*rounded_kinks(prepared, point), *beam_warnings(prepared, point)]


def beam_warnings(prepared: Prepared, point: AssembledPoint) -> list[str]:
    """Return a warning about each beam whose shapes do not hold for what happens at a point."""
    return [*bent_at(prepared, point), *coarse_shapes(prepared)]
