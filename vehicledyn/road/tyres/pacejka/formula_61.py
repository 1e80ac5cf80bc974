"""Magic Formula 6.1 and 6.2: forces and moments at pure and combined slip.

Names are those of the source, as are the equations: (4.E9) to (4.E78) of chapter 4. Where public
programs disagree about the source, :class:`Rules` says what is meant. The ζ of turn slip are one
without turn slip.

References
----------
Pacejka (2012), Tire and Vehicle Dynamics, 3rd edition, section 4.3.2, by way of public programs
that agree with each other; the book itself was not at hand. Rolling resistance: Besselink,
Schmeitz, Pacejka (2010), Vehicle System Dynamics 48 (S1), 337-352, (A48), by way of MFeval.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.pacejka.formula_52 import PureCurve, forces_on_ellipse
from vehicledyn.road.tyres.pacejka.state import (
    EQUIVALENT_SLIP_FLOOR,
    FRICTION_FLOOR,
    Slip,
    TyreState,
    at_most_one,
    bent,
    resistance_share,
    sliding_friction,
    state_of,
    tangent,
    weight,
)
from vehicledyn.road.tyres.pacejka.turn_slip import NO_TURN, TurnSlipFactors, turn_factors
from vehicledyn.road.tyres.tyre import TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class Rules:
    """What is meant where public programs disagree.

    Attributes
    ----------
    pure_tangent, moment_tangent, combined_tangent
        Whether tan α stands in place of α in the pure side force, in the aligning moment and in
        the weights of combined slip.
    sine
        Whether sin γ stands in place of γ, except in F_x.
    residual_cosine_twice
        Whether the residual moment has cos α twice.
    upright_moment
        Whether shifts, stiffness factor and weight in M_z are those at no camber.
    digression
        A_μ of the digressive friction factor of vertical shifts [1].
    signed_trail
        Whether qDz3 takes γ in place of |γ|.
    equivalent_angles
        Whether equivalent slips in M_z are angles, atan √(tan² α + ...), and the arm of F_x refers
        to F_z0, not to λ_Fz0 F_z0.
    squared_load
        Whether qSx6 takes the square of the load in the arc tangent, not that of the latter.
    resistance_of_book
        Whether M_y is F_z (F_z/F_z0)^qSy7, in place of F_z0 (F_z/F_z0)^qSy7: an exponent of 0.85,
        as measured ones are, fits the latter.
    """

    pure_tangent: bool = False
    moment_tangent: bool = False
    combined_tangent: bool = True
    sine: bool = True
    residual_cosine_twice: bool = False
    upright_moment: bool = False
    digression: float = 10.0
    signed_trail: bool = False
    equivalent_angles: bool = False
    squared_load: bool = False
    resistance_of_book: bool = False


RULES = {
    "standard": Rules(),
    "tangent": Rules(pure_tangent=True, moment_tangent=True),
    "angles": Rules(combined_tangent=False, sine=False),
    "mf_tyre_library": Rules(
        moment_tangent=True,
        residual_cosine_twice=True,
        upright_moment=True,
        resistance_of_book=True,
    ),
    "mf_eval": Rules(
        combined_tangent=False,
        sine=False,
        digression=1.0,
        signed_trail=True,
        equivalent_angles=True,
        squared_load=True,
    ),
}
"""Rules by name of the convention."""


def forces_61(
    p: Coefficients, contact: TyreInput, rules: Rules, *, ellipse: str | None = None
) -> TyreForces:
    """Return the forces at combined slip, by the friction ellipse if ``ellipse`` is given."""
    s = state_of(p, contact)
    camber = ops.sin(s.camber) if rules.sine else s.camber
    tan = tangent(s.angle)
    pure = Slip(tan if rules.pure_tangent else s.angle, camber)
    combined = Slip(tan if rules.combined_tangent else s.angle, camber)
    bends = rules.digression
    along = longitudinal(p, s, digression=bends)
    upright = lateral(p, s, pure._replace(camber=0.0), digression=bends)
    across = upright if _is_zero(s.camber) else lateral(p, s, pure, digression=bends)
    share = _across_weight(p, s, combined)
    turn = turn_factors(p, contact, s, pure, (upright, across, share))
    if turn is not NO_TURN:
        along = longitudinal(p, s, turn, digression=bends)
        across = lateral(p, s, pure, turn, digression=bends)
    if ellipse:
        fx, fy = forces_on_ellipse(s, pure.angle, along, across, ellipse)
        level_force = forces_on_ellipse(s, pure.angle, along, upright, ellipse)[1]
    else:
        fx = along.force * _along_weight(p, s, combined)
        fy = share * across.force + _induced(p, s, combined, across.friction) * turn.z2
        level_force = _across_weight(p, s, combined._replace(camber=0.0)) * upright.force
    moment = Slip(tan if rules.moment_tangent else s.angle, camber)
    source = upright if rules.upright_moment else across
    mz = _aligning(p, s, moment, (along, across, source), level_force, rules=rules, turn=turn)
    nominal = p.FNOMIN if rules.equivalent_angles else s.nominal
    arm = p.SSZ1 + p.SSZ2 * fy / nominal + (p.SSZ3 + p.SSZ4 * s.load_change) * camber
    mz += p.UNLOADED_RADIUS * p.LS * arm * fx
    tilt, drag = other_moments(p, s, fx, fy, rules=rules)
    return TyreForces(*(s.share * item for item in (fx, fy, mz, tilt, drag)))


def _is_zero(value: Scalar) -> bool:
    return isinstance(value, int | float) and value == 0.0


def _digressive(scale: Scalar, digression: float) -> Scalar:
    """Return λ' = A λ / (1 + (A - 1) λ), the friction factor of vertical shifts."""
    return digression * scale / (1.0 + (digression - 1.0) * scale)


def longitudinal(
    p: Coefficients,
    s: TyreState,
    turn: TurnSlipFactors = NO_TURN,
    *,
    digression: float = Rules.digression,
) -> PureCurve:
    """Return F_x at pure longitudinal slip, (4.E9) to (4.E18)."""
    df, dp = s.load_change, s.pressure_change
    scale = sliding_friction(p, s, p.LMUX)
    Sh = (p.PHX1 + p.PHX2 * df) * p.LHX
    Sv = s.load * (p.PVX1 + p.PVX2 * df) * p.LVX * _digressive(scale, digression) * turn.z1
    C = p.PCX1 * p.LCX
    fit = (p.PDX1 + p.PDX2 * df) * (1.0 + p.PPX3 * dp + p.PPX4 * dp * dp)
    friction = ops.maximum(fit * (1.0 - p.PDX3 * s.camber * s.camber), FRICTION_FLOOR) * scale
    x = s.slip + Sh
    E = at_most_one(
        (p.PEX1 + p.PEX2 * df + p.PEX3 * df * df) * (1.0 - p.PEX4 * ops.sign(x)) * p.LEX
    )
    K = s.load * (p.PKX1 + p.PKX2 * df) * ops.exp(p.PKX3 * df)
    K *= (1.0 + p.PPX1 * dp + p.PPX2 * dp * dp) * p.LKX
    D = friction * s.load * turn.z1
    B = K / (C * D)
    return PureCurve(D * ops.sin(C * bent(B * x, E)) + Sv, friction, K, Sh, Sv, B * C)


def lateral(
    p: Coefficients,
    s: TyreState,
    slip: Slip,
    turn: TurnSlipFactors = NO_TURN,
    *,
    digression: float = Rules.digression,
) -> PureCurve:
    """Return F_y at pure side slip, (4.E19) to (4.E30)."""
    df, dp = s.load_change, s.pressure_change
    g = slip.camber
    scale = sliding_friction(p, s, p.LMUY)
    shift = _digressive(scale, digression) * turn.z2
    K = lateral_stiffness(p, s, g) * turn.z3
    leaning = s.load * (p.PVY3 + p.PVY4 * df) * g * p.LKYC * shift
    thrust = s.load * (p.PKY6 + p.PKY7 * df) * (1.0 + p.PPY5 * dp) * p.LKYC * g
    Sh = (p.PHY1 + p.PHY2 * df) * p.LHY + (thrust * turn.z0 - leaning) / K + turn.z4 - 1.0
    Sv = s.load * (p.PVY1 + p.PVY2 * df) * p.LVY * shift + leaning
    C = p.PCY1 * p.LCY
    fit = (p.PDY1 + p.PDY2 * df) * (1.0 + p.PPY3 * dp + p.PPY4 * dp * dp)
    friction = ops.maximum(fit * (1.0 - p.PDY3 * g * g), FRICTION_FLOOR) * scale
    y = slip.angle + Sh
    lean = 1.0 + p.PEY5 * g * g - (p.PEY3 + p.PEY4 * g) * ops.sign(y)
    E = at_most_one((p.PEY1 + p.PEY2 * df) * lean * p.LEY)
    D = friction * s.load * turn.z2
    B = K / (C * D)
    return PureCurve(D * ops.sin(C * bent(B * y, E)) + Sv, friction, K, Sh, Sv, B * C)


def lateral_stiffness(p: Coefficients, s: TyreState, camber: Scalar) -> Scalar:
    """Return the cornering stiffness K_yα, negative [N/rad], (4.E25)."""
    dp = s.pressure_change
    place = s.load / s.nominal
    place = place / ((p.PKY2 + p.PKY5 * camber * camber) * (1.0 + p.PPY2 * dp))
    turned = ops.sin(p.PKY4 * ops.atan(place)) * (1.0 - p.PKY3 * ops.absolute(camber))
    return p.PKY1 * s.nominal * (1.0 + p.PPY1 * dp) * p.LKY * turned


def _along_weight(p: Coefficients, s: TyreState, slip: Slip) -> Scalar:
    """Return G_xα, (4.E51) to (4.E57)."""
    B = (p.RBX1 + p.RBX3 * slip.camber * slip.camber) * p.LXAL
    B *= ops.cos(ops.atan(p.RBX2 * s.slip))
    E = at_most_one(p.REX1 + p.REX2 * s.load_change)
    at = partial(weight, B, p.RCX1, E)
    return at(slip.angle + p.RHX1) / at(p.RHX1)


def _across_weight(p: Coefficients, s: TyreState, slip: Slip) -> Scalar:
    """Return G_yκ, (4.E59) to (4.E65)."""
    B = (p.RBY1 + p.RBY4 * slip.camber * slip.camber) * p.LYKA
    B *= ops.cos(ops.atan(p.RBY2 * (slip.angle - p.RBY3)))
    E = at_most_one(p.REY1 + p.REY2 * s.load_change)
    shift = p.RHY1 + p.RHY2 * s.load_change
    at = partial(weight, B, p.RCY1, E)
    return at(s.slip + shift) / at(shift)


def _induced(p: Coefficients, s: TyreState, slip: Slip, friction: Scalar) -> Scalar:
    """Return S_Vyκ, the side force that longitudinal slip induces, (4.E66) and (4.E67)."""
    size = p.RVY1 + p.RVY2 * s.load_change + p.RVY3 * slip.camber
    size *= friction * s.load * ops.cos(ops.atan(p.RVY4 * slip.angle))
    return size * ops.sin(p.RVY5 * ops.atan(p.RVY6 * s.slip)) * p.LVYKA


def _aligning(
    p: Coefficients,
    s: TyreState,
    slip: Slip,
    curves: tuple[PureCurve, PureCurve, PureCurve],
    free: Scalar,
    *,
    rules: Rules,
    turn: TurnSlipFactors,
) -> Scalar:
    """Return the moments by pneumatic trail and residual, (4.E31) to (4.E49), (4.E71) to (4.E78).

    ``curves`` are those of F_x, of F_y and of F_y as it enters the residual moment; ``free`` is
    the side force at no camber, without that induced by longitudinal slip.
    """
    df, dp, g = s.load_change, s.pressure_change, slip.camber
    along, across, source = curves
    size = ops.absolute(g)
    at = slip.angle + p.QHZ1 + p.QHZ2 * df + (p.QHZ3 + p.QHZ4 * df) * g
    ar = slip.angle + source.horizontal_shift + source.vertical_shift / source.stiffness
    ratio = along.stiffness / across.stiffness * s.slip
    te, re = (_equivalent(angle, ratio, rules) for angle in (at, ar))
    cosine = ops.cos(s.angle)
    scale = sliding_friction(p, s, p.LMUY)
    B = (p.QBZ1 + p.QBZ2 * df + p.QBZ3 * df * df) * p.LKY / scale
    B *= 1.0 + p.QBZ4 * g + p.QBZ5 * size + p.QBZ6 * g * g
    lean = (p.QEZ4 + p.QEZ5 * g) * (2.0 / math.pi) * ops.atan(B * p.QCZ1 * at)
    E = at_most_one((p.QEZ1 + p.QEZ2 * df + p.QEZ3 * df * df) * (1.0 + lean))
    D = s.load * p.UNLOADED_RADIUS / s.nominal * (p.QDZ1 + p.QDZ2 * df)
    D *= (
        (1.0 - p.PPZ1 * dp)
        * p.LTR
        * (1.0 + p.QDZ3 * (g if rules.signed_trail else size) + p.QDZ4 * g * g)
        * turn.z5
    )
    trail = D * weight(B, p.QCZ1, E, te)
    Br = (p.QBZ9 * p.LKY / scale + p.QBZ10 * source.steepness) * turn.z6
    Dr = (p.QDZ6 + p.QDZ7 * df) * p.LRES * turn.z2
    Dr += (
        ((p.QDZ8 + p.QDZ9 * df) * (1.0 + p.PPZ2 * dp) + (p.QDZ10 + p.QDZ11 * df) * size)
        * g
        * p.LKZC
        * turn.z0
    )
    Dr = s.load * p.UNLOADED_RADIUS * scale * Dr
    Dr = Dr * cosine if rules.residual_cosine_twice else Dr
    residual = (Dr + turn.z8) * ops.cos(turn.z7 * ops.atan(Br * re))
    return (residual - trail * free) * cosine


def _equivalent(angle: Scalar, ratio: Scalar, rules: Rules) -> Scalar:
    """Return the equivalent slip of an angle and K_xκ κ/K_yα; curves of it are even."""
    if not rules.equivalent_angles:
        return ops.smooth_norm(angle, ratio, EQUIVALENT_SLIP_FLOOR)
    return ops.atan(ops.smooth_norm(tangent(angle), ratio, EQUIVALENT_SLIP_FLOOR))


def other_moments(
    p: Coefficients, s: TyreState, fx: Scalar, fy: Scalar, *, rules: Rules
) -> tuple[Scalar, Scalar]:
    """Return overturning moment and moment of rolling resistance, ISO signs [N m], (4.E69, 70)."""
    arm, g = s.load * p.UNLOADED_RADIUS, s.camber
    load, side = s.load / p.FNOMIN, fy / p.FNOMIN
    tilt = p.QSX1 * p.LVMX - p.QSX2 * g * (1.0 + p.PPMX1 * s.pressure_change) + p.QSX3 * side
    if not ops.is_structurally_zero(p.QSX4):
        x = p.QSX6 * load
        fade = ops.cos(p.QSX5 * (ops.atan(x * x) if rules.squared_load else ops.atan(x) ** 2))
        tilt += p.QSX4 * fade * ops.sin(p.QSX7 * g + p.QSX8 * ops.atan(p.QSX9 * side))
    tilt += p.QSX10 * ops.atan(p.QSX11 * load) * g
    tilt -= p.QSX12 * g * ops.absolute(g)
    extra = p.UNLOADED_RADIUS * fy * (p.QSX13 + p.QSX14 * ops.absolute(g))
    ratio = ops.absolute(s.speed) / p.LONGVL
    drag = p.QSY1 + p.QSY2 * fx / p.FNOMIN + p.QSY3 * ratio + p.QSY4 * ratio**4
    drag += (p.QSY5 + p.QSY6 * load) * g * g
    drag = drag * (p.INFLPRES / p.NOMPRES) ** p.QSY8 * p.LMY * resistance_share(s.speed)
    if rules.resistance_of_book:
        carried = s.load * load**p.QSY7
    else:
        carried = p.FNOMIN * load ** (1.0 if _is_zero(p.QSY7) else p.QSY7)
    return (arm * tilt + extra) * p.LMX, -p.UNLOADED_RADIUS * carried * drag
