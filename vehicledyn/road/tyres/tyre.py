"""What a tyre law is: forces at the contact point from load, slips and camber.

Signs after ISO 8855, contact frame x forward, y to the left, z up. Driving slip is positive
and gives a positive longitudinal force. Motion to the left is a positive slip angle and gives
a negative lateral force and a positive aligning moment. A wheel that leans to the right
has positive camber and is pushed to the right, a negative lateral force.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.symbolic import ops
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
    forward_speed
        v_x of the wheel, negative in reverse; zero is a wheel at rest [m/s].
    turn_slip
        φ_t = -ψ̇/v, curvature of the path of the wheel, positive to the right [1/m].
    """

    normal_force: Scalar
    longitudinal_slip: Scalar
    slip_angle: Scalar
    camber: Scalar
    forward_speed: Scalar = 0.0
    turn_slip: Scalar = 0.0


@dataclass(frozen=True)
class TyreForces:
    """Force and moment on the tyre at the contact point, axes of the contact frame.

    Attributes
    ----------
    longitudinal_force, lateral_force
        Components along e_x and e_lat [N].
    aligning_moment
        Moment about the ground normal [N m].
    overturning_moment
        Moment about e_x, positive to the right [N m].
    rolling_resistance
        Moment about the spin axis, negative while the wheel rolls forwards [N m].
    """

    longitudinal_force: Scalar
    lateral_force: Scalar
    aligning_moment: Scalar
    overturning_moment: Scalar = 0.0
    rolling_resistance: Scalar = 0.0


@dataclass(frozen=True)
class RelaxationLengths:
    """Distances over which forces build up along the wheel, σ_κ, and across it, σ_α [m]."""

    longitudinal: Scalar
    lateral: Scalar


class Tyre(ParameterSet):
    """Tyre law with its parameters; every tyre of the catalogue derives from it.

    Forces are finite and continuous for any finite input, and vanish with the load.
    """

    friction_field: ClassVar[str] = "friction"
    """Field that is in proportion to the friction of the ground."""

    @abstractmethod
    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the steady forces of the tyre."""

    @property
    def pulls_along(self) -> bool:
        """Whether longitudinal slip gives a force at all, whatever the numbers but zero."""
        slip = ops.symbol("longitudinal_slip")
        load = ops.symbol("normal_force")
        force = self.forces(TyreInput(load, slip, 0.0, 0.0, 1.0)).longitudinal_force
        return ops.depends_on(ops.scalar(force), slip)

    @property
    def has_overturning_moment(self) -> bool:
        """Whether side slip or camber turns the wheel about its heading by the law itself."""
        load, angle, camber = (ops.symbol(name) for name in ("normal_force", "angle", "camber"))
        moment = self.forces(TyreInput(load, 0.0, angle, camber, 1.0)).overturning_moment
        return not ops.is_structurally_zero(moment)

    @property
    def feels_turn_slip(self) -> bool:
        """Whether forces depend on the turn slip of the wheel."""
        return False

    def relaxation_lengths(self, contact: TyreInput) -> RelaxationLengths:
        """Return the relaxation lengths at a load and camber.

        Raises
        ------
        InputError
            If the law has none.
        """
        raise InputError(
            f"tyres of the kind '{self.kind}' have no relaxation lengths of their own; give them "
            "by the relaxation 'first_order'"
        )

    def carcass_stiffness(self) -> tuple[Scalar | None, Scalar | None]:
        """Return the stiffnesses of the carcass along and across the wheel, if it has any [N/m]."""
        return None, None

    def rolling_radius(self, radius: Scalar, loaded_radius: Scalar, camber: Scalar) -> Scalar:
        """Return the radius at which the wheel rolls without slip [m].

        Parameters
        ----------
        radius, loaded_radius
            Unloaded radius and distance of the contact point from the wheel centre [m].
        camber
            Camber to the ground [rad].
        """
        return ops.minimum(loaded_radius, radius)

    @property
    def feels_friction(self) -> bool:
        """Whether the law has a friction, so that patches of another may change it."""
        return self.friction_field in type(self).model_fields

    def on_ground(self, friction: Scalar) -> Tyre:
        """Return the tyre on ground whose friction over that of the tyre's own road is given [1].

        Raises
        ------
        InputError
            If the law has no friction.
        """
        if isinstance(friction, float) and friction == 1.0:
            return self
        if not self.feels_friction:
            raise InputError(
                f"tyres of the kind '{self.kind}' have no field '{self.friction_field}', so they "
                "cannot feel patches of other friction; leave out the road's patches"
            )
        scaled = getattr(self, self.friction_field) * friction
        return self.model_copy(update={self.friction_field: scaled})

    def placed(self, folder: Path) -> Tyre:
        """Return the same tyre; one that names a file looks for it in a folder."""
        return self

    def mounted(self, side: str) -> Tyre:
        """Return the tyre as it is on the "left" or "right" of a car, or in the "middle"."""
        return self
