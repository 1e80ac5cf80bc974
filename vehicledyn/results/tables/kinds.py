"""Kinds of result files by their formats: what each holds, in words and as one."""

from __future__ import annotations

from typing import NamedTuple


class ResultKind(NamedTuple):
    """What messages say that a file holds, and what :mod:`vehicledyn` calls its data."""

    holds: str
    name: str


TABLES = {
    "vehicledyn-modes": ResultKind("eigenmodes", "modes"),
    "vehicledyn-response": ResultKind("frequency responses", "response"),
    "vehicledyn-profiles": ResultKind("contact geometry", "contacts"),
    "vehicledyn-hunt": ResultKind("a hunting study", "hunt"),
    "vehicledyn-equilibrium": ResultKind("an equilibrium", "equilibrium"),
    "vehicledyn-sensitivity": ResultKind("sensitivities", "sensitivity"),
    "vehicledyn-optimum": ResultKind("an optimum", "optimum"),
    "vehicledyn-manoeuvre": ResultKind("an optimal manoeuvre", "manoeuvre"),
    "vehicledyn-identification": ResultKind("identified parameters", "identification"),
    "vehicledyn-uncertainty": ResultKind("an uncertainty study", "uncertainty"),
    "vehicledyn-handling": ResultKind("handling of a road vehicle", "handling"),
    "vehicledyn-cam": ResultKind("a cam", "cam"),
    "vehicledyn-tyre": ResultKind("forces of tyres", "tyre"),
    "vehicledyn-track": ResultKind("a railway track", "track"),
}
"""Files without a time axis; each is written by the module of the same folder that has its format.
"""

KINDS = TABLES | {
    "vehicledyn-result": ResultKind("a run", "run"),
    "vehicledyn-study": ResultKind("a sweep", "study"),
}


def held(format_name: str) -> str:
    """Return what a file of a format holds; the format where it is none of this program."""
    known = KINDS.get(format_name)
    return format_name if known is None else known.holds
