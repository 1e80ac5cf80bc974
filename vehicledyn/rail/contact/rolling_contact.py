"""One contact of a rolling wheel: creepages, creep forces, wrench on the body, channels."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Wrench
from vehicledyn.rail.creep.creep_law import CreepContact, CreepForces, CreepLaw
from vehicledyn.rail.creep.creepage import Creepages, creepages
from vehicledyn.rail.geometry.hertz import ContactEllipse, effective_modulus, hertz
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec


@dataclass(frozen=True)
class Material:
    """Young's modulus [N/m²] and Poisson's ratio [1] of wheels and rails."""

    youngs_modulus: Scalar
    poissons_ratio: Scalar

    @property
    def shear_modulus(self) -> Scalar:
        """Return G = E/(2 (1 + ν)) [N/m²]."""
        return 0.5 * self.youngs_modulus / (1.0 + self.poissons_ratio)

    @property
    def contact_modulus(self) -> Scalar:
        """Return E* of two bodies of it [N/m²]."""
        own = (self.youngs_modulus, self.poissons_ratio)
        return effective_modulus(*own, *own)


@dataclass(frozen=True)
class ContactMotion:
    """How a wheel moves over its rail at a contact.

    ``longitudinal``, ``lateral`` and ``normal`` are the axes of the contact in world axes: along
    the direction of rolling, to the left and out of the rail; ``speed`` is the reference speed
    of the creepages [m/s].
    """

    longitudinal: Vec
    lateral: Vec
    normal: Vec
    speed: Scalar
    creepages: Creepages


def contact_motion(
    kinematics: Kinematics, body: str, *, point: Vec, normal: Vec, axle: Vec, speed: Scalar
) -> ContactMotion:
    """Return the motion of a wheel over a rail at rest.

    The direction of rolling is e × n, e the axis of the axle.

    Parameters
    ----------
    kinematics, body
        The wheelset's or wheel's motion.
    point
        Contact point, world axes [m].
    normal, axle
        Unit normal of the rail, upwards, and unit axis of the axle, to the left, world axes.
    speed
        Speed at which the contact travels, which creepages refer to [m/s].
    """
    longitudinal = ops.unit(ops.cross(axle, normal))
    lateral = ops.cross(normal, longitudinal)
    travelling = kinematics.velocity(body)
    turning = kinematics.rotation(body) @ kinematics.angular_velocity(body)
    sliding = travelling + ops.cross(turning, point - kinematics.position(body))
    slid = (ops.dot(sliding, longitudinal), ops.dot(sliding, lateral))
    found = creepages(slid, ops.dot(turning, normal), speed)
    return ContactMotion(longitudinal, lateral, normal, speed, found)


@dataclass(frozen=True)
class RollingContact:
    """A contact with its load, ellipse and creep forces."""

    point: Vec
    motion: ContactMotion
    normal_force: Scalar
    ellipse: ContactEllipse
    creep: CreepForces

    @property
    def creep_force(self) -> Vec:
        """Return the creep force on the wheel, world axes [N]."""
        along = self.creep.longitudinal * self.motion.longitudinal
        return along + self.creep.lateral * self.motion.lateral

    @property
    def force(self) -> Vec:
        """Return the whole force on the wheel, world axes [N]."""
        return self.creep_force + self.normal_force * self.motion.normal

    def creep_wrench(self, kinematics: Kinematics, body: str) -> Wrench:
        """Return what creep does to a body, the normal force left out."""
        force, moment = self.creep_force, self.creep.spin_moment * self.motion.normal
        torque = ops.cross(self.point - kinematics.position(body), force) + moment
        to_body = kinematics.rotation(body).T
        return Wrench(body, to_body @ force, to_body @ torque)


def rolling_contact(
    point: Vec,
    motion: ContactMotion,
    normal_force: Scalar,
    curvatures: tuple[Scalar, Scalar],
    *,
    law: CreepLaw,
    material: Material,
) -> RollingContact:
    """Return a contact with its ellipse after Hertz and the creep forces of a law.

    Parameters
    ----------
    point
        Contact point, world axes [m].
    motion
        Motion of the wheel there.
    normal_force
        N; below zero there is no creep force [N].
    curvatures
        Half sums of curvatures along and across the direction of rolling [1/m].
    law, material
        Creep law, and what wheel and rail are made of.
    """
    load = ops.maximum(normal_force, 0.0)
    ellipse = hertz(*curvatures, material.contact_modulus).ellipse(load)
    creep = law.forces(
        CreepContact.of(
            motion.creepages,
            load,
            ellipse,
            shear_modulus=material.shear_modulus,
            poissons_ratio=material.poissons_ratio,
            speed=motion.speed,
        )
    )
    return RollingContact(point, motion, normal_force, ellipse, creep)
