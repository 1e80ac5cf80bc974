"""Fingerprints of scenarios and models as they are written, with all files that they name."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.analyses.preparation.memory.named_files import named_files
from vehicledyn.analyses.preparation.memory.origins import foreign_sources
from vehicledyn.analyses.preparation.model_hash import model_facts
from vehicledyn.analyses.preparation.prepared import Derived
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.hdf5.kept_work import KeptWork


def target_digest(target: Target) -> str:
    """Return a text that is equal for equal scenarios or models with equal files.

    Of systems built in Python the equations count, of parts of one's own the files of their code.
    """
    contents = sorted((Path(name).name, d) for name, d in named_files(target).items())
    facts = {**target.resolved, "files": contents}
    facts |= {"model": target.model_name, "written": target.written.text}
    if target.choices is None:
        facts |= {"changes": list(target.overrides), "described": target.written.described}
    facts["code"] = foreign_sources(target)
    if target.built is not None:
        equations = Derived(target, build_subject(target)).equations
        values = [p.value for p in equations.parameters]
        facts["built"] = model_facts(equations, values)
    return digest_of(facts)


def digests_to_keep(kept: KeptWork, targets: Iterable[Target]) -> list[str]:
    """Return the digests of targets, nothing where nothing is kept beside an output."""
    return [] if kept.output is None else [target_digest(target) for target in targets]


def digest_of(facts: Any) -> str:
    """Return a digest of plain data."""
    return hashlib.sha256(json.dumps(facts, sort_keys=True, default=str).encode()).hexdigest()
