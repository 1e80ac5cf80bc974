"""Rolling radius by the coefficients of a tyre property file.

    R_e = R - ρ_0 (D_reff atan(B_reff ρ/ρ_0) + F_reff ρ/ρ_0),    ρ_0 = F_z0/C_z

ρ is the deflection, ρ_0 that at the nominal load by VERTICAL_STIFFNESS. In 6.1 and 6.2 F_z/F_z0
stands in place of ρ/ρ_0, the same for a linear spring; the growth with speed (Q_V1) is left out.

References
----------
Pacejka (2002), Tyre and Vehicle Dynamics, (4.E96) and section A3.7; equation manual of PAC2002.
"""

from __future__ import annotations

from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

NEEDED = ("VERTICAL_STIFFNESS", "DREFF", "BREFF")
"""Coefficients without which a file has no rolling radius."""


def has_rolling_radius(p: Coefficients) -> bool:
    """Return whether a file says at which radius the tyre rolls."""
    return all(p.has(name) and getattr(p, name) > 0.0 for name in NEEDED)


def rolling_radius_of_file(p: Coefficients, radius: Scalar, loaded_radius: Scalar) -> Scalar:
    """Return the radius [m] at which a tyre of these radii, free and loaded, rolls."""
    nominal = p.FNOMIN / p.VERTICAL_STIFFNESS
    pressed = ops.maximum(radius - loaded_radius, 0.0) / nominal
    return radius - nominal * (p.DREFF * ops.atan(p.BREFF * pressed) + p.FREFF * pressed)
