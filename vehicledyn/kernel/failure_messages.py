"""Words for a computation inside a kernel that did not end well."""

from __future__ import annotations

from vehicledyn.kernel.engine import Count, Figure, Ledger, Status
from vehicledyn.symbolic.equations import BlockKind, Equations

_WHAT: dict[BlockKind, str] = {"loop": "block", "contact": "contact of", "force": "forces of"}
_SINGULAR: dict[BlockKind, str] = {
    "loop": "the loop is at a dead centre, or other coordinates must be the dependent ones",
    "contact": "the wheel may lie flat on the ground",
    "force": "friction jams: any force of the constraint would do",
}
_UNSOLVED: dict[BlockKind, str] = {
    "loop": "the loop cannot close here",
    "contact": "no point of contact is found here (is the ground curved more than the wheel, or "
    "its soil too soft to carry it?)",
    "force": "no force of the constraint fits the friction that it brings about",
}


def describe_failure(equations: Equations, status: Status, time: float, ledger: Ledger) -> str:
    """Return what failed, where and what to do next.

    Parameters
    ----------
    equations
        The model, for the names of its states and blocks.
    status
        How the computation ended.
    time
        When it failed, or the last good time before [s].
    ledger
        Holds the number of the state or block and its residual.
    """
    where = int(ledger.counts[Count.WHERE])
    if status is Status.NOT_FINITE:
        return (
            f"state '{equations.states[where].name}' is no longer a finite number after "
            f"t = {time:.9g} s; take a smaller step, or check parameters and starting values"
        )
    block = equations.blocks[where]
    residual = f"{ledger.figures[Figure.FAILED_RESIDUAL]:.3g} {block.unit}"
    place = f"{_WHAT[block.kind]} '{block.name}' at t = {time:.9g} s"
    if status is Status.SINGULAR:
        cause = _SINGULAR[block.kind]
        return f"{place}: its equations are singular (residual {residual}); {cause}"
    if status is Status.INACCURATE:
        return (
            f"{place}: the residual {residual} stays above its tolerance "
            f"{block.tolerance:.3g} {block.unit}"
        )
    return (
        f"{place}: Newton's method did not converge (residual {residual}); "
        f"{_UNSOLVED[block.kind]}, or the step is too large"
    )
