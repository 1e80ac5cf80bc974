"""What a creep law is: tangential forces on the wheel from creepages, load and contact ellipse.

Axes of the contact: x in the rolling direction, y to the left in the contact plane, z normal to
it, out of the rail. Creepages are those of :mod:`vehicledyn.rail.creep.creepage`: the velocity of
the wheel's material over the rail's, so that forces on the wheel oppose them. Turned about x by
half a turn (y to the right, z down) all laws read the same.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.rail.creep.creepage import Creepages
from vehicledyn.rail.creep.kalker import CreepCoefficients, creep_coefficients
from vehicledyn.rail.geometry.hertz import ContactEllipse
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

LIMIT_FLOOR = 1e-3
"""Least friction force that a force is ever referred to [N]."""

RELATIVE_FLOOR = 1e-6
"""Rounds the magnitude of forces over the friction limit where they vanish [1]."""


@dataclass(frozen=True)
class CreepContact:
    """What a creep law is given of one contact.

    Attributes
    ----------
    longitudinal, lateral
        Creepages ξ, η [1].
    spin
        Creepage φ [1/m].
    normal_force
        N, zero when lifted, never negative [N].
    ellipse
        Semi-axes of the contact, positive even without load.
    shear_modulus
        G of both bodies, 2/G = 1/G₁ + 1/G₂ [N/m²].
    poissons_ratio
        ν of both bodies, 2 ν/G = ν₁/G₁ + ν₂/G₂ [1].
    speed
        Reference speed V of the creepages, for friction that falls with sliding [m/s].
    """

    longitudinal: Scalar
    lateral: Scalar
    spin: Scalar
    normal_force: Scalar
    ellipse: ContactEllipse
    shear_modulus: Scalar
    poissons_ratio: Scalar
    speed: Scalar = 0.0

    @staticmethod
    def of(
        creepages: Creepages,
        normal_force: Scalar,
        ellipse: ContactEllipse,
        *,
        shear_modulus: Scalar,
        poissons_ratio: Scalar,
        speed: Scalar,
    ) -> CreepContact:
        """Return a contact with these creepages, see the attributes."""
        values = (creepages.longitudinal, creepages.lateral, creepages.spin)
        return CreepContact(*values, normal_force, ellipse, shear_modulus, poissons_ratio, speed)

    @property
    def area_scale(self) -> Scalar:
        """Return c² = a b [m²]."""
        return self.ellipse.semi_axis_x * self.ellipse.semi_axis_y

    @property
    def axis_ratio(self) -> Scalar:
        """Return a/b [1]."""
        return self.ellipse.semi_axis_x / self.ellipse.semi_axis_y


@dataclass(frozen=True)
class CreepForces:
    """Forces on the wheel along x and y [N] and moment about the contact normal [N m]."""

    longitudinal: Scalar
    lateral: Scalar
    spin_moment: Scalar


class CreepLaw(ParameterSet):
    """Creep law with its parameters; every law of the catalogue derives from it.

    Forces oppose creep, are finite and continuous for any finite input, vanish with the load
    and never exceed friction.
    """

    friction: float = quantity("1", "Friction coefficient μ", gt=0)
    stiffness_factor: float = quantity(
        "1", "Part of Kalker's coefficients that is there, 1 on clean rails", default=1.0, gt=0
    )

    @property
    def bends_at_rest(self) -> str:
        """Why forces are not linear in small creepages, in words; empty where they are."""
        return ""

    @abstractmethod
    def forces(self, contact: CreepContact) -> CreepForces:
        """Return the forces on the wheel in steady rolling."""


def kalker_forces(contact: CreepContact, factor: Scalar = 1.0) -> CreepForces:
    """Return the forces of Kalker's linear theory, times a factor.

    F_x = -G c² C11 ξ,    F_y = -G (c² C22 η + c³ C23 φ),    M_z = G (c³ C23 η - c⁴ C33 φ)
    """
    coefficients = creep_coefficients(contact.axis_ratio, contact.poissons_ratio)
    return linear_forces(contact, coefficients, factor)


def linear_forces(
    contact: CreepContact, coefficients: CreepCoefficients, factor: Scalar = 1.0
) -> CreepForces:
    """Return the forces of the linear theory with given coefficients, times a factor."""
    c2 = contact.area_scale
    c = ops.sqrt(c2)
    turn = c * contact.spin
    stiffness = factor * contact.shear_modulus * c2
    side = coefficients.lateral * contact.lateral + coefficients.lateral_spin * turn
    moment = coefficients.lateral_spin * contact.lateral - coefficients.spin * turn
    return CreepForces(
        -stiffness * coefficients.longitudinal * contact.longitudinal,
        -stiffness * side,
        stiffness * c * moment,
    )


def floored_limit(limit: Scalar) -> Scalar:
    """Return a friction force kept off zero, for division [N]."""
    return ops.maximum(limit, LIMIT_FLOOR)


def scaled(forces: CreepForces, factor: Scalar) -> CreepForces:
    """Return forces and moment times a factor."""
    return CreepForces(
        factor * forces.longitudinal, factor * forces.lateral, factor * forces.spin_moment
    )
