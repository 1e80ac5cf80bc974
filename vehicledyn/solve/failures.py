"""Words for a computation inside a kernel that did not end well."""

from __future__ import annotations

from vehicledyn.solve.engine import Count, Figure, Ledger, Status
from vehicledyn.symbolic.equations import Equations


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
    what = "block" if block.is_loop else "contact of"
    place = f"{what} '{block.name}' at t = {time:.9g} s"
    if status is Status.SINGULAR and not block.is_loop:
        return (
            f"{place}: its equations are singular (residual {residual}); the wheel may lie flat "
            "on the ground"
        )
    if status is Status.SINGULAR:
        return (
            f"{place}: its equations are singular (residual {residual}); the loop is at a dead "
            "centre, or other coordinates must be the dependent ones"
        )
    if status is Status.INACCURATE:
        return (
            f"{place}: the residual {residual} stays above its tolerance "
            f"{block.tolerance:.3g} {block.unit}"
        )
    cause = "the loop cannot close here" if block.is_loop else "no point of contact is found here"
    return (
        f"{place}: Newton's method did not converge (residual {residual}); {cause}, or the step "
        "is too large"
    )
