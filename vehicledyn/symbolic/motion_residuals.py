"""Motion with given accelerations: what is missing for them to be those of the equations.

    0 = r(t, x, z, p, a)

at the accelerations a that the equations of motion give. No mass matrix is solved in r, so that
its derivatives are short: da = -(∂r/∂a)⁻¹ dr, where ∂r/∂a is the reduced mass matrix.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Expression = Any
"""A column of ``casadi.SX`` expressions or symbols."""


@dataclass(frozen=True)
class MotionResiduals:
    """Residuals of a motion at given accelerations.

    ``residual`` (n,) is r in terms of the symbols ``time``, ``state``, ``algebraic``,
    ``parameter`` and ``acceleration`` (n,), ``mass`` (n, n) is ∂r/∂a, symmetric; ``rows`` are the
    states whose rates the accelerations are.
    """

    time: Expression
    state: Expression
    algebraic: Expression
    parameter: Expression
    acceleration: Expression
    residual: Expression
    mass: Expression
    rows: tuple[int, ...]
