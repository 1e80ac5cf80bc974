"""PAC2002 by the rules of Chrono::Vehicle, for comparison with that program.

It takes α and γ as angles, bounds B (x + S_h) to ± (π/2 - 0.01), adds 0.1 N to C D before the
division, takes magnitudes of friction and of B_t and B_xα, scales K_y by λ_μy in place of λ_Ky and
leaves out the influence of camber on F_x. Combined slip goes by its friction ellipse, by
Pacejka's weights, or is left out. With Pacejka's weights the sign of κ stands before the
equivalent angle of the trail, so that M_z jumps at κ = 0, where the trail is the largest. M_x and
M_y are those of PAC2002, not that program's.

References
----------
Project Chrono, ChPac02Tire (2023); rules read from that public program, own formulation.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.pacejka.formula_52 import other_moments
from vehicledyn.road.tyres.pacejka.friction_ellipse import Pure, on_ellipse
from vehicledyn.road.tyres.pacejka.state import (
    EQUIVALENT_SLIP_FLOOR,
    TyreState,
    at_most_one,
    bent,
    limited,
    state_of,
    tangent,
    weight,
)
from vehicledyn.road.tyres.tyre import RelaxationLengths, TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

_ARGUMENT_LIMIT = 0.5 * math.pi - 0.01
_ADDED_FORCE = 0.1
_SPEED_MARGIN = 0.1
"""Added to the speed that slips are divided by on a car [m/s]."""


@dataclass(frozen=True)
class _Curve:
    """A pure curve: value, S_v, peak, stiffness, S_h and B C."""

    force: Scalar
    rise: Scalar
    peak: Scalar
    stiffness: Scalar
    shift: Scalar
    factor: Scalar


def forces_chrono(p: Coefficients, contact: TyreInput, combined: str) -> TyreForces:
    """Return the forces; ``combined`` is "ellipse", "pacejka" or "none"."""
    s = state_of(p, contact)
    along, across = _longitudinal(p, s), _lateral(p, s)
    fx, fy, ratio, extra = along.force, across.force, None, 0.0
    if combined == "ellipse":
        x = s.slip + along.shift + along.rise / along.stiffness
        y = s.angle + across.shift + across.rise / across.stiffness
        pure = (Pure(c.force, c.rise, c.peak) for c in (along, across))
        fx, fy = on_ellipse(x, y, *pure)
    elif combined == "pacejka":
        fx = along.force * _along_weight(p, s)
        share, extra = _across_weight(p, s, across.peak / s.load)
        fy = across.force * share + extra
        ratio = along.stiffness / across.stiffness * s.slip
    mz = _aligning(p, s, across, fy - extra, ratio)
    if combined == "pacejka":
        arm = p.SSZ1 + p.SSZ2 * fy / s.nominal + (p.SSZ3 + p.SSZ4 * s.load_change) * s.camber
        mz += p.UNLOADED_RADIUS * p.LS * arm * fx
    tilt, drag = other_moments(p, s, fx, fy, s.camber)
    return TyreForces(*(s.share * item for item in (fx, fy, mz, tilt, drag)))


def on_a_chrono_vehicle(contact: TyreInput) -> TyreInput:
    """Return what that program's formula gets of the contact of a wheel on a car.

    Found from runs of its sedan: the forces of these inputs agree with the recorded ones.
    """
    speed = ops.absolute(contact.forward_speed)
    share = speed / (speed + _SPEED_MARGIN)
    return TyreInput(
        contact.normal_force,
        contact.longitudinal_slip * share,
        ops.atan(share * tangent(contact.slip_angle)),
        0.0,
        contact.forward_speed,
    )


def _longitudinal(p: Coefficients, s: TyreState) -> _Curve:
    df, dp = s.load_change, s.pressure_change
    Sh = (p.PHX1 + p.PHX2 * df) * p.LHX
    Sv = s.load * (p.PVX1 + p.PVX2 * df) * p.LVX * p.LMUX
    x, C = s.slip + Sh, p.PCX1 * p.LCX
    lean = 1.0 - p.PEX4 * ops.sign(x)
    E = at_most_one((p.PEX1 + p.PEX2 * df + p.PEX3 * df * df) * lean * p.LEX)
    fit = (p.PDX1 + p.PDX2 * df) * (1.0 + p.PPX3 * dp + p.PPX4 * dp * dp)
    D = s.load * ops.absolute(fit * p.LMUX)
    K = s.load * (p.PKX1 + p.PKX2 * df) * ops.exp(p.PKX3 * df)
    K *= (1.0 + p.PPX1 * dp + p.PPX2 * dp * dp) * p.LKX
    return _curve((C, D, E, K), x, Sh, Sv)


def _lateral(p: Coefficients, s: TyreState) -> _Curve:
    df, dp = s.load_change, s.pressure_change
    camber = s.camber * p.LGAY
    Sh = (p.PHY1 + p.PHY2 * df) * p.LHY + p.PHY3 * camber * p.LKYG
    rise = (p.PVY1 + p.PVY2 * df) * p.LVY + (p.PVY3 + p.PVY4 * df) * camber * p.LKYG
    Sv = s.load * rise * p.LMUY
    y, C = s.angle + Sh, p.PCY1 * p.LCY
    lean = 1.0 - (p.PEY3 + p.PEY4 * camber) * ops.sign(y)
    E = at_most_one((p.PEY1 + p.PEY2 * df) * lean * p.LEY)
    fit = (p.PDY1 + p.PDY2 * df) * (1.0 + p.PPY3 * dp + p.PPY4 * dp * dp)
    D = s.load * ops.absolute(fit * (1.0 + p.PDY3 * camber * camber) * p.LMUY)
    place = s.load / (p.PKY2 * s.nominal * (1.0 + p.PPY2 * dp))
    K = p.PKY1 * s.nominal * (1.0 + p.PPY1 * dp) * ops.sin(2.0 * ops.atan(place)) * p.LMUY
    return _curve((C, D, E, K * (1.0 - p.PKY3 * ops.absolute(camber))), y, Sh, Sv)


def _curve(shape: tuple[Scalar, ...], slip: Scalar, shift: Scalar, rise: Scalar) -> _Curve:
    C, D, E, K = shape
    B = K / (C * D + _ADDED_FORCE)
    force = D * ops.sin(C * bent(limited(B * slip, _ARGUMENT_LIMIT), E)) + rise
    return _Curve(force, rise, D, K, shift, B * C)


def _along_weight(p: Coefficients, s: TyreState) -> Scalar:
    E = at_most_one(p.REX1 + p.REX2 * s.load_change)
    B = ops.absolute(p.RBX1 * ops.cos(ops.atan(p.RBX2 * s.slip)) * p.LXAL)
    return weight(B, p.RCX1, E, s.angle + p.RHX1) / weight(B, p.RCX1, E, p.RHX1)


def _across_weight(p: Coefficients, s: TyreState, friction: Scalar) -> tuple[Scalar, Scalar]:
    df = s.load_change
    E, Sh = at_most_one(p.REY1 + p.REY2 * df), p.RHY1 + p.RHY2 * df
    B = p.RBY1 * ops.cos(ops.atan(p.RBY2 * (s.angle - p.RBY3))) * p.LYKA
    size = friction * s.load * (p.RVY1 + p.RVY2 * df + p.RVY3 * s.camber)
    size *= ops.cos(ops.atan(p.RVY4 * s.angle))
    extra = size * ops.sin(p.RVY5 * ops.atan(p.RVY6 * s.slip)) * p.LVYKA
    return weight(B, p.RCY1, E, s.slip + Sh) / weight(B, p.RCY1, E, Sh), extra


def _aligning(
    p: Coefficients, s: TyreState, across: _Curve, force: Scalar, ratio: Scalar | None
) -> Scalar:
    """Return M_z; ``ratio`` is K_x κ/K_y where the longitudinal slip counts."""
    df, dp, g = s.load_change, s.pressure_change, s.camber * p.LGAZ
    at = s.angle + p.QHZ1 + p.QHZ2 * df + (p.QHZ3 + p.QHZ4 * df) * g
    ar = s.angle + across.shift + across.rise / across.stiffness
    B = (p.QBZ1 + p.QBZ2 * df + p.QBZ3 * df * df) * p.LKY / p.LMUY
    B = ops.absolute(B * (1.0 + p.QBZ4 * g + p.QBZ5 * ops.absolute(g)))
    lean = (p.QEZ4 + p.QEZ5 * g) * (2.0 / math.pi) * ops.atan(B * p.QCZ1 * at)
    E = at_most_one((p.QEZ1 + p.QEZ2 * df + p.QEZ3 * df * df) * (1.0 + lean))
    D = s.load * (p.QDZ1 + p.QDZ2 * df) * (1.0 - p.QPZ1 * dp) * p.LTR
    D *= (1.0 + p.QDZ3 * g + p.QDZ4 * g * g) * p.UNLOADED_RADIUS / s.nominal
    Br = p.QBZ9 * p.LKY / p.LMUY + p.QBZ10 * across.factor
    Dr = (p.QDZ6 + p.QDZ7 * df) * p.LRES + (p.QDZ8 + p.QDZ9 * df) * (1.0 + p.QPZ2 * dp) * g
    Dr *= s.load * p.UNLOADED_RADIUS * p.LMUY
    if ratio is not None:
        at, ar = (
            ops.atan(ops.smooth_norm(tangent(item), ratio, EQUIVALENT_SLIP_FLOOR))
            for item in (at, ar)
        )
        at = at * ops.sign(s.slip)
    trail = D * weight(B, p.QCZ1, E, at)
    return (Dr * ops.cos(ops.atan(Br * ar)) - trail * force) * ops.cos(s.angle)


def lengths_chrono(p: Coefficients, contact: TyreInput) -> RelaxationLengths:
    """Return the relaxation lengths, the exponent positive; zero without coefficients."""
    p = p.changed(**{name: 0.0 for name in ("PTX1", "PTY1", "PTY2") if not p.has(name)})
    s = state_of(p, contact)
    df = s.load_change
    growth = (p.PTX1 + p.PTX2 * df) * ops.exp(p.PTX3 * df) * p.LSGKP
    along = s.load * growth * p.UNLOADED_RADIUS / s.nominal
    place = s.load / (p.PTY2 * s.nominal) if p.PTY2 != 0.0 else 0.0
    turned = ops.sin(2.0 * ops.atan(place)) * p.LSGAL
    lean = 1.0 - p.PKY3 * ops.absolute(s.camber)
    return RelaxationLengths(along, p.PTY1 * turned * lean * p.UNLOADED_RADIUS * p.LFZO)
