"""Names that ask for derivatives of analyses that have none, with the reason."""

from __future__ import annotations

import re
from collections.abc import Sequence

from vehicledyn.base.errors import InputError

_CALL = re.compile(r"(\w+)\(.*\)")

_GEOMETRY = "it computes the geometry of files, which are not part of the equations"
_STUDY = "a study is not a function of one set of parameters"
REASONS = {
    "handling": "its tests are simulated one by one; ask for steady(...) of steady cornering, yaw "
    "responses and limits, and for figures of the run of one test",
    "hunt": "its cycles have names of their own, cycle_amplitude(CHANNEL) and the like, critical "
    "speeds critical_speed and nonlinear_critical_speed",
    "modes": "ask for eigenvalues, mode_shapes and critical_speed",
    "eig": "ask for eigenvalues, mode_shapes and critical_speed",
    "response": "ask for gain(OUTPUT, INPUT, 1.5 Hz), phase(...), peak_gain(...)",
    "linearise": "derivatives of its matrices come from linearise with 'to'",
    "equilibrium": "ask for equilibrium.NAME",
    "simulate": "ask for channels and key figures by their names",
    "run": "ask for channels and key figures by their names",
    "contact_geometry": "ask for profiles(QUANTITY, SHIFT, rail=60E1) of a wheel profile",
    "track": _GEOMETRY,
    "assess": "it filters a stored result; ask for figures of the run",
    "compare": "it compares stored results",
    "sweep": _STUDY,
    "optimise": _STUDY,
    "optimise_manoeuvre": _STUDY,
    "identify": _STUDY,
    "identify_study": _STUDY,
    "uncertainty": _STUDY,
    "uncertainty_study": _STUDY,
}
"""Why results of an analysis, by its name, have no derivatives here, or how else to ask."""


def refuse_other_analyses(names: Sequence[str]) -> None:
    """Raise InputError for names such as ``rig(wheel.toe_gain)``."""
    for name in names:
        match = _CALL.fullmatch(name)
        if match and match[1] in REASONS:
            raise InputError(
                f"'{name}': results of '{match[1]}' are not asked for so: {REASONS[match[1]]}"
            )
