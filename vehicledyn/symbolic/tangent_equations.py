"""Equations with their tangents along one direction, as one system.

    x˙ = f(x, z, p),  0 = g(x, z, p),  y = h(x, z, p)
    ξ˙ = f_x ξ + f_z ζ + f_p v,  0 = g_x ξ + g_z ζ + g_p v,  η = h_x ξ + h_z ζ + h_p v

A method's step of both is its step of the first together with the tangent of that step, so
derivatives of the whole are second derivatives of the motion.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations

TANGENT = "tangent."
"""First word of the names of tangents, and of the direction that they are along."""


def with_tangents(equations: Equations) -> Equations:
    """Return equations together with their tangents; events are those of the first.

    States, unknowns, parameters and channels are those given, then as many tangents of these; the
    tangents of the parameters are the direction v.
    """
    e = equations
    of_states, of_unknowns, direction = (
        ops.symbols(name, len(items))
        for name, items in (("xi", e.states), ("zeta", e.unknowns), ("v", e.parameters))
    )
    point = ops.stacked(e.state, e.algebraic, e.parameter)
    moved = ops.stacked(of_states, of_unknowns, direction)
    rate, residual, output = (
        ops.stacked(part, ops.dense(ops.derivative(part, point, moved)))
        for part in (e.rate, e.residual, e.output)
    )
    n = len(e.unknowns)
    later = (
        replace(b, name=TANGENT + b.name, start=b.start + n, stop=b.stop + n) for b in e.blocks
    )
    return replace(
        e,
        state=ops.stacked(e.state, of_states),
        algebraic=ops.stacked(e.algebraic, of_unknowns),
        parameter=ops.stacked(e.parameter, direction),
        rate=rate,
        residual=residual,
        output=output,
        states=_doubled(e.states),
        unknowns=_doubled(e.unknowns),
        parameters=_doubled(e.parameters),
        channels=_doubled(e.channels),
        blocks=(*e.blocks, *later),
        attitudes=(),
        slopes=None,
        constrained=None,
        motion_residuals=None,
        seam=None,
    )


def _doubled(items: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return named quantities, then their tangents, which are zero at first."""
    return (*items, *map(_tangent, items))


def _tangent(item: Any) -> Any:
    words = {"name": TANGENT + item.name, "description": f"Tangent of: {item.description}"}
    zero = {key: 0.0 for key in ("start", "value") if hasattr(item, key)}
    return replace(item, **words, **zero)
