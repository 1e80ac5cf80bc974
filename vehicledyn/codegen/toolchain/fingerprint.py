"""Fingerprints of equations and of the generator: equal ones give equal machine code."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from vehicledyn.codegen.ir.instructions import read_function
from vehicledyn.codegen.passes.kernel_functions import event_expressions
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.tables import CurveTable

_GENERATORS = (
    "ir/*.py",
    "passes/*.py",
    "printers/*.py",
    "runtime/*",
    "../kernel/point_source.py",
    "../symbolic/chain_rule.py",
)
"""Modules that print kernels and the C they share, as patterns from the folder of the generator."""

_KNOWN = "_fingerprint"
"""Where equations keep their fingerprint; changed ones, being others, have none."""


def fingerprint(equations: Equations) -> str:
    """Return a text that is equal for equal equations, whatever values and tables hold."""
    known: str | None = vars(equations).get(_KNOWN)
    if known is None:
        known = _taken(equations)
        note_fingerprint(equations, known)
    return known


def note_fingerprint(equations: Equations, known: str) -> None:
    """Note the fingerprint of equations, so that it is not taken again."""
    object.__setattr__(equations, _KNOWN, known)


def _taken(equations: Equations) -> str:
    import casadi

    e = equations
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    results = [e.rate, e.residual, e.output, *event_expressions(e)]
    results += [] if e.seam is None else [e.seam.values]
    function = casadi.Function("equations", inputs, results)
    facts = [casadi.CasadiMeta.version(), repr(e.positions), repr(e.velocities)]
    facts += [f"{block.start}:{block.stop}:{block.tolerance!r}" for block in e.blocks]
    facts += [event.direction for event in e.events]
    facts += [] if e.seam is None else [*e.seam.names, *e.seam.parts]
    return hashlib.sha256(
        "\n".join([*facts, function_text(function, e.tables)]).encode()
    ).hexdigest()


def function_text(function: Any, tables: Sequence[CurveTable]) -> str:
    """Return what a function computes as a text, without the numbers of tables."""
    if not tables:
        return str(function.serialize())
    program = read_function(function, tables)
    return repr(([table.order for table in tables], program))


def generator_fingerprint() -> str:
    """Return a text that changes with the modules that turn equations into C."""
    folder = Path(__file__).parents[1]
    files = sorted(
        file for pattern in _GENERATORS for file in folder.glob(pattern) if file.is_file()
    )
    texts = [file.read_text(encoding="utf-8") for file in files]
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()
