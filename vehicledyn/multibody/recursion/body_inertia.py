"""What the recursions ask of the inertia of a body that moves with a link of the tree."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.symbolic.ops import Mat, Vec


@dataclass(frozen=True)
class BodyMotion:
    """Motion of a link's frame in its own axes; what nobody asks for is not evaluated."""

    kinematics: Kinematics
    link: int

    @property
    def angular_velocity(self) -> Vec:
        """ω [rad/s]."""
        return self.kinematics.link_angular_velocity(self.link)

    @property
    def angular_acceleration(self) -> Vec:
        """α [rad/s²]."""
        return self.kinematics.link_angular_acceleration(self.link)

    @property
    def acceleration(self) -> Vec:
        """Acceleration a of the origin [m/s²]."""
        return self.kinematics.link_acceleration(self.link)

    @property
    def beta(self) -> Mat:
        """tilde(α) + tilde(ω) tilde(ω) [1/s²]."""
        return self.kinematics.beta(self.link)


class BodyInertia(ABC):
    """Inertia of a body about the origin of its link, in the axes of the link.

    That of a deformable body depends on its deformation, and adds forces on the coordinates of
    this and blocks of the mass matrix that couple them, see
    :mod:`vehicledyn.multibody.recursion.flexible_inertia`.
    """

    @abstractmethod
    def inertial_wrench(self, motion: BodyMotion) -> tuple[Vec, Vec]:
        """Return force [N] and torque [N m] about the origin that a motion needs."""

    @abstractmethod
    def mass_blocks(self) -> tuple[Mat, Mat, Mat]:
        """Return L, C and R of force = L a + C α, torque = Cᵀ a + R α [kg, kg m, kg m²]."""
