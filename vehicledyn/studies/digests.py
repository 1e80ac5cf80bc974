"""Fingerprints of what decides the results of a study, by which ``resume`` knows it again."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.memory.named_files import named_files
from vehicledyn.analyses.preparation.prepared import Derived
from vehicledyn.codegen.toolchain.fingerprint import fingerprint
from vehicledyn.files.scenario.load import LoadedScenario
from vehicledyn.studies.axes import Design
from vehicledyn.studies.sets import Study


def study_digests(study: Study, base: LoadedScenario, design: Design) -> dict[str, str]:
    """Return the fingerprints of a study and of its scenario with the scenario's files."""
    axes = [(a.key, a.unit, a.choices, a.low, a.high, a.is_log) for a in design.axes]
    values = hashlib.sha256(b"".join(a.values.tobytes() for a in design.axes)).hexdigest()
    kept = study.output.model_dump()
    facts = (design.kind, design.count, design.seed, axes, values, kept)
    contents = sorted((Path(name).name, d) for name, d in named_files(base).items())
    scenario = {**base.resolved, "files": contents}
    if base.built is not None:
        scenario["built"] = _built(base)
    return {"study": _digest(facts), "scenario": _digest(scenario)}


def _built(base: LoadedScenario) -> Any:
    """Return what distinguishes systems built in Python: its equations and its start."""
    equations = Derived(base, build_subject(base)).equations
    starts = [float(item.start) for item in (*equations.states, *equations.unknowns)]
    return [fingerprint(equations), [table.digest for table in equations.tables], starts]


def _digest(facts: Any) -> str:
    return hashlib.sha256(json.dumps(facts, sort_keys=True, default=str).encode()).hexdigest()
