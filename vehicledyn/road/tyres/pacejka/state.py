"""What the formulas of all versions start from: limited load, slips, camber and pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from vehicledyn.road.tyres.pacejka.coefficient_values import Coefficients
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.road.tyres.tyre import TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

LOAD_FLOOR = 2e-3
"""Load over nominal load below which forces are in proportion to the load [1]."""

LOAD_CEILING = 4.0
"""Load over nominal load above which forces are in proportion to the load [1]."""

CAMBER_LIMIT = 0.6
"""Camber beyond which forces no longer change, for files without a range [rad]."""

CAMBER_MARGIN = 1.5
"""Camber over the end of the file's range beyond which forces no longer change [1]."""

_LEAST_LIMIT = 0.2
"""Least of these limits [rad]."""

ANGLE_LIMIT = 1.5
"""Slip angle beyond which its tangent no longer grows [rad]."""

FRICTION_FLOOR = 0.01
"""Least friction coefficient that a fit may give, far outside its range [1]."""

EQUIVALENT_SLIP_FLOOR = 1e-7
"""Rounds the magnitude of equivalent slips in the aligning moment [1]."""

SPEED_OF_RESISTANCE = 0.1
"""Speed above which rolling resistance has its full value [m/s]."""


class Slip(NamedTuple):
    """Slip angle and camber as one group of formulas takes them: angles, tangent or sine."""

    angle: Scalar
    camber: Scalar


@dataclass(frozen=True)
class TyreState:
    """Inputs of the formulas.

    Attributes
    ----------
    load
        F_z within the limits of the fit [N].
    nominal
        F_z0' = λ_Fz0 F_z0 [N].
    load_change, pressure_change
        df_z and dp_i [1].
    slip
        κ [1].
    angle, camber
        α and γ [rad].
    speed
        v_x [m/s].
    share
        Load over the load of the formulas; one within the limits [1].
    """

    load: Scalar
    nominal: float
    load_change: Scalar
    pressure_change: Scalar
    slip: Scalar
    angle: Scalar
    camber: Scalar
    speed: Scalar
    share: Scalar


def state_of(p: Coefficients, contact: TyreInput) -> TyreState:
    """Return the state at a contact, its values kept where the formulas have meaning."""
    nominal = p.FNOMIN * p.LFZO
    load = ops.minimum(floored(contact.normal_force, LOAD_FLOOR * nominal), LOAD_CEILING * nominal)
    quarter = 0.5 * math.pi
    return TyreState(
        load,
        nominal,
        (load - nominal) / nominal,
        (p.INFLPRES - p.NOMPRES) / p.NOMPRES,
        contact.longitudinal_slip,
        limited(contact.slip_angle, quarter),
        limited(contact.camber, _camber_limit(p)),
        contact.forward_speed,
        contact.normal_force / load,
    )


def _camber_limit(p: Coefficients) -> float:
    if not (p.has("CAMMIN") and p.has("CAMMAX")):
        return CAMBER_LIMIT
    widest = CAMBER_MARGIN * max(abs(float(p.CAMMIN)), abs(float(p.CAMMAX)))
    return min(max(widest, _LEAST_LIMIT), 0.5 * math.pi)


def limited(value: Scalar, most: float) -> Scalar:
    """Return a value within ± most."""
    return ops.minimum(ops.maximum(value, -most), most)


def tangent(angle: Scalar) -> Scalar:
    """Return the tangent of a slip angle, bounded near ±90°."""
    return ops.tan(limited(angle, ANGLE_LIMIT))


def bent(x: Scalar, curvature: Scalar) -> Scalar:
    """Return atan(x - E (x - atan x)), the argument of every curve over C."""
    if isinstance(curvature, int | float) and curvature == 0.0:
        return ops.atan(x)
    return ops.atan(x - curvature * (x - ops.atan(x)))


def weight(factor: Scalar, shape: Scalar, curvature: Scalar, slip: Scalar) -> Scalar:
    """Return cos(C atan(B s - E (B s - atan(B s))))."""
    return ops.cos(shape * bent(factor * slip, curvature))


def at_most_one(curvature: Scalar) -> Scalar:
    """Return a curvature factor E, never above one."""
    if isinstance(curvature, int | float):
        return min(float(curvature), 1.0)
    return ops.minimum(curvature, 1.0)


def resistance_share(speed: Scalar) -> Scalar:
    """Return the direction of rolling, from -1 to 1, by a cubic about standstill."""
    u = limited(speed / SPEED_OF_RESISTANCE, 1.0)
    return u * (1.5 - 0.5 * u * u)


def sliding_friction(p: Coefficients, state: TyreState, scale: Scalar) -> Scalar:
    """Return λ* = λ / (1 + λ_V V_s/V_0), the friction scale that decays with sliding speed."""
    if ops.is_structurally_zero(p.LMUV):
        return scale
    across = tangent(state.angle)
    sliding = ops.absolute(state.speed) * ops.smooth_norm(state.slip, across, 1e-6)
    return scale / (1.0 + p.LMUV * sliding / p.LONGVL)
