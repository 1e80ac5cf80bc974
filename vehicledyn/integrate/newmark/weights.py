"""Weights of Newmark's family of methods, by what is asked of them.

Chung, Hulbert (1993), Journal of Applied Mechanics 60, 371-375; Jansen, Whiting, Hulbert (2000),
Computer Methods in Applied Mechanics and Engineering 190, 305-319 (first-order states).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal, TypeAlias

from vehicledyn.base.errors import InputError

if TYPE_CHECKING:
    from vehicledyn.kernel.engine import Vector
    from vehicledyn.symbolic.equations import Equations

Constraints: TypeAlias = Literal["reduced", "index3", "stabilised_index2"]
"""How a step treats constraints; "reduced" solves them within the rates."""

Velocities: TypeAlias = Literal["own", "projected"]
"""What steps with multipliers show: "own" velocities, accelerations and multipliers, or "projected"
ones, those of the nearest motion on the constraints."""

SHORTEST = 1e-4
"""Part of a step below which halving gives up where Newton's method asks for it."""
TINY = 1e-9
"""Part of the longest step below which halving gives up where the error asks for it."""
FIRST_HALVINGS = 6
"""How often the first step is halved where the error is watched, which is unknown at a start."""

_SHARE = 1e-2
FEW_STATES = 4
"""States up to which Newton's method is iterated further, which costs little there."""
_FURTHER = 1e-12
"""Part of a step's local error that it may leave there."""


@dataclass(frozen=True)
class Weights:
    """Weights of a step: of accelerations and rates at its start, and of Newmark's formulas.

    ``first_order_mass`` is the weight of the auxiliary rate of first-order states at the end.
    ``share`` is the part of a step's local error that Newton's iteration may leave, within bounds;
    none where a step damps nothing, as what is left adds up in the energy there.
    """

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    first_order_mass: float
    share: float = _SHARE

    @property
    def first_order_gamma(self) -> float:
        """Weight of the new auxiliary rate that makes first-order states of order two."""
        return self.gamma + self.first_order_mass - 1.0 + self.alpha_m

    @property
    def shift(self) -> float:
        """Part of a step by which the acceleration-like a is ahead of its time."""
        return self.alpha_m - self.alpha_f

    @property
    def left_across_constraints(self) -> float:
        """Factor that a step of index 3 leaves of errors across constraints: 1 damps none.

        Of velocities and a it is the larger root of β r² + (½ - 2 β + γ) r + ½ + β - γ = 0, as
        positions stay where they are; of forces αf / (1 - αf).
        """
        beta, gamma = self.beta, self.gamma
        half, rest = 0.5 * (0.5 - 2.0 * beta + gamma), beta * (0.5 + beta - gamma)
        room = half**2 - rest
        root = abs(half) + math.sqrt(room) if room > 0.0 else math.sqrt(abs(rest))
        return max(root / beta, self.alpha_f / (1.0 - self.alpha_f))

    @property
    def order(self) -> int:
        """Order of the method: two where velocities are free of errors of first order."""
        return 2 if abs(self.gamma - 0.5 + self.alpha_m - self.alpha_f) < 1e-9 else 1

    def error_of_positions(self, h: float, change: Vector) -> Vector:
        """Return the local error of positions about, of a step h [s] in which a has changed so.

        The acceleration-like a belongs to the time (αm - αf) h later.
        """
        found: Vector = h**2 * (1.0 / 6.0 - 0.5 * self.shift - self.beta) * change
        return found

    def error_of_rates(
        self, h: float, change: Vector, size_before: float, change_before: Vector | None
    ) -> Vector:
        """Return the local error of velocities about, from the changes of a in two steps."""
        shift = self.shift
        found: Vector = h * (0.5 - shift - self.gamma) * change
        if change_before is not None:
            missed = (1.0 - self.gamma) * shift**2 + self.gamma * (1.0 + shift) ** 2
            bend = change - h / size_before * change_before
            found = found + h * (1.0 / 6.0 - 0.5 * missed) * bend
        return found

    def settled(self, states: int) -> Weights:
        """Return the weights for steps of one size of a system with so many states.

        Of a system with few states they are those of the method digit by digit.
        """
        return replace(self, share=_FURTHER * (self.share > 0.0)) if states <= FEW_STATES else self

    @staticmethod
    def newmark(beta: float, gamma: float) -> Weights:
        """Return the weights of Newmark's method."""
        return Weights(0.0, 0.0, beta, gamma, 1.0, _SHARE if gamma > 0.5 else 0.0)

    @staticmethod
    def hht(spectral_radius: float) -> Weights:
        """Return those of Hilber, Hughes and Taylor; the radius lies between 1/2 and 1."""
        alpha_f = (1.0 - spectral_radius) / (1.0 + spectral_radius)
        beta, gamma = 0.25 * (1.0 + alpha_f) ** 2, 0.5 + alpha_f
        return Weights(0.0, alpha_f, beta, gamma, 1.0, _SHARE if spectral_radius < 1.0 else 0.0)

    @staticmethod
    def generalised_alpha(spectral_radius: float) -> Weights:
        """Return those of Chung and Hulbert; the radius lies between 0 and 1."""
        r = spectral_radius
        alpha_m, alpha_f = (2.0 * r - 1.0) / (r + 1.0), r / (r + 1.0)
        excess = alpha_f - alpha_m
        mass = 0.5 * (3.0 - r) / (1.0 + r)
        beta, gamma = 0.25 * (1.0 + excess) ** 2, 0.5 + excess
        return Weights(alpha_m, alpha_f, beta, gamma, mass, _SHARE if r < 1.0 else 0.0)


def refuse_constraints(equations: Equations, constraints: Constraints) -> None:
    """Raise InputError if equations have no residuals with multipliers though these are wanted."""
    if constraints == "reduced":
        return
    if equations.constrained is None:
        raise InputError(
            f"the equations of '{equations.name}' were not derived from bodies and joints; "
            "'constraints' of this method must be 'reduced'"
        )
    equations.constrained()
