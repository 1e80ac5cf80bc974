"""Starts and failures of a run at which the mass matrix is singular, with the motion named."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.memory.equation_memory import is_resisted, remember_resisted
from vehicledyn.base.errors import InputError

if TYPE_CHECKING:
    from vehicledyn.analyses.preparation.prepared import Prepared
    from vehicledyn.multibody.equations.singular_mass import Idle

_NAMED = 3
"""Most motions that are named."""
Vector = NDArray[np.float64]
_HARDLY = 1e-3
"""Share of inertia below which a motion is named as a likely cause of a failure [1]."""


def refuse_idle_start(prepared: Prepared, time: float, state: Vector, unknowns: Vector) -> None:
    """Raise InputError if nothing resists a motion at the point that a run starts from.

    Such is the outer and inner of three turns while the middle one makes their axes the same.

    Parameters
    ----------
    prepared
        The system.
    time
        Time [s].
    state, unknowns
        The point.
    """
    found = _idle(prepared, time, state, unknowns)
    if not found:
        return
    from vehicledyn.multibody.equations.singular_mass import state_of

    names = [name for idle in found for name in idle.shares]
    remedy = "start these coordinates elsewhere, or take joints in another order"
    raise InputError(
        f"the mass matrix is {state_of(found)} at the start: {_described(prepared, found)} there; "
        f"{found[0].remedy if found[0].is_negative else remedy}",
        about=names,
    )


def refuse_rigid_loops(prepared: Prepared) -> None:
    """Raise InputError for loops without freedom, of which nothing can move in a run."""
    from vehicledyn.multibody.loops.assembly_diagnosis import RigidLoop

    known: Any = prepared.equations.structure["rigid_loops"]
    loops = [RigidLoop(tuple(r["constraints"]), tuple(r["coordinates"])) for r in known]
    if loops:
        text = "; ".join(map(str, loops))
        raise InputError(text, about=[name for loop in loops for name in loop.constraints])


def redundant_constraints(prepared: Prepared) -> list[str]:
    """Return which constraints say what others say already, a line each."""
    known: Any = prepared.equations.structure["redundancies"]
    return [
        f"redundant: '{item['constraint']}' follows from "
        + ", ".join(f"'{name}'" for name in item["follows_from"])
        for item in known
        if item["follows_from"]
    ]


def constraint_notes(prepared: Prepared) -> list[str]:
    """Return how constraints are treated where it is with multipliers, and which are redundant."""
    notes = redundant_constraints(prepared)
    if prepared.equations.structure.get("constraint_method") == "multipliers":
        notes.insert(0, "constraints: multipliers and projection ('constraint_method')")
    return notes


def nearly_singular_mass(prepared: Prepared, time: float, state: Vector, unknowns: Vector) -> str:
    """Return which motion hardly anything resists at a point; empty if there is none."""
    found = _idle(prepared, time, state, unknowns, share=_HARDLY)
    if not found:
        return ""
    described = _described(prepared, found).replace("nothing resists", "hardly anything resists")
    return f"near t = {time:.6g} s the mass matrix is almost singular: {described}"


def _described(prepared: Prepared, found: list[Idle]) -> str:
    from vehicledyn.multibody.equations.singular_mass import owners_of

    owners = owners_of(prepared.subject.system)
    named = [idle.words(owners) for idle in found[:_NAMED]]
    hidden = len(found) - len(named)
    return "; ".join([*named, *([f"and {hidden} more motions"] if hidden else [])])


def _idle(
    prepared: Prepared, time: float, state: Vector, unknowns: Vector, **share: float
) -> list[Idle]:
    kernel, key = prepared.kernel, prepared.derived.key
    point = (time, state, unknowns, kernel.parameters, list(share.values()))
    if key and is_resisted(key, *point):
        return []
    values = np.array(kernel.outputs(time, state, unknowns))
    rows = {channel.name: k for k, channel in enumerate(prepared.equations.channels)}
    joints = prepared.resistance.joints
    q = np.array([values[rows[j.name]] if j.name in rows else j.start for j in joints])
    if not np.isfinite(q).all():
        return []
    found = prepared.resistance.idle(time, q, kernel.parameters, **share)
    if key and not found:
        remember_resisted(key, *point)
    return found
