"""Beams of the cases of a study: how far they bend, and what their shapes yield too little."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.preparation.validity.bent_beams import LARGE, MonitoredBeams, bent_far
from vehicledyn.analyses.preparation.validity.coarse_shapes import (
    TOO_LITTLE,
    LoadedBeams,
    too_coarse,
)
from vehicledyn.kernel.engine import Vector
from vehicledyn.results.store.study_layout import BEND, StudyFigure
from vehicledyn.results.store.study_reader import StudyFile


@dataclass(frozen=True)
class CaseBeams:
    """The beams of a model that all cases of a study share."""

    bent: MonitoredBeams
    loaded: LoadedBeams

    @staticmethod
    def of(prepared: Prepared) -> CaseBeams:
        """Return those of a system."""
        return CaseBeams(MonitoredBeams.of(prepared), LoadedBeams.of(prepared))

    @property
    def columns(self) -> list[int]:
        """The channels that are looked at."""
        return [k for pair in self.bent.columns for k in pair]

    def figures(self, channel: Callable[[int], Vector], parameters: Vector) -> list[StudyFigure]:
        """Return the figures of a case, from its channels by number.

        How far ends moved aside over the lengths; and by which part a beam yields too little under
        what acts on it, where that is much.
        """
        return [
            StudyFigure(
                f"{BEND}{name}",
                float(b.max()),
                "1",
                f"Deflection of the end of {name} over its length",
            )
            for name, b in self.bent.bends(channel, parameters).items()
        ] + self._coarse(parameters)

    def _coarse(self, parameters: Vector) -> list[StudyFigure]:
        words = "Part by which {0.beam} {0.verb} too little under loads at {0.at}"
        found = sorted(self.loaded.coarse(parameters), key=lambda item: item.missing)
        largest = {item.name: item for item in found}
        return [
            StudyFigure(name, item.missing, "1", words.format(item))
            for name, item in largest.items()
        ]


def beam_warnings(file: StudyFile, cases: Callable[[list[int]], str]) -> list[str]:
    """Return warnings about cases whose beams bend far or yield too little.

    ``cases`` returns words for cases by number.
    """
    warnings = []
    for name in file.figures:
        if not (name.startswith(BEND) or TOO_LITTLE in name):
            continue
        is_bend, values = name.startswith(BEND), file.figure(name)
        found = [int(k) for k in np.flatnonzero(values > (LARGE if is_bend else 0.0))]
        if found and is_bend:
            how = f"by up to {values[found].max():.2g} of its length in {cases(found)}"
            warnings.append(bent_far(name.removeprefix(BEND), how))
        elif found:
            warnings.append(too_coarse(name, float(values[found].max()), cases(found)))
    return warnings
