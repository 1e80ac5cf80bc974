"""What a tyre law is: forces at the contact point from load, slips and camber.

Signs after ISO 8855, contact frame x forward, y to the left, z up. Driving slip is positive
and gives a positive longitudinal force. Motion to the left is a positive slip angle and gives
a negative lateral force and a positive aligning moment. A wheel that leans to the right
has positive camber and is pushed to the right, a negative lateral force.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class TyreInput:
    """What the tyre feels.

    Attributes
    ----------
    normal_force
        Load, zero when lifted, never negative [N].
    longitudinal_slip
        κ, -1 for a locked wheel [1].
    slip_angle
        α, within ±π/2 [rad].
    camber
        γ, inclination of the wheel plane to the ground normal [rad].
    """

    normal_force: Scalar
    longitudinal_slip: Scalar
    slip_angle: Scalar
    camber: Scalar


@dataclass(frozen=True)
class TyreForces:
    """Force on the tyre at the contact point and moment about the ground normal.

    Attributes
    ----------
    longitudinal_force, lateral_force
        Components along e_x and e_lat [N].
    aligning_moment
        Moment about the ground normal [N m].
    """

    longitudinal_force: Scalar
    lateral_force: Scalar
    aligning_moment: Scalar


class Tyre(ParameterSet):
    """Tyre law with its parameters; every tyre of the catalogue derives from it.

    Forces are finite and continuous for any finite input, and vanish with the load.
    """

    @abstractmethod
    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the steady forces of the tyre."""
