"""Rigid contact of wheels and rails: constraints that demand touch, and creep forces with it.

Each wheel has one contact coordinate, the place s on its outline, and off the straight the body
has its arc coordinate; both are coordinates of massless bodies that the constraints determine. The
gap's multiplier gives the normal force N. Creep forces depend on N and N on the creep forces, so N
is an unknown solved together with the accelerations
(:meth:`~vehicledyn.multibody.model.parts.Part.reactions`): no creep law is too stiff or too much
saturated for it.

Where the wheel touches the rail at a second point, the contact jumps there: ``<side>.jumps`` is
an event after which the constraint holds the other point. The wheel hits the rail there without
rebound and comes free of the old one (:mod:`vehicledyn.multibody.equations.impacts`). A wheel that
lifts,
``<side>.lifts``, or whose contact reaches the end of a profile, ``<side>.leaves``, ends the run:
the elastic model goes on from there.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from vehicledyn.base.shapes import Shape
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, PartEvent, Situation
from vehicledyn.rail.contact.contact_channels import (
    ChannelRow,
    ReportedContact,
    body_rows,
    outputs_of,
    wheel_rows,
)
from vehicledyn.rail.contact.rail_shapes import rail_wheel_shapes
from vehicledyn.rail.contact.rigid_constraint import (
    FORCE,
    OnTrack,
    PositionConstraint,
    TouchConstraint,
)
from vehicledyn.rail.contact.rigid_touch import TouchingWheel
from vehicledyn.rail.contact.rolling_contact import (
    Material,
    RollingContact,
    contact_motion,
    rolling_contact,
)
from vehicledyn.rail.creep.creep_law import CreepLaw
from vehicledyn.rail.track.running import TRACK_POSITION
from vehicledyn.rail.track.track import Side, Track
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Variable
from vehicledyn.symbolic.ops import Scalar

PENETRATION = 1e-7
"""How deep a second place of a wheel goes into the rail before the contact jumps there [m]."""

_ADVICE = "take 'rail_contact: {kind: elastic}' for this motion"


@dataclass(frozen=True)
class RigidWheel:
    """A wheel in rigid contact.

    ``start`` is where the contact is looked for first, on the outline of the wheel, ``ends`` is
    where the outline ends, if it does [m]. Of profiles that may touch at several places ``places``
    are those to look at, a fraction of a millimetre apart: contact may jump between them.
    """

    touching: TouchingWheel
    start: float = 0.0
    ends: tuple[float, float] | None = None
    places: tuple[float, ...] = ()

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
    nominal
        Lateral place of the body's origin from which its shift counts, to the left [m].
    """

    rolls_on_rails: ClassVar[bool] = True

    body: str
    wheels: tuple[RigidWheel, ...]
    track: Track
    law: CreepLaw
    material: Material
    nominal: Scalar = 0.0

    def added_bodies(self) -> tuple[Body, ...]:
        """Return the massless bodies of the contact coordinates."""
        joints = [self._joint(wheel) for wheel in self.wheels]
        if not self.track.is_straight:
            text = "Arc coordinate of the body along the track"
            joints.append(Joint("T1", self._carrier.position, 0.0, "dependent", description=text))
        return tuple(
            Body(f"{j.name}_coordinate", GROUND, joints=(j,), is_abstract=True) for j in joints
        )

    def added_constraints(self) -> tuple[PositionConstraint | TouchConstraint, ...]:
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
        """Return the channels of the body and of each wheel, named as those of elastic contact."""
        kinematics, carrier = situation.kinematics, self._carrier
        rows = body_rows(
            self.track,
            position=carrier.arc(kinematics),
            rate=carrier.speed(kinematics),
            place=carrier.place(kinematics),
            axle=carrier.frame(kinematics).rotation.T @ carrier.axle(kinematics),
            nominal=self.nominal,
        )
        if not self.track.is_straight:  # there it is a coordinate, which has its channel
            rows = [row for row in rows if row.name != TRACK_POSITION]
        for wheel in self.wheels:
            own = self._wheel_rows(situation, wheel)
            rows += [row._replace(name=f"{wheel.side}.{row.name}") for row in own]
        return outputs_of(self.name, rows)

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return jumps of contacts, and what ends rigid contact."""
        events = []
        for w in self.wheels:
            force = situation.reactions[f"{w.side}.normal_force"]
            lifts = f"the {w.side} wheel lifts, which rigid contact cannot follow; {_ADVICE}"
            events.append(_ending(f"{w.side}.lifts", force, lifts, "lifted"))
            if w.ends is not None:
                place = situation.kinematics.coordinate(self._place(w))
                inside = ops.minimum(place - w.ends[0], w.ends[1] - place)
                leaves = f"the contact reaches the end of the {w.side} wheel's profile; {_ADVICE}"
                events.append(_ending(f"{w.side}.leaves", inside, leaves, "derailed"))
            if w.places:
                constraint = self._constraint(w)
                events.append(
                    PartEvent(
                        f"{w.side}.jumps",
                        constraint.lowest(situation.kinematics)[0] + PENETRATION,
                        "falling",
                        guesses={self._place(w): constraint.landing(situation.kinematics)},
                        lands=True,
                    )
                )
        return tuple(events)

    def shapes(self) -> tuple[Shape, ...]:
        """Return wheels, axle and forces."""
        first = self.wheels[0].touching
        return rail_wheel_shapes(
            self.name,
            self.body,
            [wheel.side for wheel in self.wheels],
            radius=first.radius,
            tape_circle=first.half_distance,
        )

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
            speed=carrier.speed(kinematics, touch.point[1]),
        )
        return rolling_contact(
            point,
            motion,
            situation.reactions[f"{wheel.side}.normal_force"],
            touch.curvatures,
            law=self.law,
            material=self.material,
        )

    def _wheel_rows(self, situation: Situation, wheel: RigidWheel) -> Iterator[ChannelRow]:
        """Return the channels of a wheel."""
        touch = self._constraint(wheel).touch(situation.kinematics)
        contact = self._contact(situation, wheel)
        force = self._carrier.frame(situation.kinematics).rotation.T @ contact.force
        reported = ReportedContact(
            contact.motion.creepages,
            contact.creep,
            contact.normal_force,
            place=situation.kinematics.coordinate(self._place(wheel)),
            lateral_place=touch.point[1],
            angle=ops.atan(touch.rail.slope),
            rolling_radius=touch.rolling_radius,
        )
        return wheel_rows(force, [reported])

    @property
    def _carrier(self) -> OnTrack:
        return OnTrack(self.body, self.track, f"{self.name}.{TRACK_POSITION}")

    def _constraint(self, wheel: RigidWheel) -> TouchConstraint:
        name = f"{self.name}.{wheel.side}"
        return TouchConstraint(
            name, self._carrier, wheel.touching, wheel.side, self._place(wheel), wheel.places
        )

    def _place(self, wheel: RigidWheel) -> str:
        return f"{self.name}.{wheel.side}.place"

    def _joint(self, wheel: RigidWheel) -> Joint:
        text = f"Contact of the {wheel.side} wheel from its tape circle, outwards"
        return Joint("T2", self._place(wheel), wheel.start, "dependent", description=text)


def _ending(name: str, expression: Scalar, advice: str, outcome: str) -> PartEvent:
    return PartEvent(name, expression, "falling", terminal=True, advice=advice, outcome=outcome)
