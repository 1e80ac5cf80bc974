"""Fingerprints of what decides the results of a study, by which ``resume`` knows it again."""

from __future__ import annotations

import hashlib

from vehicledyn.analyses.preparation.target_digest import digest_of, target_digest
from vehicledyn.files.scenario.load import LoadedScenario
from vehicledyn.studies.axes import Design
from vehicledyn.studies.sets import Study


def study_digests(study: Study, base: LoadedScenario, design: Design) -> dict[str, str]:
    """Return the fingerprints of a study and of its scenario with the scenario's files."""
    axes = [(a.key, a.unit, a.choices, a.low, a.high, a.is_log) for a in design.axes]
    values = hashlib.sha256(b"".join(a.values.tobytes() for a in design.axes)).hexdigest()
    kept = study.output.model_dump()
    facts = (design.kind, design.count, design.seed, axes, values, kept)
    return {"study": digest_of(facts), "scenario": target_digest(base)}
