"""Sentences about what a tyre property file asks for by USE_MODE and FE_METHOD beside the usual."""

from __future__ import annotations

from collections.abc import Iterator

from vehicledyn.road.tyre_files.use_mode import DYNAMICS
from vehicledyn.road.tyres.file_tyre import FileTyre
from vehicledyn.road.tyres.pac2002 import OF_CHRONO

_ACTING = {
    "none": "no force but the load acts",
    "longitudinal": "only longitudinal force and rolling resistance act",
    "lateral": "only side force, overturning and aligning moment act",
    "uncombined": "slips do not weaken each other's forces",
}
_KINDS = ("", "of_tyre", "contact_patch", "contact_patch")
"""Relaxation by the place of the dynamics."""


def asked(tyre: FileTyre, *, relaxed: bool = False) -> Iterator[str]:
    """Yield what the file of a tyre asks for; ``relaxed`` says whether slip is transient."""
    mode = tyre.content.asked
    head = f"{tyre.path.name}: USE_MODE {mode.number}"
    if tyre.acting is None and tyre.forces_that_act in _ACTING:
        yield f"{head}: {_ACTING[tyre.forces_that_act]}; 'acting: combined' lets all act"
    if tyre.on_ellipse and tyre.convention not in OF_CHRONO:
        method = tyre.content.texts.get("FE_METHOD", "")
        why = f"FE_METHOD '{method}'" if method else "no coefficients of combined slip"
        yield f"{tyre.path.name}: {why}: slips combine by the friction ellipse"
    if mode.turn_slip and tyre.turn_slip is None and not tyre.has_turn_slip:
        yield f"{head} asks for turn slip, which the law or its coefficients have not; none acts"
    if mode.mirrored:
        yield f"{head}: on a vehicle it is the mirror image of what the file describes"
    if mode.dynamics and not relaxed:
        kind = _KINDS[mode.dynamics]
        yield (
            f"{head} asks for {DYNAMICS[mode.dynamics]}, without 'relaxation' slip is steady: give "
            f"'relaxation: {{kind: {kind}}}'"
        )
