"""What a system file may say: parameters, bodies, cuts, forces, drives, sensors and wheels."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, field_validator, model_validator

from vehicledyn.base.parameters import ParameterSet, part
from vehicledyn.base.units import describe
from vehicledyn.files.expressions.expressions import origin, read_expression, zero
from vehicledyn.files.expressions.fields import (
    Moments,
    Scalar,
    SystemSet,
    Vector,
    measured,
    read_mapping,
    reference,
    section,
)
from vehicledyn.files.system.assembly_sets import AssemblySet, ConnectionSet
from vehicledyn.files.system.events import EventSet
from vehicledyn.files.system.joints import Coordinate, JointSet
from vehicledyn.files.system.laws import TimeLaw
from vehicledyn.files.system.rail_wheels import RailWheelSet
from vehicledyn.multibody.model.ground import GROUND

_STANDARD_GRAVITY = read_expression([0.0, 0.0, "-9.81 m/s^2"])


class BodySet(SystemSet):
    """A rigid body and the chain of joints that carries it."""

    parent: str = reference("body", "Body that carries it, or ground", default=GROUND)
    at: Vector = measured(
        "m", "Where the chain starts, in the axes of the parent", default=origin(), nature="polar"
    )
    joints: tuple[JointSet, ...] = part(
        "joint", "Joints and fixed turns, from the parent outwards", default=()
    )
    mass: Scalar | None = measured("kg", "Mass; without it none", default=None, above=0.0)
    com: Vector = measured(
        "m", "Centre of mass in the axes of the body", default=origin(), nature="polar"
    )
    inertia: Moments | None = measured(
        "kg*m^2",
        "Ixx, Iyy, Izz and, if not zero, the matrix elements Ixy, Ixz, Iyz about the centre of "
        "mass in the axes of the body",
        default=None,
        nature="inertia",
    )
    spins_about: Literal[1, 2, 3] | None = Field(
        default=None,
        description="Axis of a body of revolution whose last joint turns about it; the axes of "
        "the body then do not spin",
    )
    apparent_inertia: bool = Field(
        default=False,
        description="Whether the inertia is one that was identified or that holds gears and "
        "motors, so that it may break the triangle inequality",
    )

    @field_validator("joints", mode="before")
    @classmethod
    def _short_joints(cls, value: Any) -> Any:
        if not isinstance(value, list | tuple):
            words = f"expected a list of joints, such as [R2 angle], found {describe(value)}"
            raise ValueError(words)
        return [_long_joint(item) for item in value]

    @model_validator(mode="after")
    def _inertia_goes_with_mass(self) -> BodySet:
        if self.inertia is not None and self.mass is None:
            raise ValueError("an inertia without a mass; give the mass or leave the inertia out")
        if self.inertia is not None and len(self.inertia) not in (3, 6):
            raise ValueError(f"the inertia has 3 or 6 elements, not {len(self.inertia)}")
        return self

    def coordinates(self, name: str) -> list[Coordinate]:
        """Return the coordinates of the body of this name."""
        return [c for joint in self.joints for c in joint.coordinates(name)]


def _long_joint(item: Any) -> Any:
    """Return the mapping that "R2" or "R2 angle" is short for."""
    if not isinstance(item, str):
        return item
    kind, _, name = item.partition(" ")
    return {"kind": kind, "name": name.strip()} if name.strip() else {"kind": kind}


class ForceSet(SystemSet):
    """A force on a coordinate, positive the way the coordinate grows."""

    coordinate: str = reference("coordinate", "The coordinate")
    force: Scalar = measured(
        "{force}",
        "Force or torque, an expression of position, rate, time and all coordinates",
        variables="force",
    )


class DriveSet(SystemSet):
    """A coordinate that moves as a function of time."""

    coordinate: str = reference("coordinate", "The coordinate")
    law: TimeLaw = part("time_law", "How it moves")
    mirrored: bool = Field(default=False, description="Move it the opposite way")


class WheelSet(SystemSet):
    """A wheel on the road; y of its body is the spin axis, the last joint its spin."""

    body: str = reference("body", "The wheel's body, with spins_about: 2")
    radius: Scalar = measured("m", "Unloaded radius", above=0.0)
    stiffness: Scalar = measured("N/m", "Vertical stiffness of the tyre", above=0.0)
    damping: Scalar = measured("N*s/m", "Vertical damping of the tyre", default=zero(), least=0.0)
    crown: Scalar | None = measured(
        "m", "Radius of the tread across a wheel, a torus; else a disc", default=None, above=0.0
    )
    width: Scalar | None = measured(
        "m", "Width of a flat tread, a cylinder; else a disc", default=None, above=0.0
    )
    strips: int = Field(
        default=4, ge=1, le=32, description="Strips of a flat tread on ground that is not one plane"
    )
    tyre: ParameterSet | None = part(
        "tyre", "Tyre law, if the scenario does not choose it", default=None
    )
    axle: Literal["front", "rear"] = Field(default="front", description="Axle it belongs to")
    side: Literal["left", "right"] | None = Field(
        default=None, description="Side of the vehicle it is on"
    )
    slips_at: Literal["centre", "contact"] = Field(
        default="centre",
        description="Point whose side slip the tyre feels; for motorcycles contact",
    )


class OutlineSet(SystemSet):
    """A rectangle seen from above, in the axes of the chassis from its origin."""

    front: Scalar = measured("m", "Front edge along x")
    rear: Scalar = measured("m", "Rear edge along x, negative behind the origin")
    half_width: Scalar = measured("m", "Half of the width", above=0.0)


class PedalSet(SystemSet):
    """A pedal: the switch that says how far it is pressed, and the torque when it is fully."""

    switch: str = Field(description="Switch from 0 to 1, moved by manoeuvres and drivers")
    torque: Scalar = measured(
        "N*m", "Torque at full pedal: of the brakes together, or of the drive", above=0.0
    )


class VehicleSet(SystemSet):
    """What manoeuvres need to know of a road vehicle, and what they may move."""

    chassis: str = reference("body", "The chassis; on a free joint from the ground, 3 2 1")
    rack: str = reference("coordinate", "Driven coordinate of the steering, along +y")
    steering_gain: Scalar = measured("rad/m", "Angle of the wheels to the left over the rack")
    wheelbase: Scalar = measured("m", "Distance of the axles", above=0.0)
    front_distance: Scalar = measured("m", "Front axle to the chassis's origin", above=0.0)
    outline: OutlineSet = Field(description="The body seen from above")
    steering_ratio: Scalar = measured(
        "1",
        "Steering-wheel angle over that of the front wheels; left out, angles are of these",
        default=read_expression(1),
        above=0.0,
    )
    drive: str | None = reference(
        "coordinate",
        "Coordinate that a drive turns, such as that of a propeller shaft; left out, a drive turns "
        "all wheels from the chassis",
        default=None,
    )
    throttle: PedalSet | None = Field(
        default=None, description="Accelerator; left out, tests apply torque to the drive itself"
    )
    brake: PedalSet | None = Field(
        default=None, description="Brake pedal; left out, manoeuvres brake the wheels themselves"
    )


class Sections(SystemSet):
    """What a file and its groups for repetition and mirror images may hold."""

    assemblies: dict[str, AssemblySet] = Field(
        default_factory=dict, description="Other system files used as parts of this one, by name"
    )
    bodies: dict[str, BodySet] = Field(default_factory=dict, description="Bodies by name")
    cuts: dict[str, ParameterSet] = section("cut", "Cuts that close loops, by name")
    constraints: dict[str, ParameterSet] = section("constraint", "Further constraints, by name")
    links: dict[str, ParameterSet] = section(
        "element", "Force elements between two points, by name", kind="link"
    )
    bushings: dict[str, ParameterSet] = section(
        "element", "Springs and dampers in three directions and turns, by name", kind="bushing"
    )
    springs: dict[str, ParameterSet] = section(
        "element", "Springs and dampers on coordinates, by name", kind="spring"
    )
    forces: dict[str, ForceSet] = Field(
        default_factory=dict, description="Forces on coordinates, by name"
    )
    drives: dict[str, DriveSet] = Field(
        default_factory=dict, description="Coordinates driven in time, by name"
    )
    wrenches: dict[str, ParameterSet] = section(
        "element", "Forces and torques on bodies, by name", kind="wrench"
    )
    elements: dict[str, ParameterSet] = section(
        "element", "Elements of any kind of the catalogue, by name"
    )
    sensors: dict[str, ParameterSet] = section("sensor", "Sensors by name")
    shapes: dict[str, ParameterSet] = section(
        "shape", "Shapes of bodies, for animation and pictures, by name"
    )
    wheels: dict[str, WheelSet] = Field(default_factory=dict, description="Wheels by name")
    rail_wheels: dict[str, RailWheelSet] = Field(
        default_factory=dict, description="Wheels on rails by name, those of one body together"
    )
    switches: dict[str, Scalar] = Field(
        default_factory=dict,
        description="Numbers that only events change, by name, and where they start",
        json_schema_extra={"expressions": True},
    )
    events: dict[str, EventSet] = Field(
        default_factory=dict, description="Events and what changes then, by name"
    )
    initial: dict[str, Scalar] = Field(
        default_factory=dict,
        description="Where coordinates start, and rates under the coordinate's name with _rate",
        json_schema_extra={"expressions": True},
    )

    @field_validator("initial", "switches", mode="before")
    @classmethod
    def _read_initial(cls, value: Any) -> Any:
        return read_mapping(value)


class MirrorSet(Sections):
    """A group of parts that is made twice: as written, and as its mirror image."""

    plane: Literal["x", "y", "z"] = Field(description="Axis across the mirror")
    names: dict[str, str] = Field(
        description="Pieces of names and what they become in the mirror image"
    )


class SystemFile(Sections):
    """A multibody system."""

    title: str = Field(description="What the system is, in a sentence")
    description: str = Field(default="", description="More about it: source, purpose")
    parameters: dict[str, Any] = Field(
        default_factory=dict,
        description="Quantities by name: a value, an expression of others, three of these, or "
        "a mapping with 'value' and 'description'; other mappings are groups",
    )
    gravity: Vector = measured(
        "m/s^2",
        "Acceleration of free fall, world axes",
        default=_STANDARD_GRAVITY,
        nature="polar",
    )
    constraint_method: Literal["auto", "partitioning", "multipliers"] = Field(
        default="auto",
        description="How cuts and constraints are treated: by partitioning into independent and "
        "dependent coordinates, with multipliers and projection, or what serves better",
    )
    road: ParameterSet | None = part(
        "road", "Surface under the wheels, if the scenario does not choose it", default=None
    )
    track: ParameterSet | None = part(
        "track", "Railway track, if the scenario does not choose it", default=None
    )
    creep: ParameterSet | None = part(
        "creep", "Creep law of wheels on rails, if the scenario does not choose it", default=None
    )
    rail_contact: ParameterSet | None = part(
        "rail_contact", "How wheels touch rails, if the scenario does not choose it", default=None
    )
    vehicle: VehicleSet | None = Field(
        default=None, description="What manoeuvres need, for road vehicles"
    )
    mirror: tuple[MirrorSet, ...] = Field(
        default=(), description="Groups that are made twice, as written and as mirror image"
    )
    connections: dict[str, ConnectionSet] = Field(
        default_factory=dict,
        description="Bodies and coordinates that a file which uses this one has to give, by name",
    )
    rig: dict[str, tuple[str, ...]] = Field(
        default_factory=dict,
        description="Names by section of the parts that are there only when the file runs by "
        "itself; stand-ins of connections need not be listed",
    )

    @field_validator("track", mode="before")
    @classmethod
    def _track_file(cls, value: Any) -> Any:
        return {"kind": "file", "file": value} if isinstance(value, str) else value
