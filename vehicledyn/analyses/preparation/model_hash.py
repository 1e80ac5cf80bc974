"""Digests that distinguish models: by their equations, and by their parameters too."""

from __future__ import annotations

import hashlib
import json
from typing import Any

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.codegen.toolchain.fingerprint import fingerprint
from vehicledyn.symbolic.equations import Equations


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


def model_facts(equations: Equations, parameters: Any) -> tuple[Any, ...]:
    """Return what all results of a model rest on: equations, tables, parameters (n,) and starts."""
    e = equations
    starts = [float(item.start) for item in (*e.states, *e.unknowns)]
    return fingerprint(e), [table.digest for table in e.tables], parameters, starts
