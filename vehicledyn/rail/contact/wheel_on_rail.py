"""Wheels on rails, elastic: contacts, creepages and forces as a part of a multibody system."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from vehicledyn.base.parameters import field_unit
from vehicledyn.base.shapes import Shape
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, PartEvent, Situation, Wrench
from vehicledyn.rail.contact.contact_channels import (
    LATERAL_PLACE,
    ChannelRow,
    ReportedContact,
    body_rows,
    outputs_of,
    wheel_rows,
)
from vehicledyn.rail.contact.elastic_contact import Axle, ElasticContact
from vehicledyn.rail.contact.elastic_patch import ElasticPatch
from vehicledyn.rail.contact.rail_contact import RailWheels
from vehicledyn.rail.contact.rail_shapes import rail_wheel_shapes
from vehicledyn.rail.creep.creep_law import CreepContact, CreepForces, CreepLaw
from vehicledyn.rail.creep.creepage import Creepages, creepages
from vehicledyn.rail.geometry.gauge_fit import CLIMBED
from vehicledyn.rail.track.running import (
    TRACK_POSITION,
    Running,
    SideMotion,
    running,
    sloping_rails,
)
from vehicledyn.rail.track.track import Side
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Variable
from vehicledyn.symbolic.ops import Scalar, Vec
from vehicledyn.symbolic.shared import shared


@dataclass(frozen=True)
class PatchForces:
    """One contact with what acts there, seen from the wheel's own side.

    ``normal_force`` N is never negative [N]; ``arm`` leads from the body's origin to the contact
    [m]; ``force`` is the whole force on the wheel, ``moment`` that about the normal, as vectors.
    """

    patch: ElasticPatch
    creepages: Creepages
    normal_force: Scalar
    creep_forces: CreepForces
    arm: Vec
    force: Vec
    moment: Vec

    @property
    def reported(self) -> ReportedContact:
        """What the channels show."""
        patch = self.patch
        return ReportedContact(
            self.creepages,
            self.creep_forces,
            self.normal_force,
            place=patch.place,
            lateral_place=patch.y,
            angle=patch.angle,
            rolling_radius=patch.radius,
            approach=patch.approach,
        )


@dataclass(frozen=True)
class WheelForces:
    """All contacts of one wheel, from the field side to the flange."""

    seen: SideMotion
    patches: tuple[PatchForces, ...]

    @property
    def force(self) -> Vec:
        """Force on the wheel in the axes of the track [N]."""
        return self.seen.polar(_total([p.force for p in self.patches]))

    def torque(self) -> Vec:
        """Return the torque on the body about its origin, in the axes of the track [N m]."""
        torques = [ops.cross(p.arm, p.force) + p.moment for p in self.patches]
        return self.seen.axial(_total(torques))


@dataclass(frozen=True)
class ElasticWheels(BasePart):
    """The wheels of one body on rails: an independent wheel or a wheelset.

    Every contact has Hertz's normal force N (1 + d δ̇) ≥ 0, creepages of the wheel's material
    against the rail's at the contact, and the forces of the creep law. A lifted wheel has none.
    The reference speed of the creepages is that at which the contact travels.

    On curved track one Newton step leads to the place beside the body, from where the motion of
    its carrier has it or else from a state with the exact rate.

    A wheel whose flange has climbed its rail, or that has fallen from the rail to the inside, is
    derailed; that is an event that ends the run.

    Parameters
    ----------
    wheels
        The wheels.
    contact
        Their profiles over the rails.
    effective_modulus, shear_modulus
        E* and G of wheel and rail [N/m²].
    poissons_ratio
        ν of both [1].
    damping
        d, part of the normal force added a unit of closing speed [s/m].
    """

    rolls_on_rails: ClassVar[bool] = True
    settles_on_rails: ClassVar[bool] = True

    wheels: RailWheels
    contact: ElasticContact
    effective_modulus: Scalar
    shear_modulus: Scalar
    poissons_ratio: Scalar
    damping: Scalar

    def states(self) -> tuple[Variable, ...]:
        """Return the place along the track where that is curved."""
        if self.wheels.finds_its_place:
            return ()
        start = self.wheels.first_place
        return (Variable(TRACK_POSITION, "m", "Place along the track", start),)

    def loads(self, situation: Situation) -> Loads:
        """Return the wrench of all contacts and the rate of the place along the track."""
        motion = self._running(situation)
        rates = {} if self.wheels.finds_its_place else {TRACK_POSITION: motion.rate}
        return Loads(wrenches=(self._wrench(situation, motion),), rates=rates)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the channels of the body, of each wheel and of each contact."""
        motion = self._running(situation)
        rows = body_rows(
            self.wheels.track,
            position=motion.position,
            rate=motion.rate,
            place=motion.place,
            axle=motion.axle,
            nominal=self.wheels.nominal,
        )
        if not self.wheels.finds_its_place:
            rows = [row for row in rows if row.name != TRACK_POSITION]  # a state has its channel
        for side in self.wheels.sides:
            rows.extend(self._wheel_rows(motion, side))
        return outputs_of(self.name, rows)

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return the derailment of each wheel, over its rail or between the rails."""
        motion = self._running(situation)
        found = []
        for side in self.wheels.sides:
            seen = motion.seen_from(side)
            outwards = seen.axle[1]
            tape = seen.lateral + outwards * self.wheels.tape_circle
            face = self.contact.gauge_face
            over = tape + outwards * self.contact.tip - (face + CLIMBED)
            inside = face - (tape + outwards * self.contact.last)
            found.append(
                PartEvent(
                    f"{side}.derailed",
                    ops.maximum(over, inside),
                    "rising",
                    terminal=True,
                    advice=f"the {side} wheel of '{self.name}' has left its rail",
                    outcome="derailed",
                )
            )
        return tuple(found)

    def shapes(self) -> tuple[Shape, ...]:
        """Return wheels, axle and forces."""
        w = self.wheels
        return rail_wheel_shapes(
            self.name, w.body, w.sides, radius=w.radius, tape_circle=w.tape_circle
        )

    def forces(self, seen: SideMotion) -> WheelForces:
        """Return the contacts of the wheel on one side and what acts there."""
        axle = Axle(seen.lateral, seen.height, seen.axle, self.wheels.tape_circle, seen.curvature)
        patches = self.contact.patches(axle, self.wheels.radius, self.effective_modulus)
        return WheelForces(seen, tuple(self._at(seen, patch) for patch in reversed(patches)))

    def _at(self, seen: SideMotion, patch: ElasticPatch) -> PatchForces:
        """Return what acts at one contact."""
        slopes = seen.slopes_at(patch.y)
        along, across, normal = _axes(patch, slopes)
        ahead = patch.x + patch.radius * _ahead(patch, slopes)
        arm = ops.vector(ahead, patch.y - seen.lateral, patch.z - seen.height)
        sliding = seen.velocity + ops.cross(seen.angular_velocity, arm)
        speed = seen.speed_at(patch.y)
        creep = creepages(
            (ops.dot(sliding, along), ops.dot(sliding, across)),
            ops.dot(seen.angular_velocity, normal),
            speed,
        )
        closing = -ops.dot(sliding, normal)
        load = patch.force * ops.maximum(1.0 + self.damping * closing, 0.0)
        contact = CreepContact.of(
            creep,
            load,
            patch.ellipse,
            shear_modulus=self.shear_modulus,
            poissons_ratio=self.poissons_ratio,
            speed=speed,
        )
        tangential = self.wheels.creep.forces(contact)
        force = normal * load + along * tangential.longitudinal + across * tangential.lateral
        return PatchForces(
            patch, creep, load, tangential, arm, force, normal * tangential.spin_moment
        )

    def _running(self, situation: Situation) -> Running:
        wheels = self.wheels
        guess = situation.states.get(TRACK_POSITION, 0.0)
        if wheels.guide is not None:
            guess = wheels.guide(situation.time)
        return running(situation, wheels.body, wheels.track, wheels.sides, guess)

    def _wrench(self, situation: Situation, motion: Running) -> Wrench:
        found = [self._force_and_torque(motion, side) for side in self.wheels.sides]
        rotation = situation.kinematics.rotation(self.wheels.body)
        to_body = rotation.T @ motion.frame.rotation
        force, torque = (_total(list(vectors)) for vectors in zip(*found, strict=True))
        return Wrench(self.wheels.body, to_body @ force, to_body @ torque)

    def _force_and_torque(self, motion: Running, side: Side) -> tuple[Vec, Vec]:
        """Return what acts on one wheel, the torque about the body's origin, track axes."""
        seen = motion.seen_from(side)
        found, _ = self._shared(seen)
        return seen.polar(ops.vector(*found[:3])), seen.axial(ops.vector(*found[3:6]))

    def _wheel_rows(self, motion: Running, side: Side) -> Iterator[ChannelRow]:
        """Yield the channels of a wheel."""
        seen = motion.seen_from(side)
        found, rows = self._shared(seen)
        for row, own in zip(rows, found[6:], strict=True):
            value = seen.sign * own if row.turns else own
            if row.name.endswith(LATERAL_PLACE):  # seen from its side the rail is not displaced
                value = value + motion.shifts[side].lateral
            yield row._replace(name=f"{side}.{row.name}", value=value)

    def _shared(self, seen: SideMotion) -> tuple[list[Scalar], list[ChannelRow]]:
        """Return force, torque and channels of a wheel seen from its side, and the channels.

        The equations are those of all equal wheels, left and right, so they are shared.
        """
        built, rows = self._built

        def build(values: list[Scalar]) -> list[Scalar]:
            forces = self._with(values[_SEEN:]).forces(SideMotion.of(values[:_SEEN], 1.0))
            rows[:] = wheel_rows(forces.force, [at.reported for at in forces.patches])
            force, torque = forces.force, forces.torque()
            acting = [*(force[k] for k in range(3)), *(torque[k] for k in range(3))]
            return [*acting, *(row.value for row in rows)]

        slopes = sloping_rails(self.wheels.track)
        kept = [k for k, is_there in zip(_SLOPES, slopes, strict=True) if is_there]
        numbers = [*seen.numbers, *self._quantities()]
        return shared("wheel_on_rail", numbers, build, kept, built), rows

    @property
    def _built(self) -> tuple[dict[tuple[float | None, ...], Any], list[ChannelRow]]:
        """The equations that were built for such wheels, and the channels among them."""
        creep = self.wheels.creep
        quantities = set(_numbers_of(creep))
        rest = [(n, getattr(creep, n)) for n in type(creep).model_fields if n not in quantities]
        kept: tuple[dict[tuple[float | None, ...], Any], list[ChannelRow]]
        kept = self.contact.functions.setdefault((type(creep), repr(rest)), ({}, []))
        return kept

    def _quantities(self) -> list[Scalar]:
        """Return all quantities of the wheels and their contact that may be symbols."""
        w, creep = self.wheels, self.wheels.creep
        contact = (self.effective_modulus, self.shear_modulus, self.poissons_ratio, self.damping)
        return [w.tape_circle, w.radius, *contact, *(getattr(creep, n) for n in _numbers_of(creep))]

    def _with(self, quantities: list[Scalar]) -> ElasticWheels:
        """Return the same wheels with these quantities in the place of their own."""
        circle, radius, *contact = quantities[:6]
        creep = self.wheels.creep
        laws = dict(zip(_numbers_of(creep), quantities[6:], strict=True))
        wheels = replace(
            self.wheels,
            tape_circle=circle,
            radius=radius,
            creep=creep.model_copy(update=laws),
        )
        modulus, shear, ratio, damping = contact
        return replace(
            self,
            wheels=wheels,
            effective_modulus=modulus,
            shear_modulus=shear,
            poissons_ratio=ratio,
            damping=damping,
        )


_SEEN, _SLOPES = 17, (14, 15, 16)
"""Numbers that a motion seen from one side consists of, and which of them are the rail's slopes."""


def _numbers_of(creep: CreepLaw) -> list[str]:
    """Return the fields of a creep law that hold quantities."""
    return [name for name in type(creep).model_fields if field_unit(type(creep), name) is not None]


def _axes(patch: ElasticPatch, slopes: tuple[Scalar, Scalar]) -> tuple[Vec, Vec, Vec]:
    """Return the axes of a contact: along the rail, across it outwards, and out of the rail.

    They are square to each other to first order in the heading and the slopes of the rail.
    """
    (cosine, sine), (outwards, upwards) = patch.tangent, slopes
    heading = patch.heading + outwards
    along = ops.vector(1.0, heading, upwards)
    across = ops.vector(-heading * cosine - upwards * sine, cosine, sine)
    normal = ops.vector(heading * sine - upwards * cosine, -sine, cosine)
    return along, across, normal


def _ahead(patch: ElasticPatch, slopes: tuple[Scalar, Scalar]) -> Scalar:
    """Return the angle about the axle by which the slope of its rail moves a contact ahead [rad].

    There the normal of the wheel, which meets its axle, is square to the rail again.
    """
    (cosine, sine), (outwards, upwards) = patch.tangent, slopes
    return upwards - outwards * sine / cosine


def _total(vectors: list[Vec]) -> Vec:
    total = vectors[0]
    for vector in vectors[1:]:
        total = total + vector
    return total
