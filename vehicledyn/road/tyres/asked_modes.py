"""Sentences about what is unusual in a tyre property file: what it asks for, names, pressure."""

from __future__ import annotations

from collections.abc import Iterator

from vehicledyn.road.tyre_files.use_mode import DYNAMICS
from vehicledyn.road.tyres.file_tyre import OF_CHRONO, FileTyre

_ACTING = {
    "none": "no force but the load acts",
    "longitudinal": "only longitudinal force and rolling resistance act",
    "lateral": "only side force, overturning and aligning moment act",
    "uncombined": "slips do not weaken each other's forces",
}
_MOST = 12
"""Most names that a sentence lists."""

_KINDS = ("", "of_tyre", "contact_patch", "contact_patch")
"""Relaxation by the place of the dynamics."""


def asked(tyre: FileTyre, *, relaxed: bool = False) -> Iterator[str]:
    """Yield what is unusual in the file of a tyre; ``relaxed`` says whether slip is transient."""
    content, name = tyre.content, tyre.path.name
    if content.unknown:
        first, more = ", ".join(content.unknown[:_MOST]), len(content.unknown) - _MOST
        rest = f" and {more} more" if more > 0 else ""
        yield f"{name}: names without effect, since no law knows them: {first}{rest}"
    pressure, known = tyre.coefficients().INFLPRES, content.ranges.get("pressure")
    if known is not None and not known.lowest <= pressure <= known.highest:
        low, high = 1e-3 * known.lowest, 1e-3 * known.highest
        has = f"the file's {low:g} to {high:g} kPa"
        yield f"{name}: the pressure of {1e-3 * pressure:g} kPa is outside {has}"
    mode = content.asked
    head = f"{name}: USE_MODE {mode.number}"
    if tyre.acting is None and tyre.forces_that_act in _ACTING:
        yield f"{head}: {_ACTING[tyre.forces_that_act]}; 'acting: combined' lets all act"
    if tyre.ellipse is not None and tyre.convention not in OF_CHRONO:
        method = content.texts.get("FE_METHOD", "")
        why = f"FE_METHOD '{method}'" if method else "no coefficients of combined slip"
        yield f"{name}: {why}: slips combine by the friction ellipse"
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
