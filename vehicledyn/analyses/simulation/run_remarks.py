"""Notes of a run on its inputs: mended profiles, steep and gapped roads, unlike tyres."""

from __future__ import annotations

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.preparation.validity.coarse_shapes import coarse_shapes
from vehicledyn.analyses.preparation.validity.unlike_tyres import unlike_tyres
from vehicledyn.analyses.simulation.cautions import cautions
from vehicledyn.analyses.simulation.mended_profiles import mended_profiles
from vehicledyn.analyses.simulation.steep_roads import steep_roads
from vehicledyn.files.scenario.load import LoadedScenario


def run_remarks(loaded: LoadedScenario, prepared: Prepared) -> list[str]:
    """Return sentences about beams, profiles, roads, paths and tyres of a run."""
    return [
        *coarse_shapes(prepared),
        *mended_profiles(loaded),
        *steep_roads(loaded),
        *cautions(loaded),
        *unlike_tyres(prepared.subject.system),
    ]
