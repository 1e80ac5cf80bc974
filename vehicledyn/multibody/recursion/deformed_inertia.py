"""What the recursions ask of the inertia of a deformable body in a motion."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from vehicledyn.multibody.model.deformation import Flexibility
from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.link_motion import components
from vehicledyn.multibody.recursion.inertia import Inertia
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec


@dataclass(frozen=True)
class DeformedInertia(ABC):
    """A deformable body in a motion."""

    body: Flexibility
    kinematics: Kinematics
    link: int

    @property
    @abstractmethod
    def rigid(self) -> Inertia:
        """Inertia with the deformation frozen."""

    @abstractmethod
    def unit_wrench(self, k: int) -> JointWrench:
        """Return what the frame must transmit for a unit acceleration of a coordinate."""

    @abstractmethod
    def entry(self, k: int, other: int) -> Scalar:
        """Return the entry of the mass matrix between two coordinates of the deformation."""

    @property
    @abstractmethod
    def wrench(self) -> tuple[Vec, Vec]:
        """Force and torque about the origin that the motion needs [N, N m]."""

    @abstractmethod
    def forces(self) -> list[Scalar]:
        """Return the force on each coordinate of the deformation that the motion needs."""

    @property
    def spun(self) -> list[Scalar]:
        """Derivatives of (ω, q̇)."""
        alpha = self.kinematics.link_angular_acceleration(self.link)
        return [*components(alpha), *self.kinematics.amplitude_accelerations(self.link)]

    @property
    def turning_torque(self) -> Vec:
        """Rate of the angular momentum h = T (ω, q̇) beyond that of the points, ḣ + ω × h."""
        turning, spun = self.body.turning, self.spun
        omega = self.kinematics.link_angular_velocity(self.link)
        moving = [*components(omega), *self.kinematics.amplitude_rates(self.link)]
        held = ops.vector(*(turning.product(i, moving) for i in range(3)))
        return ops.vector(*(turning.product(i, spun) for i in range(3))) + ops.cross(omega, held)
