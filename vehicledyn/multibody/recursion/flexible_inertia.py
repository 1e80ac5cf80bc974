"""Inertia of deformable bodies as the recursions know that of any body."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.model.bodies import Body
from vehicledyn.multibody.model.deformation import Flexibility
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.recursion.body_inertia import BodyInertia, BodyMotion
from vehicledyn.multibody.recursion.deformed_inertia import DeformedInertia
from vehicledyn.multibody.recursion.integral_inertia import IntegralInertia
from vehicledyn.multibody.recursion.point_inertia import PointInertia, energies_of_points
from vehicledyn.symbolic.ops import Mat, Scalar, Vec


@dataclass(frozen=True)
class FlexibleInertia(BodyInertia):
    """Inertia of a deformable body about the origin of its frame, at any deformation."""

    body: Flexibility

    def at(self, kinematics: Kinematics, link: int) -> DeformedInertia:
        """Return it as the body is deformed in a motion."""
        if self.body.products is not None:
            return IntegralInertia(self.body, kinematics, link)
        return PointInertia(self.body, kinematics, link)

    def inertial_wrench(self, motion: BodyMotion) -> tuple[Vec, Vec]:
        """Return force [N] and torque [N m] about the origin that a motion needs."""
        return self.at(motion.kinematics, motion.link).wrench

    def mass_blocks(self) -> tuple[Mat, Mat, Mat]:
        """Refuse: the blocks depend on the deformation, see :meth:`at`."""
        raise ValueError("the mass of a deformable body depends on its deformation")


def deformable_energies(kinematics: Kinematics, body: Body, gravity: Vec) -> tuple[Scalar, Scalar]:
    """Return kinetic energy and potential energy in the gravity field of a deformable body [J]."""
    flexibility = body.flexibility
    if flexibility is None:
        raise ValueError(f"body '{body.name}' does not deform")
    link = kinematics.tree.body_link[body.name]
    if flexibility.has_points:
        return energies_of_points(kinematics, link, flexibility, gravity)
    return IntegralInertia(flexibility, kinematics, link).energies(gravity)
