"""Creepages at a contact point from the velocities of the bodies there.

ξ = v_x/V,    η = v_y/V,    φ = ω_z/V

v is the velocity of the wheel's material point over that of the rail's, in the contact's axes (x
along the direction of rolling, y to the left, z normal, out of the rail), ω_z the angular
velocity of the wheel over that of the rail about z. A braked wheel has ξ > 0: its contact point
moves forward. The forces on the wheel have the opposite sign of the creepages, as in Kalker's
and the UIC's use.

V is the speed at which the contact travels along its rail, for rigid and elastic contact alike.
Some sources take the mean of the travelling and the rolling speed instead, which differs from it
by the part ξ/2; forces then differ by the same part where creepages are small.

References
----------
Kalker (1990), Three-Dimensional Elastic Bodies in Rolling Contact, section 1.7 and appendix E;
Simeon, Führer, Rentrop (1991), Surveys on Mathematics for Industry 1, 1-37 (the mean speed).
"""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

SPEED_FLOOR = 1e-2
"""Least reference speed: below it creep grows in proportion to sliding alone [m/s]."""


@dataclass(frozen=True)
class Creepages:
    """Longitudinal and lateral creepage [1] and spin [1/m]."""

    longitudinal: Scalar
    lateral: Scalar
    spin: Scalar


def creepages(
    sliding: tuple[Scalar, Scalar], spin_rate: Scalar, reference_speed: Scalar
) -> Creepages:
    """Return the creepages of a contact.

    Parameters
    ----------
    sliding
        v_x, v_y, velocity of the wheel's material at the contact over the rail's [m/s].
    spin_rate
        ω_z, angular velocity of the wheel over the rail about the contact normal [rad/s].
    reference_speed
        V; its magnitude is used, rounded below ``SPEED_FLOOR`` [m/s].
    """
    speed = ops.smooth_norm(reference_speed, 0.0, SPEED_FLOOR)
    return Creepages(sliding[0] / speed, sliding[1] / speed, spin_rate / speed)
