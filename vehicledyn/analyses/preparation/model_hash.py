"""Digests that distinguish models: by their equations, and by their parameters too."""

from __future__ import annotations

import hashlib
import json

from vehicledyn.analyses.preparation.prepared import Prepared


def model_hash(prepared: Prepared, *, parameters: bool = True) -> str:
    """Return a digest of the structure, the tables and, if asked, the parameters of the model."""
    e = prepared.equations
    facts = {
        "structure": e.structure,
        "parameters": {p.name: p.value if parameters else p.unit for p in e.parameters},
        "channels": [c.name for c in e.channels],
        **({"tables": [(t.name, t.digest) for t in e.tables]} if e.tables else {}),
    }
    text = json.dumps(facts, sort_keys=True, default=str)
    return hashlib.sha256(text.encode()).hexdigest()
