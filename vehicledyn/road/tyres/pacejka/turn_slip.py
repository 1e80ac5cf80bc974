"""Turn slip of the Magic Formula 6: how a curved path changes forces and moments.

With the spin φ, the turn slip φ_t = -ψ̇/V and the share of camber in it,

    φ = φ_t + (1 - ε_γ) Ω sin γ/V,

the factors ζ_0 to ζ_8 reduce peaks, stiffness and trail, and shift the side force. ζ_0 is zero and
camber acts by φ alone. Without turn slip all are one, and ζ_8 adds nothing.

References
----------
Pacejka (2012), Tire and Vehicle Dynamics, section 4.3.3, equations (4.75) to (4.106), by way of
the public program MFeval; the book itself was not at hand, nor public numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.pacejka.formula_52 import PureCurve
from vehicledyn.road.tyres.pacejka.state import Slip, TyreState, tangent
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

_SMALL = 1e-3
"""Keeps quotients of the formulas away from zero [1]."""


@dataclass(frozen=True)
class TurnSlipFactors:
    """Factors ζ_0 to ζ_7; ``z8`` is the moment that the source adds as ζ_8 - 1 [N m].

    ``z4`` is 1 + S_Hyφ, without the part - S_Vyγ/K_yα of the source, which the side force itself
    has.
    """

    z0: Scalar = 1.0
    z1: Scalar = 1.0
    z2: Scalar = 1.0
    z3: Scalar = 1.0
    z4: Scalar = 1.0
    z5: Scalar = 1.0
    z6: Scalar = 1.0
    z7: Scalar = 1.0
    z8: Scalar = 0.0


NO_TURN = TurnSlipFactors()
USED = ("PDXP1", "PKYP1", "PDYP1", "PHYP2", "QDTP1", "QCRP1", "QBRP1", "QDRP1")
"""Coefficients of which one at least is not zero where a file has turn slip."""


def turn_factors(
    p: Coefficients,
    contact: TyreInput,
    s: TyreState,
    slip: Slip,
    straight: tuple[PureCurve, PureCurve, Scalar],
) -> TurnSlipFactors:
    """Return the factors at a contact; none without turn slip or its coefficients.

    ``straight`` are the curves of F_y without turn slip, at no camber and at this one, and the
    weight G_yκ of longitudinal slip.
    """
    turning = contact.turn_slip
    if isinstance(turning, int | float) and turning == 0.0:
        return NO_TURN
    if all(getattr(p, name) == 0.0 for name in USED):
        return NO_TURN
    df, radius = s.load_change, p.UNLOADED_RADIUS
    share = p.PECP1 * (1.0 + p.PECP2 * df)
    phi = turning + (1.0 - share) * slip.camber / radius
    size = ops.smooth_norm(radius * phi, 0.0, 1e-9)
    peak_x = p.PDXP1 * (1.0 + p.PDXP2 * df) * ops.cos(ops.atan(p.PDXP3 * s.slip))
    peak_y = p.PDYP1 * (1.0 + p.PDYP2 * df) * ops.cos(ops.atan(p.PDYP3 * tangent(s.angle)))
    lost = peak_y * (size + p.PDYP4 * ops.sqrt(size))
    z3 = ops.cos(ops.atan(p.PKYP1 * size * size))
    upright, leaning, weight = straight
    lever = _Lever(radius * phi, ops.smooth_norm(radius * turning, 0.0, 1e-9), share)
    z8, z7 = _spin_moment(p, s, slip, lever, (leaning.friction, weight))
    return TurnSlipFactors(
        z0=0.0,
        z1=ops.cos(ops.atan(peak_x * size)),
        z2=ops.cos(ops.atan(lost)),
        z3=z3,
        z4=1.0 + _shift(p, s, lever, upright.stiffness * z3),
        z5=ops.cos(ops.atan(p.QDTP1 * radius * phi)),
        z6=ops.cos(ops.atan(p.QBRP1 * size)),
        z7=z7,
        z8=z8,
    )


class _Lever(NamedTuple):
    """R_0 φ, R_0 |φ_t| [1] and the share ε_γ of camber in the spin."""

    spin: Scalar
    turn: Scalar
    share: Scalar


def _shift(p: Coefficients, s: TyreState, lever: _Lever, stiffness: Scalar) -> Scalar:
    """Return S_Hyφ, (4.80) and (4.85) to (4.89); ``stiffness`` is K_yα at no camber."""
    df = s.load_change
    thrust = s.load * (p.PKY6 + p.PKY7 * df) * (1.0 + p.PPY5 * s.pressure_change) * p.LKYC
    slope = thrust / ops.maximum(1.0 - lever.share, _SMALL)
    D = (p.PHYP2 + p.PHYP3 * df) * ops.sign(s.speed)
    B = slope / (p.PHYP1 * D * stiffness + _SMALL * ops.sign(stiffness))
    x = B * lever.spin
    bent = ops.atan(x - p.PHYP4 * (x - ops.atan(x)))
    return D * ops.sin(p.PHYP1 * bent)


def _spin_moment(
    p: Coefficients, s: TyreState, slip: Slip, lever: _Lever, side: tuple[Scalar, Scalar]
) -> tuple[Scalar, Scalar]:
    """Return D_rφ and ζ_7, which brings the moment to its value at 90°, (4.93) to (4.104).

    ``side`` are μ_y and the weight G_yκ of longitudinal slip.
    """
    friction, weight = side
    df, radius = s.load_change, p.UNLOADED_RADIUS
    shape = max(min(p.QDRP1, 1.0), 0.1)
    standing = p.QCRP1 * friction * radius * s.load * ops.sqrt(s.load / s.nominal) * p.LMP
    peak = standing / math.sin(0.5 * math.pi * shape)
    slope = p.QDZ8 + p.QDZ9 * df + (p.QDZ10 + p.QDZ11 * df) * ops.absolute(slip.camber)
    slope *= s.load * radius * p.LKZC
    B = slope / (shape * peak * ops.maximum(1.0 - lever.share, _SMALL) + _SMALL)
    moment = peak * ops.sin(shape * ops.atan(B * lever.spin))
    across = standing * weight * (2.0 / math.pi) * ops.atan(p.QCRP2 * lever.turn)
    reached = ops.minimum(across / (ops.absolute(moment) + _SMALL * standing), 1.0)
    z7 = (2.0 / math.pi) * (0.5 * math.pi - ops.asin(reached))
    return moment, z7
