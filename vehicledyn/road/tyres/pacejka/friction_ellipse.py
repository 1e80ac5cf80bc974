"""Combined slip by the friction ellipse, for tyres without coefficients of combined slip.

With the slips κ_c = κ + S_Hx + S_Vx/K_x and α_c = α + S_Hy + S_Vy/K_y, tan β = |sin α_c/κ_c| and
the frictions used at pure slip, μ_x = |F_x0 - S_Vx|/F_z and so on, the forces are

    F_x = F_x0 / √(1 + (μ_x tan β/μ_y,max)²),    F_y = F_y0 / √(1 + (μ_y/(μ_x,max tan β))²).

References
----------
The friction ellipse of PAC2002 (Adams/Tire, FE_METHOD = 'YES'), by way of Project Chrono.
"""

from __future__ import annotations

from typing import NamedTuple

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

SLIP_FLOOR = 1e-9
"""Rounds the direction of the slip where there is none [1]."""

PLAIN_FLOOR = 1e-3
"""The same for slips that are not shifted: there forces of conicity and plysteer fade [1]."""


class Pure(NamedTuple):
    """Force at pure slip, its vertical shift and its largest friction force [N]."""

    force: Scalar
    rise: Scalar
    peak: Scalar


def on_ellipse(
    slip: Scalar, angle: Scalar, along: Pure, across: Pure, *, floor: float = SLIP_FLOOR
) -> tuple[Scalar, Scalar]:
    """Return F_x and F_y; ``slip`` and ``angle`` are κ_c [1] and α_c [rad]."""
    x, y = slip, ops.sin(angle)
    used_x, used_y = (ops.absolute(curve.force - curve.rise) for curve in (along, across))
    part_x, part_y = y * used_x / across.peak, x * used_y / along.peak
    size_x, size_y = (ops.smooth_norm(item, 0.0, floor) for item in (x, y))
    fx = along.force * size_x / ops.smooth_norm(x, part_x, floor)
    return fx, across.force * size_y / ops.smooth_norm(y, part_y, floor)
