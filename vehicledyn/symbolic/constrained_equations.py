"""Motion with constraints as residuals, nothing solved: what index-3 and index-2 methods take.

    0 = M(q, p) q̈ + c(t, q, q̇, s, p) - Q(t, q, q̇, s, p) + J(t, q, p)ᵀ λ
    0 = h(t, q, p),    0 = J q̇ + ∂h/∂t,    0 = J q̈ + γ(t, q, q̇, p)
    ṡ = f(t, q, q̇, s, p)

with all coordinates q that are not driven, and further states s. Masses are never inverted, so
the expressions grow with the number of bodies alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

Expression = Any
"""A column of ``casadi.SX`` expressions or symbols."""


@dataclass(frozen=True)
class ConstrainedEquations:
    """Symbolic residuals of a constrained motion.

    ``force`` is the first equation above, shape (n, 1), with the symbols ``multiplier`` for λ
    (m, 1). ``gap`` are the constraints (m, 1), ``opening`` their rates and ``quadratic`` is γ.
    ``jacobian`` is J by the speeds, shape (m, n). ``labels`` name the rows. ``positions``,
    ``velocities`` and ``others`` are the places of q, q̇ and s in the state of the equations that
    these belong to. ``output`` derives their channels from the symbols above, a column: those of a
    state off the constraints with any accelerations and multipliers; None where there are no
    constraints, so that the channels of the equations are the same.
    """

    time: Expression
    position: Expression
    velocity: Expression
    acceleration: Expression
    multiplier: Expression
    other: Expression
    parameter: Expression
    force: Expression
    gap: Expression
    opening: Expression
    quadratic: Expression
    jacobian: Expression
    other_rate: Expression
    labels: tuple[str, ...]
    positions: tuple[int, ...]
    velocities: tuple[int, ...]
    others: tuple[int, ...]
    output: Callable[[], Expression] | None = None

    @property
    def spread(self) -> Expression:
        """The Jacobian with those elements alone that are not always zero."""
        import casadi

        return casadi.sparsify(self.jacobian)
