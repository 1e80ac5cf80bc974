"""Road wheel: contact, normal force, slip and tyre law as a part of a multibody system."""

from __future__ import annotations

from dataclasses import dataclass, field

from vehicledyn.base.errors import InputError
from vehicledyn.base.shapes import Anchor, Force, Plane, Shape, Wheel
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.road.surfaces.surface import RoadSurface, ground_normal
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.road.wheel.contact import (
    Contact,
    contact_at_offset,
    contact_on_plane,
    contact_residuals,
)
from vehicledyn.road.wheel.contact_below import (
    contact_below,
    contact_of_lowest_point,
    contact_on_tangent_plane,
)
from vehicledyn.road.wheel.contact_tread import Tread, contact_of_tread
from vehicledyn.road.wheel.relaxation import WheelRelaxation
from vehicledyn.road.wheel.slip import (
    SlipFloors,
    WheelMotion,
    longitudinal_slip,
    rolling_share,
    slip_angle,
    turn_slip,
)
from vehicledyn.road.wheel.soft_ground import SoilForces, direction_of_travel, soil_forces
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar, Vec

DAMPING_ENGAGEMENT = 1e-3
"""Deflection over which the damping of the tyre fades in at touch-down [m]."""

_BELOW = {
    "vertical": contact_below,
    "tangent_plane": contact_on_tangent_plane,
    "lowest_point": contact_of_lowest_point,
}
_OFFSET = ("contact_offset_x", "contact_offset_y")
_SINKAGE = "sinkage"


@dataclass(frozen=True)
class WheelState:
    """Everything a wheel knows of its contact at one instant."""

    contact: Contact
    motion: WheelMotion
    inputs: TyreInput
    forces: TyreForces
    rates: dict[str, Scalar]
    friction: Scalar


@dataclass(frozen=True)
class RoadWheel(BasePart):
    """A wheel on the road: a thin disc with a radial spring and a tyre law.

    The spring acts along the ground normal, F_z = k δ + c δ̇ and never pulls; the damping
    fades in over the first millimetre, with δ̇ taken from the velocity of the centre along
    the normal. A lifted wheel has no force. The tyre's forces act at the contact point.
    The rolling radius of the longitudinal slip is the loaded radius, unless the tyre law has
    another: then slip is the velocity of the disc's lowest point and its force always dissipates.

    On ground that is not one plane the contact point of a disc adds two algebraic unknowns,
    its horizontal offset from the wheel centre.

    Parameters
    ----------
    body
        Wheel body: origin at the wheel centre, y axis along the spin axis, axes that do not
        spin.
    spin
        Name of the coordinate that turns the wheel.
    tyre, surface
        Tyre law and ground; their parameters may be symbols.
    radius
        Unloaded radius R [m].
    stiffness, damping
        Vertical stiffness k [N/m] and damping c [N s/m].
    contact
        "disc" for the geometric contact of a disc (:mod:`vehicledyn.road.wheel.contact`),
        "vertical"
        for the rules of the Iltis benchmark, "tangent_plane" for the same with the contact
        point in the ground's tangent plane, "lowest_point" for the lowest point of the disc (all
        three :mod:`vehicledyn.road.wheel.contact_below`).
    relaxation
        Relaxation lengths; None for steady slip. Needed to stand still under load.
    floors
        Speeds at which steady slip is regularised; no effect with relaxation.
    ground_rate
        Speed at which the ground under the wheel rises, as a shaker does [m/s].
    slips_at
        "centre" where the side slip is that of the wheel centre; "contact" where it is that of the
        contact point, which the rate of camber moves too.
    crown
        Radius of the tread across a wheel that is a torus; None for a thin disc. Other contacts
        than "disc" take no notice of it [m].
    tread
        Flat tread of a wheel with a width (:mod:`vehicledyn.road.wheel.contact_tread`), in place
        of all other contacts; None for a thin disc.
    """

    body: str
    spin: str
    tyre: Tyre
    surface: RoadSurface
    radius: Scalar
    stiffness: Scalar
    damping: Scalar = 0.0
    contact: str = "disc"
    relaxation: WheelRelaxation | None = None
    floors: SlipFloors = field(default_factory=SlipFloors)
    ground_rate: Scalar = 0.0
    slips_at: str = "centre"
    crown: Scalar | None = None
    tread: Tread | None = None

    def __post_init__(self) -> None:
        """Refuse a disc on ground that a whole contact patch feels."""
        if self._is_implicit and self.surface.felt_by_patch:
            raise InputError(
                f"{self.name}: the road '{self.surface.kind}' is what a whole contact patch feels, "
                "not ground that a disc touches; choose contact 'tangent_plane' or 'vertical'"
            )

    def states(self) -> tuple[Variable, ...]:
        """Return the deflections of the contact patch, if slip is transient."""
        return () if self.relaxation is None else self.relaxation.states()

    def not_held(self) -> dict[str, str]:
        """Return the spin, where the tyre's law has no longitudinal force that could turn it."""
        if self.tyre.pulls_along:
            return {}
        words = (
            f"tyres of the kind '{self.tyre.kind}' have no longitudinal force, so nothing brings "
            "free wheels to roll: give 'wheel_spin: prescribed', or tyres with a longitudinal force"
        )
        return {self.spin: words}

    def unknowns(self) -> tuple[Variable, ...]:
        """Return the offset of the contact point if it is implicit, and the sinkage in soil."""
        offsets = (
            Variable(_OFFSET[0], "m", "Contact point from the wheel centre along world x"),
            Variable(_OFFSET[1], "m", "Contact point from the wheel centre along world y"),
        )
        sinkage = Variable(_SINKAGE, "m", "Depth of the wheel in the soil")
        soft = self.surface.soil is not None
        return (offsets if self._is_implicit else ()) + ((sinkage,) if soft else ())

    def loads(self, situation: Situation) -> Loads:
        """Return the contact wrench, the contact equations and the rates of the deflections."""
        state = self.state(situation)
        return Loads(
            wrenches=(self._wrench(situation, state),),
            rates=state.rates,
            residuals=self._residuals(situation, state),
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the channels of contact, slip and tyre forces."""
        state = self.state(situation)
        contact, inputs, forces = state.contact, state.inputs, state.forces
        along, across = forces.longitudinal_force, forces.lateral_force
        moment = forces.aligning_moment
        spin_rate = situation.kinematics.rate(self.spin)
        x, y, z = contact.position[0], contact.position[1], contact.position[2]
        channels = (
            ("tyre.normal_force", "N", "Wheel load", inputs.normal_force, "contact"),
            ("tyre.longitudinal_force", "N", "Tyre force along the wheel", along, "contact"),
            ("tyre.lateral_force", "N", "Tyre force to the left", across, "contact"),
            ("tyre.aligning_moment", "N*m", "Tyre moment about the ground", moment, "contact"),
            ("tyre.longitudinal_slip", "1", "Longitudinal slip", inputs.longitudinal_slip, ""),
            ("tyre.slip_angle", "rad", "Slip angle", inputs.slip_angle, ""),
            ("tyre.camber", "rad", "Camber to the ground", contact.camber, ""),
            ("tyre.deflection", "m", "Radial deflection", contact.deflection, ""),
            ("contact_x", "m", "Contact point, x", x, "world"),
            ("contact_y", "m", "Contact point, y", y, "world"),
            ("contact_z", "m", "Contact point, z", z, "world"),
            ("spin_rate", "rad/s", "Spin relative to the carrier", spin_rate, "joint"),
            *_further_channels(forces, inputs),
            *self._friction_channel(state),
            *self._sinkage_channel(situation),
        )
        return tuple(
            Output(Channel(f"{self.name}.{name}", unit, text, frame), value)
            for name, unit, text, value, frame in channels
        )

    def shapes(self) -> tuple[Shape, ...]:
        """Return the tyre, its force on the ground and the ground, if that is one plane."""
        ground: tuple[Shape, ...] = ()
        if self.surface.is_flat:
            vector = ground_normal(self.surface, 0.0, 0.0)
            foot = (0.0, 0.0, self.surface.height(0.0, 0.0))
            ground = (Plane("ground", foot, (vector[0], vector[1], vector[2])),)
        force = Force(
            f"{self.name}.tyre",
            tuple(f"{self.name}.contact_{axis}" for axis in "xyz"),
            tuple(f"{self.name}.tyre.{way}_force" for way in ("longitudinal", "lateral", "normal")),
            axes="contact",
            body=self.body,
            camber=f"{self.name}.tyre.camber",
        )
        wheel = Wheel(self.name, Anchor(self.body), (0.0, 1.0, 0.0), self.radius)
        return (wheel, force, *ground)

    def state(self, situation: Situation) -> WheelState:
        """Return contact, motion, slips and tyre forces as expressions."""
        contact = self._contact(situation)
        motion = self._motion(situation, contact)
        load, camber = self._normal_force(situation, contact), contact.camber
        slips = None
        if self.relaxation is not None:
            rolling = TyreInput(load, 0.0, 0.0, camber)
            slips = self.relaxation.slips(self.tyre, rolling, motion, situation.states)
            slip, angle = slips.longitudinal_slip, slips.slip_angle
        else:
            slip = longitudinal_slip(motion, self.floors.longitudinal)
            angle = slip_angle(motion, self.floors.lateral)
            camber = camber * rolling_share(ops.absolute(motion.longitudinal))
        curved = turn_slip(motion, self.floors.lateral) if self.tyre.feels_turn_slip else 0.0
        inputs = TyreInput(load, slip, angle, camber, motion.longitudinal, curved)
        friction: Scalar = 1.0
        if self.surface.soil is not None:
            forces = self._of_soil(situation, inputs)
        else:
            friction = self.surface.friction(contact.position[0], contact.position[1])
            forces = self.tyre.on_ground(friction).forces(inputs)
        rates: dict[str, Scalar] = {}
        if self.relaxation is not None and slips is not None:
            forces, rates = self.relaxation.answer(forces, slips, motion, situation.states, load)
        return WheelState(contact, motion, inputs, forces, rates, friction)

    def _of_soil(self, situation: Situation, inputs: TyreInput) -> TyreForces:
        """Return the forces of soft ground, in place of those of the tyre law."""
        soil = self._soil(situation, inputs)
        contact = self._contact(situation)
        loaded = ops.where(inputs.normal_force > 0.0, 1.0, 0.0)
        return TyreForces(
            loaded * soil.pull,
            loaded * soil.side,
            loaded * soil.turning,
            rolling_resistance=loaded * (soil.pull * contact.loaded_radius - soil.torque),
        )

    def _soil(self, situation: Situation, inputs: TyreInput) -> SoilForces:
        assert self.surface.soil is not None
        return soil_forces(
            self.surface.soil,
            self._rolling_radius(situation, self._contact(situation)),
            situation.unknowns[_SINKAGE],
            slip=inputs.longitudinal_slip,
            side_slip=ops.tan(inputs.slip_angle),
            direction=direction_of_travel(inputs.forward_speed),
        )

    def _contact(self, situation: Situation) -> Contact:
        centre, axis = self._pose(situation)
        if self.tread is not None:
            return contact_of_tread(self.surface, centre, axis, self.radius, self.tread)
        if self.contact in _BELOW:
            return _BELOW[self.contact](self.surface, centre, axis, self.radius)
        if self.surface.is_flat:
            return contact_on_plane(self.surface, centre, axis, self.radius, crown=self.crown)
        offset, crown = self._offset(situation), self.crown
        return contact_at_offset(
            self.surface, centre, axis, self.radius, offset=offset, crown=crown
        )

    def _friction_channel(self, state: WheelState) -> tuple[tuple[str, str, str, Scalar, str], ...]:
        if isinstance(state.friction, float):
            return ()
        text = "Friction of the ground over that of the tyre's own road"
        return (("ground_friction", "1", text, state.friction, ""),)

    def _sinkage_channel(
        self, situation: Situation
    ) -> tuple[tuple[str, str, str, Scalar, str], ...]:
        if self.surface.soil is None:
            return ()
        depth = ops.maximum(situation.unknowns[_SINKAGE], 0.0)
        return (("sinkage", "m", "Depth of the wheel in the soil", depth, ""),)

    def _residuals(self, situation: Situation, state: WheelState) -> tuple[Scalar, ...]:
        residuals: tuple[Scalar, ...] = ()
        if self._is_implicit:
            centre, axis = self._pose(situation)
            torus = None if self.crown is None else (self.radius, self.crown)
            offset = self._offset(situation)
            residuals = contact_residuals(self.surface, centre, axis, offset, torus=torus)
        if self.surface.soil is not None:
            sinkage = situation.unknowns[_SINKAGE]
            held = self._soil(situation, state.inputs).load
            carried = ops.where(sinkage > 0.0, held, self.stiffness * sinkage)
            carried -= self._spring_force(situation, state.contact)
            residuals += (carried / self.stiffness,)
        return residuals

    @property
    def _is_implicit(self) -> bool:
        """Whether the contact point is an unknown of the equations."""
        return self.contact == "disc" and self.tread is None and not self.surface.is_flat

    def _pose(self, situation: Situation) -> tuple[Vec, Vec]:
        """Return wheel centre [m] and unit spin axis in world axes."""
        kinematics = situation.kinematics
        return kinematics.position(self.body), kinematics.rotation(self.body)[:, 1]

    def _offset(self, situation: Situation) -> tuple[Scalar, Scalar]:
        return situation.unknowns[_OFFSET[0]], situation.unknowns[_OFFSET[1]]

    def _motion(self, situation: Situation, contact: Contact) -> WheelMotion:
        velocity = self._velocity(situation)
        return WheelMotion(
            longitudinal=ops.dot(velocity, contact.longitudinal),
            lateral=ops.dot(velocity, contact.lateral) + self._by_camber_rate(situation, contact),
            spin=situation.kinematics.angular_velocity(self.body)[1],
            rolling_radius=self._rolling_radius(situation, contact),
            turning=ops.dot(self._turning(situation), contact.normal),
        )

    def _by_camber_rate(self, situation: Situation, contact: Contact) -> Scalar:
        """Return the lateral velocity of the contact point over that of the centre [m/s]."""
        if self.slips_at == "centre":
            return 0.0
        down = contact.position - situation.kinematics.position(self.body)
        return ops.dot(ops.cross(self._turning(situation), down), contact.lateral)

    def _turning(self, situation: Situation) -> Vec:
        """Return the angular velocity of the wheel but for its spin, world axes [rad/s]."""
        rates = situation.kinematics.angular_velocity(self.body)
        return situation.kinematics.rotation(self.body) @ ops.vector(rates[0], 0.0, rates[2])

    def _rolling_radius(self, situation: Situation, contact: Contact) -> Scalar:
        """Return the radius at which the wheel rolls [m]; in soil that of its deflected rim."""
        if self.surface.soil is None:
            return self.tyre.rolling_radius(self.radius, contact.loaded_radius, contact.camber)
        sinkage = ops.maximum(situation.unknowns[_SINKAGE], 0.0)
        return ops.minimum(contact.loaded_radius + sinkage, self.radius)

    def _velocity(self, situation: Situation) -> Vec:
        """Return the velocity of the wheel centre against the ground, world axes [m/s]."""
        ground = ops.vector(0.0, 0.0, self.ground_rate)
        return situation.kinematics.velocity(self.body) - ground

    def _normal_force(self, situation: Situation, contact: Contact) -> Scalar:
        return ops.maximum(self._spring_force(situation, contact), 0.0)

    def _spring_force(self, situation: Situation, contact: Contact) -> Scalar:
        """Return the force of spring and damper of the tyre [N]; in soil it may be negative."""
        closing = -ops.dot(self._velocity(situation), contact.normal)
        overlap = ops.maximum(contact.deflection, 0.0)
        engaged = ops.minimum(overlap / DAMPING_ENGAGEMENT, 1.0)
        if self.surface.soil is not None:
            overlap = contact.deflection - situation.unknowns[_SINKAGE]
        return self.stiffness * overlap + self.damping * closing * engaged

    def _wrench(self, situation: Situation, state: WheelState) -> Wrench:
        contact, forces = state.contact, state.forces
        force = (
            contact.normal * state.inputs.normal_force
            + contact.longitudinal * forces.longitudinal_force
            + contact.lateral * forces.lateral_force
        )
        arm = contact.position - situation.kinematics.position(self.body)
        torque = ops.cross(arm, force) + contact.normal * forces.aligning_moment
        rotation = situation.kinematics.rotation(self.body)
        if not ops.is_structurally_zero(forces.overturning_moment):
            torque += contact.longitudinal * forces.overturning_moment
        if not ops.is_structurally_zero(forces.rolling_resistance):
            torque += rotation[:, 1] * forces.rolling_resistance
        to_body = rotation.T
        return Wrench(self.body, to_body @ force, to_body @ torque)


def _further_channels(
    forces: TyreForces, inputs: TyreInput
) -> tuple[tuple[str, str, str, Scalar, str], ...]:
    """Return the channels that only some tyre laws have."""
    tilt, drag = forces.overturning_moment, forces.rolling_resistance
    found = (
        (
            "tyre.overturning_moment",
            "N*m",
            "Tyre moment about the wheel's heading",
            tilt,
            "contact",
        ),
        ("tyre.rolling_resistance", "N*m", "Rolling resistance about the spin axis", drag, "joint"),
        ("tyre.turn_slip", "1/m", "Turn slip, positive to the right", inputs.turn_slip, ""),
    )
    return tuple(item for item in found if not ops.is_structurally_zero(item[3]))
