"""Relaxation lengths of tyre property files: by coefficients of 5.2, by stiffness in 6.1.

    5.2:  σ_κ = F_z (pTx1 + pTx2 df_z) exp(-pTx3 df_z) R_0/F_z0 λ_σκ,
          σ_α = pTy1 sin(2 atan(F_z/(pTy2 F_z0'))) (1 - pKy3 |γ|) R_0 λ_Fz0 λ_σα
    6.1:  σ_κ = K_xκ/c_x,  σ_α = |K_yα|/c_y

c_x and c_y are the stiffnesses of the carcass, which change with load and pressure.

References
----------
Pacejka (2012), Tire and Vehicle Dynamics, chapters 4 and 7; 5.2 checked against OpenTire.
"""

from __future__ import annotations

from vehicledyn.road.tyres.pacejka import formula_52, formula_61
from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.pacejka.state import Slip, TyreState, state_of
from vehicledyn.road.tyres.tyre import RelaxationLengths, TyreInput
from vehicledyn.symbolic import ops


def has_coefficients(p: Coefficients) -> bool:
    """Return whether a file has the relaxation coefficients of 5.2."""
    return all(p.has(name) and getattr(p, name) != 0.0 for name in ("PTX1", "PTY1", "PTY2"))


def has_stiffness(p: Coefficients) -> bool:
    """Return whether a file has the stiffnesses of the carcass."""
    names = ("LONGITUDINAL_STIFFNESS", "LATERAL_STIFFNESS")
    return all(p.has(name) and getattr(p, name) > 0.0 for name in names)


def by_coefficients(p: Coefficients, contact: TyreInput) -> RelaxationLengths:
    """Return the lengths by the coefficients of version 5.2."""
    s = state_of(p, contact)
    df = s.load_change
    growth = (p.PTX1 + p.PTX2 * df) * ops.exp(-p.PTX3 * df) * p.LSGKP
    turned = ops.sin(2.0 * ops.atan(s.load / (p.PTY2 * s.nominal))) * p.LSGAL
    lean = 1.0 - p.PKY3 * ops.absolute(p.LGAY * ops.sin(s.camber))
    return RelaxationLengths(
        s.load * growth * p.UNLOADED_RADIUS / p.FNOMIN,
        p.PTY1 * turned * lean * p.UNLOADED_RADIUS * p.LFZO,
    )


def by_stiffness(p: Coefficients, contact: TyreInput) -> RelaxationLengths:
    """Return the lengths as slip stiffness over the stiffness of the carcass."""
    s = state_of(p, contact)
    df, dp = s.load_change, s.pressure_change
    along = p.LONGITUDINAL_STIFFNESS * (1.0 + p.PCFX1 * df + p.PCFX2 * df * df)
    across = p.LATERAL_STIFFNESS * (1.0 + p.PCFY1 * df + p.PCFY2 * df * df)
    stiffness = _slip_stiffness(p, s)
    return RelaxationLengths(
        stiffness[0] / (along * (1.0 + p.PCFX3 * dp)),
        -stiffness[1] / (across * (1.0 + p.PCFY3 * dp)),
    )


def _slip_stiffness(p: Coefficients, s: TyreState) -> tuple[ops.Scalar, ops.Scalar]:
    """Return K_xκ and K_yα."""
    camber = ops.sin(s.camber)
    if p.PKY4 == 2.0 and p.PKY5 == 0.0:  # version 5.2
        return (
            formula_52.longitudinal(p, s, Slip(s.angle, camber)).stiffness,
            formula_52.lateral_stiffness(p, s, p.LGAY * camber),
        )
    return formula_61.longitudinal(p, s).stiffness, formula_61.lateral_stiffness(p, s, camber)
