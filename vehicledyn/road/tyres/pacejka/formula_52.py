"""Magic Formula 5.2 and PAC2002: forces and moments at pure and combined slip.

The names of coefficients and intermediate quantities are those of the sources. PAC2002 adds the
influence of inflation pressure; its coefficients are zero in files of version 5.2.

References
----------
Pacejka (2002), Tyre and Vehicle Dynamics, chapter 4; equation manual of PAC2002; numbers checked
against the public program OpenTire.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.pacejka.friction_ellipse import (
    PLAIN_FLOOR,
    SLIP_FLOOR,
    Pure,
    on_ellipse,
)
from vehicledyn.road.tyres.pacejka.state import (
    EQUIVALENT_SLIP_FLOOR,
    FRICTION_FLOOR,
    Slip,
    TyreState,
    at_most_one,
    bent,
    limited,
    resistance_share,
    sliding_friction,
    state_of,
    tangent,
    weight,
)
from vehicledyn.road.tyres.tyre import TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class PureCurve:
    """What combined slip and moments need of a pure curve."""

    force: Scalar
    friction: Scalar
    stiffness: Scalar
    horizontal_shift: Scalar
    vertical_shift: Scalar
    steepness: Scalar


def forces_52(
    p: Coefficients, contact: TyreInput, *, angles: bool = False, ellipse: str | None = None
) -> TyreForces:
    """Return the forces at combined slip.

    Parameters
    ----------
    p
        Coefficients of the file.
    contact
        What the tyre feels.
    angles
        Whether slip angle and camber enter as angles, in place of tan α and sin γ.
    ellipse
        How slips combine by the friction ellipse, "shifted" or "plain"; None for weights.
    """
    state = state_of(p, contact)
    slip = Slip(state.angle, state.camber)
    if not angles:
        slip = Slip(tangent(state.angle), ops.sin(state.camber))
    along, across = longitudinal(p, state, slip), lateral(p, state, slip)
    if ellipse:
        fx, free = forces_on_ellipse(state, slip.angle, along, across, ellipse)
        fy, ratio = free, 0.0
    else:
        fx = along.force * _along_weight(p, state, slip)
        share, extra = _across_weight(p, state, slip, across)
        free = share * across.force
        fy, ratio = free + extra, along.stiffness / across.stiffness * state.slip
    moment = _aligning(p, state, slip, across, ratio=ratio, free=free)
    arm = p.SSZ1 + p.SSZ2 * fy / state.nominal + (p.SSZ3 + p.SSZ4 * state.load_change) * slip.camber
    moment += p.UNLOADED_RADIUS * p.LS * arm * fx
    tilt, resistance = other_moments(p, state, fx, fy, slip.camber)
    return TyreForces(*(state.share * item for item in (fx, fy, moment, tilt, resistance)))


def forces_on_ellipse(
    s: TyreState, angle: Scalar, along: PureCurve, across: PureCurve, way: str
) -> tuple[Scalar, Scalar]:
    """Return F_x and F_y by the friction ellipse, by slips from where forces vanish if "shifted".

    ``angle`` is the slip angle as it enters F_y.
    """
    x, y, floor = s.slip, angle, PLAIN_FLOOR
    if way == "shifted":
        floor = SLIP_FLOOR
        x = x + along.horizontal_shift + along.vertical_shift / along.stiffness
        y = y + across.horizontal_shift + across.vertical_shift / across.stiffness
    pure = (Pure(c.force, c.vertical_shift, c.friction * s.load) for c in (along, across))
    return on_ellipse(x, y, *pure, floor=floor)


def longitudinal(p: Coefficients, s: TyreState, slip: Slip) -> PureCurve:
    """Return F_x at pure longitudinal slip."""
    df, dp = s.load_change, s.pressure_change
    scale = sliding_friction(p, s, p.LMUX)
    camber = p.LGAX * slip.camber
    Sh = (p.PHX1 + p.PHX2 * df) * p.LHX
    Sv = s.load * (p.PVX1 + p.PVX2 * df) * p.LVX * scale
    C = p.PCX1 * p.LCX
    fit = (p.PDX1 + p.PDX2 * df) * (1.0 + p.PPX3 * dp + p.PPX4 * dp * dp)
    friction = ops.maximum(fit * (1.0 - p.PDX3 * camber * camber), FRICTION_FLOOR) * scale
    x = s.slip + Sh
    E = at_most_one(
        (p.PEX1 + p.PEX2 * df + p.PEX3 * df * df) * (1.0 - p.PEX4 * ops.sign(x)) * p.LEX
    )
    K = s.load * (p.PKX1 + p.PKX2 * df) * ops.exp(p.PKX3 * df)
    K *= (1.0 + p.PPX1 * dp + p.PPX2 * dp * dp) * p.LKX
    D = friction * s.load
    B = K / (C * D)
    return PureCurve(D * ops.sin(C * bent(B * x, E)) + Sv, friction, K, Sh, Sv, B * C)


def lateral(p: Coefficients, s: TyreState, slip: Slip) -> PureCurve:
    """Return F_y at pure side slip."""
    df, dp = s.load_change, s.pressure_change
    scale = sliding_friction(p, s, p.LMUY)
    camber = p.LGAY * slip.camber
    Sh = (p.PHY1 + p.PHY2 * df) * p.LHY + p.PHY3 * camber * p.LKYG
    fit = (p.PVY1 + p.PVY2 * df) * p.LVY + (p.PVY3 + p.PVY4 * df) * camber * p.LKYG
    Sv = s.load * fit * scale
    C = p.PCY1 * p.LCY
    fit = (p.PDY1 + p.PDY2 * df) * (1.0 + p.PPY3 * dp + p.PPY4 * dp * dp)
    friction = ops.maximum(fit * (1.0 - p.PDY3 * camber * camber), FRICTION_FLOOR) * scale
    y = slip.angle + Sh
    lean = 1.0 - (p.PEY3 + p.PEY4 * camber) * ops.sign(y)
    E = at_most_one((p.PEY1 + p.PEY2 * df) * lean * p.LEY)
    K = lateral_stiffness(p, s, camber)
    D = friction * s.load
    B = K / (C * D)
    return PureCurve(D * ops.sin(C * bent(B * y, E)) + Sv, friction, K, Sh, Sv, B * C)


def lateral_stiffness(p: Coefficients, s: TyreState, camber: Scalar) -> Scalar:
    """Return the cornering stiffness K_y, negative [N/rad]."""
    dp = s.pressure_change
    place = s.load / (p.PKY2 * s.nominal * (1.0 + p.PPY2 * dp))
    turned = ops.sin(2.0 * ops.atan(place)) * (1.0 - p.PKY3 * ops.absolute(camber))
    return p.PKY1 * s.nominal * (1.0 + p.PPY1 * dp) * p.LKY * turned


def _along_weight(p: Coefficients, s: TyreState, slip: Slip) -> Scalar:
    if ops.is_structurally_zero(p.RCX1) or ops.is_structurally_zero(p.RBX1):
        return 1.0
    B = p.RBX1 * ops.cos(ops.atan(p.RBX2 * s.slip)) * p.LXAL
    E = at_most_one(p.REX1 + p.REX2 * s.load_change)
    top = weight(B, p.RCX1, E, slip.angle + p.RHX1)
    return top / weight(B, p.RCX1, E, p.RHX1)


def _across_weight(
    p: Coefficients, s: TyreState, slip: Slip, across: PureCurve
) -> tuple[Scalar, Scalar]:
    """Return the weight G_yκ and the force S_Vyκ that longitudinal slip induces."""
    df = s.load_change
    B = p.RBY1 * ops.cos(ops.atan(p.RBY2 * (slip.angle - p.RBY3))) * p.LYKA
    E = at_most_one(p.REY1 + p.REY2 * df)
    Sh = p.RHY1 + p.RHY2 * df
    share = weight(B, p.RCY1, E, s.slip + Sh) / weight(B, p.RCY1, E, Sh)
    size = across.friction * s.load * (p.RVY1 + p.RVY2 * df + p.RVY3 * slip.camber)
    size *= ops.cos(ops.atan(p.RVY4 * slip.angle))
    return share, size * ops.sin(p.RVY5 * ops.atan(p.RVY6 * s.slip)) * p.LVYKA


def _aligning(
    p: Coefficients, s: TyreState, slip: Slip, across: PureCurve, *, ratio: Scalar, free: Scalar
) -> Scalar:
    """Return the moment by pneumatic trail and the residual moment; ``ratio`` is K_x κ/K_y."""
    df = s.load_change
    camber = p.LGAZ * slip.camber
    at = slip.angle + p.QHZ1 + p.QHZ2 * df + (p.QHZ3 + p.QHZ4 * df) * camber
    ar = slip.angle + across.horizontal_shift + across.vertical_shift / across.stiffness
    te, re = (_equivalent(angle, ratio) for angle in (at, ar))
    scale = sliding_friction(p, s, p.LMUY)
    B = (p.QBZ1 + p.QBZ2 * df + p.QBZ3 * df * df) * p.LKY / scale
    B *= 1.0 + p.QBZ4 * camber + p.QBZ5 * ops.absolute(camber)
    lean = (p.QEZ4 + p.QEZ5 * camber) * (2.0 / math.pi) * ops.atan(B * p.QCZ1 * at)
    E = at_most_one((p.QEZ1 + p.QEZ2 * df + p.QEZ3 * df * df) * (1.0 + lean))
    D = s.load * (p.QDZ1 + p.QDZ2 * df) * (1.0 - p.QPZ1 * s.pressure_change)
    D *= (1.0 + p.QDZ3 * camber + p.QDZ4 * camber * camber) * p.LTR
    D *= p.UNLOADED_RADIUS / s.nominal
    trail = D * weight(B, p.QCZ1, E, te)
    Br = p.QBZ9 * p.LKY / scale + p.QBZ10 * across.steepness
    Dr = (p.QDZ6 + p.QDZ7 * df) * p.LRES
    Dr += (p.QDZ8 + p.QDZ9 * df) * (1.0 + p.QPZ2 * s.pressure_change) * camber
    residual = s.load * p.UNLOADED_RADIUS * scale * Dr * ops.cos(ops.atan(Br * re))
    return (residual - trail * free) * ops.cos(limited(slip.angle, 0.5 * math.pi))


def _equivalent(angle: Scalar, ratio: Scalar) -> Scalar:
    """Return atan √(tan² α + (K_x κ/K_y)²); curves of it are even, so that it needs no sign."""
    return ops.atan(ops.smooth_norm(tangent(angle), ratio, EQUIVALENT_SLIP_FLOOR))


def other_moments(
    p: Coefficients, s: TyreState, fx: Scalar, fy: Scalar, camber: Scalar
) -> tuple[Scalar, Scalar]:
    """Return the overturning moment and the moment of rolling resistance, ISO signs [N m]."""
    arm = s.load * p.UNLOADED_RADIUS
    tilt = p.QSX1 * p.LVMX - p.QSX2 * (1.0 + p.QPX1 * s.pressure_change) * camber
    tilt += p.QSX3 * fy / s.nominal
    ratio = ops.absolute(s.speed) / p.LONGVL
    drag = p.QSY1 + p.QSY2 * fx / p.FNOMIN + p.QSY3 * ratio + p.QSY4 * ratio**4
    return arm * tilt * p.LMX, -arm * drag * p.LMY * resistance_share(s.speed)
