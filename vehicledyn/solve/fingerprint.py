"""Fingerprints of equations and of the generator: equal ones give equal machine code."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from vehicledyn.solve.functions import event_expressions
from vehicledyn.solve.instructions import read_function
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.tables import CurveTable

_GENERATORS = (
    "alike.py",
    "call_code.py",
    "code.py",
    "function_body.py",
    "functions.py",
    "implicit_source.py",
    "instructions.py",
    "latency.py",
    "loop_code.py",
    "lowering.py",
    "mirrored.py",
    "negated.py",
    "nodes.py",
    "operation_code.py",
    "piece_code.py",
    "pieces.py",
    "point_source.py",
    "reciprocals.py",
    "rolled.py",
    "room.py",
    "row_code.py",
    "schedule.py",
    "selected.py",
    "side_by_side.py",
    "source.py",
    "split_calls.py",
    "sums.py",
    "table_rows.py",
    "tail.py",
    "value_code.py",
    "wide_functions.py",
    "../symbolic/chain_rule.py",
)
_SHARED = (
    "real.h",
    "elementary.c",
    "fours.h",
    "steps.c",
    "loop.c",
    "batch.c",
    "slopes.c",
    "flow.c",
    "march.c",
    "tangents.c",
    "implicit.c",
    "columns.c",
)


def fingerprint(equations: Equations) -> str:
    """Return a text that is equal for equal equations, whatever values and tables hold."""
    import casadi

    e = equations
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    results = [e.rate, e.residual, e.output, *event_expressions(e)]
    function = casadi.Function("equations", inputs, results)
    facts = [casadi.CasadiMeta.version(), repr(e.positions), repr(e.velocities)]
    facts += [f"{block.start}:{block.stop}:{block.tolerance!r}" for block in e.blocks]
    facts += [event.direction for event in e.events]
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
    folder = Path(__file__).parent
    texts = [(folder / name).read_text(encoding="utf-8") for name in (*_GENERATORS, *_SHARED)]
    return hashlib.sha256("\n".join(texts).encode()).hexdigest()
