"""Turn slip of the Magic Formula 6: how a curved path changes forces and moments.

With the spin φ, the turn slip φ_t = -ψ̇/V and the share of camber in it,

    φ = φ_t + (1 - ε_γ) Ω sin γ/V,

the factors ζ_0 to ζ_8 reduce peaks, stiffness and trail, and shift the side force. ζ_0 is zero and
camber acts by φ alone. Without turn slip all are one, and ζ_8 adds nothing.

References
----------
Pacejka (2012), Tire and Vehicle Dynamics, section 4.3.3, equations (4.75) to (4.101), recalled
and checked by their limits; no public numbers were at hand.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.pacejka.state import Slip, State
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

_SMALL = 1e-3
"""Keeps quotients of the formulas away from zero [1]."""


@dataclass(frozen=True)
class Turn:
    """Factors ζ_0 to ζ_7; ``z8`` is the moment that the source adds as ζ_8 - 1 [N m]."""

    z0: Scalar = 1.0
    z1: Scalar = 1.0
    z2: Scalar = 1.0
    z3: Scalar = 1.0
    z4: Scalar = 1.0
    z5: Scalar = 1.0
    z6: Scalar = 1.0
    z7: Scalar = 1.0
    z8: Scalar = 0.0


NO_TURN = Turn()
USED = ("PDXP1", "PKYP1", "PDYP1", "PHYP2", "QDTP1", "QCRP1", "QBRP1", "QDRP1")
"""Coefficients of which one at least is not zero where a file has turn slip."""


def turn_factors(
    p: Coefficients,
    contact: TyreInput,
    s: State,
    slip: Slip,
    stiffness: tuple[Scalar, Scalar],
) -> Turn:
    """Return the factors at a contact; none without turn slip or its coefficients.

    ``stiffness`` are K_xκ and K_yα without turn slip.
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
    peak_y = p.PDYP1 * (1.0 + p.PDYP2 * df) * ops.cos(ops.atan(p.PDYP3 * slip.angle))
    lost = peak_y * (size + p.PDYP4 * ops.sqrt(size))
    z2 = ops.cos(ops.atan(lost))
    trail = ops.cos(ops.atan(p.QDTP1 * radius * phi))
    z3 = ops.cos(ops.atan(p.PKYP1 * size * size))
    z8, z7 = _spin_moment(p, s, slip, phi=phi, size=size, stiffness=stiffness[0])
    return Turn(
        z0=0.0,
        z1=ops.cos(ops.atan(peak_x * size)),
        z2=z2,
        z3=z3,
        z4=1.0 + _shift(p, s, slip, phi=radius * phi, slopes=(stiffness[1] * z3, share)),
        z5=trail,
        z6=ops.cos(ops.atan(p.QBRP1 * size)),
        z7=z7,
        z8=z8,
    )


def _shift(
    p: Coefficients, s: State, slip: Slip, *, phi: Scalar, slopes: tuple[Scalar, Scalar]
) -> Scalar:
    """Return ζ_4 - 1 = S_Hyφ - S_Vyγ/K_yα, the shift of the side force.

    ``slopes`` are K_yα and the share ε_γ of camber in the spin.
    """
    df, (stiffness, share) = s.load_change, slopes
    thrust = s.load * (p.PKY6 + p.PKY7 * df) * (1.0 + p.PPY5 * s.pressure_change) * p.LKYC
    slope = thrust / (1.0 - share + _SMALL)
    D = (p.PHYP2 + p.PHYP3 * df) * ops.sign(s.speed)
    B = slope / (p.PHYP1 * D * stiffness + _SMALL * ops.sign(stiffness))
    x = B * phi
    bent = ops.atan(x - p.PHYP4 * (x - ops.atan(x)))
    leaning = s.load * (p.PVY3 + p.PVY4 * df) * slip.camber * p.LKYC * p.LMUY
    return D * ops.sin(p.PHYP1 * bent) - leaning / stiffness


def _spin_moment(
    p: Coefficients, s: State, slip: Slip, *, phi: Scalar, size: Scalar, stiffness: Scalar
) -> tuple[Scalar, Scalar]:
    """Return the spin moment D_rφ and the exponent ζ_7, that brings it to its value at 90°."""
    radius = p.UNLOADED_RADIUS
    ratio = ops.sqrt(s.load / s.nominal)
    standing = p.QCRP1 * p.PDY1 * radius * s.load * ratio * p.LMUY * p.LMP
    peak = standing / math.sin(0.5 * math.pi * max(min(p.QDRP1, 1.0), 0.1))
    slope = s.load * radius * p.QDRP1 * (p.QDZ8 + p.QDZ9 * s.load_change) * p.LKZC
    B = slope / (p.QDRP1 * peak + _SMALL)
    moment = peak * ops.sin(p.QDRP1 * ops.atan(B * radius * phi))
    across = standing * (2.0 / math.pi) * ops.atan(p.QCRP2 * size)
    reached = ops.minimum(across / (ops.absolute(moment) + _SMALL * standing), 1.0)
    z7 = (2.0 / math.pi) * (0.5 * math.pi - ops.asin(reached))
    return moment, z7
