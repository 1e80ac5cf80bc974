"""Inertia of deformable bodies as the recursions know that of any body."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.model.deformation import Flexibility
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.recursion.body_inertia import BodyInertia, LinkMotion
from vehicledyn.multibody.recursion.deformed_inertia import DeformedInertia
from vehicledyn.multibody.recursion.integral_inertia import IntegralInertia
from vehicledyn.multibody.recursion.point_inertia import PointInertia
from vehicledyn.symbolic.ops import Mat, Vec


@dataclass(frozen=True)
class FlexibleInertia(BodyInertia):
    """Inertia of a deformable body about the origin of its frame, at any deformation."""

    body: Flexibility

    def at(self, kinematics: Kinematics, link: int) -> DeformedInertia:
        """Return it as the body is deformed in a motion."""
        if self.body.products is not None:
            return IntegralInertia(self.body, kinematics, link)
        return PointInertia(self.body, kinematics, link)

    def inertial_wrench(self, motion: LinkMotion) -> tuple[Vec, Vec]:
        """Return force [N] and torque [N m] about the origin that a motion needs."""
        return self.at(motion.kinematics, motion.link).wrench

    def mass_blocks(self) -> tuple[Mat, Mat, Mat]:
        """Refuse: the blocks depend on the deformation, see :meth:`at`."""
        raise ValueError("the mass of a deformable body depends on its deformation")
