"""Rigid contact of wheels and rails: constraints that demand touch, and creep forces with it.

Each wheel has one contact coordinate, the place s on its outline, and off the straight the body
has its arc coordinate; both are coordinates of massless bodies that the constraints determine. The
gap's multiplier gives the normal force N. Creep forces depend on N and N on the creep forces, so N
is an unknown solved together with the accelerations
(:meth:`~vehicledyn.multibody.parts.Part.reactions`): no creep law is too stiff or too much
saturated for it.

A rigid contact can neither lift nor jump to another point. Both end the run with an event:
``<side>.lifts`` where N vanishes, ``<side>.leaves_window`` where the contact leaves the part of
the wheel on which it is the only one; the elastic model goes on from there.
"""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.parts import BasePart, Loads, Output, PartEvent, Situation
from vehicledyn.multibody.system import GROUND, Body, Joint
from vehicledyn.rail.creep_law import CreepLaw
from vehicledyn.rail.rigid_constraint import FORCE, OnTrack, PositionConstraint, TouchConstraint
from vehicledyn.rail.rigid_touch import Touch, TouchingWheel
from vehicledyn.rail.rolling_contact import (
    Material,
    RollingContact,
    contact_motion,
    rolling_contact,
)
from vehicledyn.rail.track import Side, Track
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class RigidWheel:
    """A wheel in rigid contact.

    ``start`` is where the contact is looked for first, on the outline of the wheel; ``window``
    the range of places in which it may be, None for any [m].
    """

    touching: TouchingWheel
    start: float = 0.0
    window: tuple[float, float] | None = None

    @property
    def side(self) -> Side:
        """Name of the side."""
        return "left" if self.touching.side > 0.0 else "right"


@dataclass(frozen=True)
class RigidRailWheels(BasePart):
    """The wheels of one body in rigid contact with their rails.

    A system takes the part itself, its :meth:`bodies` and its :meth:`constraints`.

    Parameters
    ----------
    body
        Wheelset or wheel; its y axis is the axle's, its axes may spin with it or not.
    wheels
        One or two wheels.
    track
        Where the rails run.
    law, material
        Creep law, and what wheels and rails are made of.
    """

    body: str
    wheels: tuple[RigidWheel, ...]
    track: Track
    law: CreepLaw
    material: Material

    def bodies(self) -> tuple[Body, ...]:
        """Return the massless bodies of the contact coordinates."""
        joints = [self._joint(wheel) for wheel in self.wheels]
        if not self.track.is_straight:
            text = "Arc coordinate of the body along the track"
            joints.append(Joint("T1", self._carrier.position, 0.0, "dependent", description=text))
        return tuple(Body(f"{j.name}_coordinate", GROUND, joints=(j,)) for j in joints)

    def constraints(self) -> tuple[PositionConstraint | TouchConstraint, ...]:
        """Return the constraints that determine them and make the wheels touch."""
        touching = tuple(self._constraint(wheel) for wheel in self.wheels)
        if self.track.is_straight:
            return touching
        return (PositionConstraint(f"{self.name}.on_track", self._carrier), *touching)

    def reactions(self) -> tuple[Variable, ...]:
        """Return the normal forces, which creep depends on."""
        return tuple(
            Variable(f"{w.side}.normal_force", "N", f"Normal force of the {w.side} wheel")
            for w in self.wheels
        )

    def found_reactions(self, situation: Situation) -> tuple[Scalar, ...]:
        """Return the normal forces from the multipliers of the gaps."""
        if situation.forces is None:
            raise ValueError("the forces of the constraints are not known at this stage")
        found = []
        for wheel in self.wheels:
            constraint = self._constraint(wheel)
            upright = constraint.touch(situation.kinematics).normal[2]
            found.append(situation.forces.multiplier(constraint.name, FORCE) / upright)
        return tuple(found)

    def loads(self, situation: Situation) -> Loads:
        """Return the creep forces on the body."""
        kinematics = situation.kinematics
        contacts = [self._contact(situation, wheel) for wheel in self.wheels]
        return Loads(wrenches=tuple(c.creep_wrench(kinematics, self.body) for c in contacts))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the channels of the contacts, and the lateral shift."""
        shift = self._carrier.place(situation.kinematics)[1]
        channel = Channel(f"{self.name}.lateral_shift", "m", "Shift to the left", "track")
        outputs = [Output(channel, shift)]
        for wheel in self.wheels:
            touch = self._constraint(wheel).touch(situation.kinematics)
            outputs += self._channels(situation, wheel, touch)
        return tuple(outputs)

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return the ends of rigid contact: wheels that lift, contacts that leave their window."""
        events = []
        for w in self.wheels:
            force = situation.reactions[f"{w.side}.normal_force"]
            events.append(PartEvent(f"{w.side}.lifts", force, "falling", terminal=True))
            if w.window is not None:
                place = situation.kinematics.coordinate(self._place(w))
                inside = ops.minimum(place - w.window[0], w.window[1] - place)
                name = f"{w.side}.leaves_window"
                events.append(PartEvent(name, inside, "falling", terminal=True))
        return tuple(events)

    def _contact(self, situation: Situation, wheel: RigidWheel) -> RollingContact:
        kinematics, carrier = situation.kinematics, self._carrier
        touch = self._constraint(wheel).touch(kinematics)
        frame = carrier.frame(kinematics)
        point = frame.position + frame.rotation @ touch.point
        motion = contact_motion(
            kinematics,
            self.body,
            point=point,
            normal=frame.rotation @ touch.normal,
            axle=carrier.axle(kinematics),
        )
        return rolling_contact(
            point,
            motion,
            situation.reactions[f"{wheel.side}.normal_force"],
            touch.curvatures,
            law=self.law,
            material=self.material,
        )

    def _channels(self, situation: Situation, wheel: RigidWheel, touch: Touch) -> list[Output]:
        contact = self._contact(situation, wheel)
        force = self._carrier.frame(situation.kinematics).rotation.T @ contact.force
        felt, creep = contact.motion.creepages, contact.creep
        angle = ops.atan(touch.rail.slope)
        channels = (
            ("normal_force", "N", "Normal force", contact.normal_force, "contact"),
            ("longitudinal_force", "N", "Creep force along", creep.longitudinal, "contact"),
            ("lateral_force", "N", "Creep force to the left", creep.lateral, "contact"),
            ("spin_moment", "N*m", "Moment about the normal", creep.spin_moment, "contact"),
            ("longitudinal_creepage", "1", "Longitudinal creepage", felt.longitudinal, "contact"),
            ("lateral_creepage", "1", "Lateral creepage", felt.lateral, "contact"),
            ("spin_creepage", "1/m", "Spin creepage", felt.spin, "contact"),
            ("contact_y", "m", "Contact point", touch.point[1], "track"),
            ("contact_angle", "rad", "Contact angle, rising outwards", angle, "track"),
            ("rolling_radius", "m", "Rolling radius", touch.rolling_radius, ""),
            ("Y", "N", "Force of the wheel on the rail, to the left", -force[1], "track"),
            ("Q", "N", "Force of the wheel on the rail, downwards", force[2], "track"),
            ("wear_number", "N", "Work of friction a length of way", contact.wear_number, ""),
        )
        return [
            Output(Channel(f"{self.name}.{wheel.side}.{name}", unit, text, frame), value)
            for name, unit, text, value, frame in channels
        ]

    @property
    def _carrier(self) -> OnTrack:
        return OnTrack(self.body, self.track, f"{self.name}.track_position")

    def _constraint(self, wheel: RigidWheel) -> TouchConstraint:
        name = f"{self.name}.{wheel.side}"
        return TouchConstraint(name, self._carrier, wheel.touching, wheel.side, self._place(wheel))

    def _place(self, wheel: RigidWheel) -> str:
        return f"{self.name}.{wheel.side}.place"

    def _joint(self, wheel: RigidWheel) -> Joint:
        text = f"Contact of the {wheel.side} wheel from its tape circle, outwards"
        return Joint("T2", self._place(wheel), wheel.start, "dependent", description=text)
