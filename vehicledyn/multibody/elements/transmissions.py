"""Transmissions: screw, gears, belts and racks as linear relations of joint coordinates.

The ratio may be a parameter. An angle of assembly other than zero goes into ``offset``.
"""

from __future__ import annotations

import math

from vehicledyn.multibody.model.constraints import LinearConstraint
from vehicledyn.multibody.model.cuts import Proportional
from vehicledyn.symbolic.ops import Scalar


def screw(
    name: str, sliding: str, turning: str, pitch: Scalar, *, offset: Scalar = 0.0
) -> LinearConstraint:
    """Return a screw: x - p φ/(2π) = offset, for a sliding and a turning joint on one axis.

    Parameters
    ----------
    name
        Name of the constraint.
    sliding, turning
        Coordinates x [m] and φ [rad].
    pitch
        Advance p of one turn, negative for a left-hand thread [m].
    offset
        x where φ is zero [m].

    References
    ----------
    Samin, Fisette (2003), chapter 4.2.1 (helicoidal joint).
    """
    terms = ((sliding, 1.0), (turning, -pitch / (2.0 * math.pi)))
    return LinearConstraint(name, terms, offset, "m", "N", (_torque(turning, terms[1][1]),))


def gears(
    name: str,
    driven: str,
    driving: str,
    ratio: Scalar,
    *,
    offset: Scalar = 0.0,
) -> LinearConstraint:
    """Return a pair of gears: φ_driven + ratio φ_driving = offset.

    Both angles are measured against the carrier of the axles and about parallel axes of the
    same direction.

    Parameters
    ----------
    name
        Name of the constraint.
    driven, driving
        Coordinates of the two wheels [rad].
    ratio
        Teeth of the driving over teeth of the driven wheel; negative for a ring gear, whose
        wheel turns the same way [1].
    offset
        φ_driven where φ_driving is zero [rad].

    References
    ----------
    Samin, Fisette (2003), chapter 4.2.4.
    """
    terms = ((driven, 1.0), (driving, ratio))
    return LinearConstraint(name, terms, offset, more=(_torque(driving, ratio, "driving_torque"),))


def belt(
    name: str,
    driven: str,
    driving: str,
    driven_radius: Scalar,
    driving_radius: Scalar,
    *,
    crossed: bool = False,
    offset: Scalar = 0.0,
) -> LinearConstraint:
    """Return a belt without stretch or slip: r_driven φ_driven = ± r_driving φ_driving.

    Parameters
    ----------
    name
        Name of the constraint.
    driven, driving
        Coordinates of the two pulleys against the carrier of their axles [rad].
    driven_radius, driving_radius
        Radii of the pulleys [m].
    crossed
        Whether the belt crosses itself, so that the pulleys turn in opposite directions.
    offset
        φ_driven where φ_driving is zero [rad].

    References
    ----------
    Samin, Fisette (2003), chapter 4.2.3.
    """
    ratio = driving_radius / driven_radius
    factor = ratio if crossed else -ratio
    tension = Proportional(
        "tension_difference",
        "N",
        1.0 / driven_radius,
        f"Tension of the strand that pulls '{driven}' forward, less that of the other strand",
    )
    more = (_torque(driving, factor, "driving_torque"), tension)
    return LinearConstraint(name, ((driven, 1.0), (driving, factor)), offset, more=more)


def rack(
    name: str, sliding: str, turning: str, radius: Scalar, *, offset: Scalar = 0.0
) -> LinearConstraint:
    """Return a rack and pinion, or a rope on a drum: x - r φ = offset.

    Parameters
    ----------
    name
        Name of the constraint.
    sliding, turning
        Coordinates x [m] and φ [rad].
    radius
        Pitch radius r, negative if the rack moves the other way [m].
    offset
        x where φ is zero [m].
    """
    more = (_torque(turning, -radius),)
    return LinearConstraint(name, ((sliding, 1.0), (turning, -radius)), offset, "m", "N", more)


def _torque(coordinate: str, factor: Scalar, channel: str = "torque") -> Proportional:
    text = f"Torque of the transmission on '{coordinate}'"
    return Proportional(channel, "N*m", factor, text)
