"""Start values that the constraints do not allow: reported when a run starts elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.units import shown

if TYPE_CHECKING:
    from vehicledyn.analyses.preparation.prepare import AssembledPoint
    from vehicledyn.analyses.preparation.prepared import Prepared

_AGREE = 1e-6
"""Distance from a start value that needs no word [m, rad]."""
_MOST = 4


def moved_starts(prepared: Prepared, start: AssembledPoint) -> list[str]:
    """Return a line that says which coordinates of a system start elsewhere than was given.

    Given is what is not zero. Positions that contradict the constraints are no mistake, because
    a rough guess of where the loops close is one too; rates that do are refused.
    """
    if prepared.subject.ports.body:  # its road decides where it starts
        return []
    e = prepared.equations
    values = dict(zip((s.name for s in e.states), start.state, strict=True))
    values |= dict(zip((u.name for u in e.unknowns), start.unknowns, strict=True))
    moved = [
        f"'{j.name}' from {shown(j.start, j.unit)} to {shown(float(values[j.name]), j.unit)}"
        for j in prepared.subject.system.joints()
        if j.role == "auto" and j.start != 0.0 and j.name in values
        if abs(values[j.name] - j.start) > _AGREE
    ]
    if not moved:
        return []
    others = [f"and {len(moved) - _MOST} more"] if len(moved) > _MOST else []
    listed = ", ".join([*moved[:_MOST], *others])
    return [
        f"start moved so that the constraints hold: {listed}; 'role: independent' keeps a start"
    ]
