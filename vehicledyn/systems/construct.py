"""Build the multibody system that a system file describes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.multibody.bushing import Bushing
from vehicledyn.multibody.constraints import Constraint
from vehicledyn.multibody.coordinate_forces import CoordinateForce
from vehicledyn.multibody.drives import ConstantRate, TimeLaw
from vehicledyn.multibody.external import ExternalWrench
from vehicledyn.multibody.links import Attachment, GuidedLink, Link
from vehicledyn.multibody.parts import Part, Situation
from vehicledyn.multibody.sensors import Accelerometer, BodySensor
from vehicledyn.multibody.system import Body, Joint, System, Turn
from vehicledyn.rail.rail_contact import RailWheels
from vehicledyn.rail.track import Track
from vehicledyn.rail.track_follower import TrackFollower
from vehicledyn.rail.track_set import TrackChoice
from vehicledyn.road.surface import RoadSurface
from vehicledyn.road.vehicle import Corner, RoadVehicle
from vehicledyn.road.wheel import RoadWheel
from vehicledyn.symbolic.parameters import ParameterTable
from vehicledyn.systems.algebra import NUMBERS, SYMBOLS
from vehicledyn.systems.checks import variables
from vehicledyn.systems.constraints import ConstraintSet, WrittenConstraint, WrittenRate
from vehicledyn.systems.cuts import CutSet
from vehicledyn.systems.dimensions import MEASURES, multiplier_unit
from vehicledyn.systems.events import switch
from vehicledyn.systems.expressions import Expression
from vehicledyn.systems.joints import JointSet
from vehicledyn.systems.parameters import Entry
from vehicledyn.systems.places import Place
from vehicledyn.systems.rail_wheels import missing_choices
from vehicledyn.systems.read import SystemModel
from vehicledyn.systems.sensors import SensorSet, motion_of
from vehicledyn.systems.sets import (
    BodySet,
    BushingSet,
    DriveSet,
    ForceSet,
    LinkSet,
    SpringSet,
    WheelSet,
    WrenchSet,
)
from vehicledyn.systems.track_frame import TrackFrameSet

if TYPE_CHECKING:
    from vehicledyn.rail.rigid_contact import RigidRailWheels


@dataclass(frozen=True)
class RoadChoice:
    """What a scenario chooses for the wheels of a system; None leaves it to the file.

    ``speed`` is the forward speed at the start [m/s], ``track`` the railway track of the
    scenario, its files read.
    """

    front_tyre: ParameterSet | None = None
    rear_tyre: ParameterSet | None = None
    surface: ParameterSet | None = None
    free_wheels: bool = True
    speed: float = 0.0
    contact: str = "disc"
    relaxation: ParameterSet | None = None
    track: Track | None = None
    creep: ParameterSet | None = None
    rail_contact: ParameterSet | None = None


def build_system(model: SystemModel, choice: RoadChoice | None = None) -> System:
    """Return the system of a file.

    Every number of the file's ``parameters`` is a symbol of the equations; numbers written
    directly in its parts are constants.

    Raises
    ------
    InputError
        If it has wheels but neither file nor choice give them tyres and a road.
    """
    return _Builder(model, choice or RoadChoice()).system()


def build_vehicle(model: SystemModel, choice: RoadChoice) -> RoadVehicle:
    """Return the road vehicle of a file that has a section ``vehicle``, not yet steered.

    Raises
    ------
    InputError
        If it lacks what a vehicle needs.
    """
    builder = _Builder(model, choice)
    system, file, v = builder.system(), model.file, model.file.vehicle
    if v is None:
        raise InputError(f"{model.path}: vehicle: missing: what manoeuvres need of it")
    needed = {f"{v.chassis}.{name}" for name in ("x", "y", "z", "yaw", "pitch", "roll")}
    missing = sorted(needed - set(model.coordinates))
    if missing:
        words = f"the chassis has no coordinate {', '.join(missing)}; give it the joint 'free'"
        raise InputError(f"{model.path}: vehicle.chassis: {words}")
    corners = tuple(
        Corner(
            name,
            wheel.body,
            builder.spin(wheel),
            is_front=wheel.axle == "front",
            is_left=wheel.side != "right",
            radius=float(builder.number(wheel.radius)),
        )
        for name, wheel in file.wheels.items()
    )
    return RoadVehicle(
        system=system.with_parts(
            BodySensor("body", v.chassis), Accelerometer("accelerometer", v.chassis)
        ),
        chassis=v.chassis,
        rack=v.rack,
        steering_gain=builder.value(v.steering_gain),
        wheelbase=builder.value(v.wheelbase),
        front_distance=builder.value(v.front_distance),
        outline=_corners(
            *map(builder.number, (v.outline.front, v.outline.rear, v.outline.half_width))
        ),
        corners=corners,
        free_wheels=choice.free_wheels,
        speed=builder.symbols["speed"],
        surface=builder.surface_numbers(),  # type: ignore[arg-type]
    )


def _corners(front: float, rear: float, side: float) -> tuple[tuple[float, float], ...]:
    return ((front, side), (rear, side), (rear, -side), (front, -side))


class _Builder:
    """Turns the parts of one file into those of a system."""

    def __init__(self, model: SystemModel, choice: RoadChoice) -> None:
        self.model, self.choice = model, choice
        self.table = ParameterTable()
        self.numbers = model.parameters.values
        self.symbols: dict[str, Any] = {}
        self._track = choice.track
        for entry in model.parameters.entries:
            self.symbols[entry.name] = self._enter(entry)

    def value(self, expression: Expression, **names: Any) -> Any:
        """Return what an expression is worth, in symbols; ``names`` are further quantities."""
        return expression.value({**self.symbols, **names}, SYMBOLS)

    def number(self, expression: Expression) -> Any:
        """Return what an expression is worth with the present parameters."""
        return expression.value(self.numbers, NUMBERS)

    def system(self) -> System:
        """Return the system."""
        file = self.model.file
        parts = [
            *self._track_frames(),
            *(self._drive(n, d) for n, d in file.drives.items()),
            *(self._link(n, link) for n, link in file.links.items()),
            *(self._bushing(n, b) for n, b in file.bushings.items()),
            *(self._spring(n, s) for n, s in file.springs.items()),
            *(self._force(n, f) for n, f in file.forces.items()),
            *(self._wrench(n, w) for n, w in file.wrenches.items()),
            *self._wheels(),
            *self._rail_wheels(),
            *(switch(n, float(self.number(start))) for n, start in file.switches.items()),
            *(
                e.part(n, self.value, list(self.model.coordinates), list(file.switches))
                for n, e in file.events.items()
            ),
            *(
                s.sensor(n, self.value, list(self.model.coordinates))
                for n, s in file.sensors.items()
                if isinstance(s, SensorSet)
            ),
        ]
        guided = self._guided(parts)
        return System(
            name=self.model.name,
            table=self.table,
            bodies=(
                *(self._body(n, b) for n, b in file.bodies.items()),
                *(body for part in guided for body in part.bodies()),
            ),
            cuts=tuple(
                cut.cut(n, self.value) for n, cut in file.cuts.items() if isinstance(cut, CutSet)
            ),
            constraints=(
                *(
                    self._constraint(n, c)
                    for n, c in file.constraints.items()
                    if isinstance(c, ConstraintSet)
                ),
                *(constraint for part in guided for constraint in part.constraints()),
            ),
            parts=tuple(parts),
            gravity=self.value(file.gravity),
        )

    def _guided(self, parts: list[Part]) -> list[RigidRailWheels]:
        """Return the parts that bring bodies and constraints of their own."""
        if not self.model.file.rail_wheels:
            return []
        from vehicledyn.rail.rigid_contact import RigidRailWheels

        return [part for part in parts if isinstance(part, RigidRailWheels)]

    def _constraint(self, name: str, item: ConstraintSet) -> Constraint:
        """Return a constraint; that of an expression has the unit of what is zero."""
        made = item.constraint(name, self.value, list(self.model.coordinates))
        if not isinstance(item, WrittenConstraint | WrittenRate):
            return made
        is_rate = isinstance(item, WrittenRate)
        known = variables(
            "movement" if is_rate else "geometry", "m", self.model.coordinates, item.points
        )
        measure = item.zero.value({**self.model.parameters.measures, **known}, MEASURES)
        unit, force = measure.unit, multiplier_unit(measure, is_rate=is_rate)
        return replace(made, unit=unit, force_unit=force)  # type: ignore[type-var]

    def spin(self, wheel: WheelSet) -> str:
        """Return the coordinate that a wheel spins by."""
        coordinates = self.model.file.bodies[wheel.body].coordinates(wheel.body)
        if not coordinates or not coordinates[-1].is_rotation:
            raise InputError(
                f"{self.model.path}: bodies.{wheel.body}: the last joint of a wheel must be R2"
            )
        return coordinates[-1].name

    def surface_numbers(self) -> ParameterSet | None:
        """Return the road with numbers."""
        if self.choice.surface is not None:
            return self.choice.surface
        road = self.model.file.road
        return road.placed(self.model.path.parent) if isinstance(road, RoadSurface) else road

    def track(self) -> Track:
        """Return the railway track, the scenario's before that of the file.

        Raises
        ------
        InputError
            If neither has one.
        """
        if self._track is None and isinstance(self.model.file.track, TrackChoice):
            self._track = self.model.file.track.track(self.model.path.parent)
        if self._track is not None:
            return self._track
        raise InputError(
            f"{self.model.path}: track: missing: the system runs on rails, give it a track, or "
            "give one to the scenario"
        )

    def _enter(self, entry: Entry) -> Any:
        """Return the symbols of a parameter; what is calculated from others stays so."""
        entered = [
            self.table.add(name, number, measure.unit, entry.description)
            if expression.root.quantity is not None
            else None
            for name, expression, measure, number in entry.components
        ]
        if all(symbol is None for symbol in entered):
            return self.value(entry.expression)
        if len(entered) == 1:
            return entered[0]
        return tuple(
            self.value(expression) if symbol is None else symbol
            for symbol, (_, expression, _, _) in zip(entered, entry.components, strict=True)
        )

    def _body(self, name: str, body: BodySet) -> Body:
        inertia = (0.0,) * 6 if body.inertia is None else tuple(map(self.value, body.inertia))
        return Body(
            name,
            body.parent,
            self.value(body.at),
            tuple(item for joint in body.joints for item in self._chain(name, joint)),
            mass=None if body.mass is None else self.value(body.mass),
            com=self.value(body.com),
            inertia=inertia,
            spins_about=body.spins_about,
            apparent_inertia=body.apparent_inertia,
        )

    def _chain(self, body: str, joint: JointSet) -> list[Joint | Turn]:
        turn = joint.turn(self.value)
        if turn is not None:
            return [turn]
        initial = self.model.file.initial
        return [
            Joint(
                c.joint,
                c.name,
                start=float(self.number(initial.get(c.name, c.start))),
                role="driven" if c.name in self._driven() else c.role,
                start_rate=float(self.number(initial.get(f"{c.name}_rate", c.start_rate))),
                description=c.description,
            )
            for c in joint.coordinates(body)
        ]

    def _driven(self) -> set[str]:
        driven = {drive.coordinate for drive in self.model.file.drives.values()}
        if not self.choice.free_wheels:
            driven |= {self.spin(wheel) for wheel in self.model.file.wheels.values()}
        if self.model.file.vehicle is not None:
            driven.add(self.model.file.vehicle.rack)
        return driven

    def _track_frames(self) -> list[Part]:
        return [
            TrackFollower(
                f"{name}.track_frame",
                tuple(c.name for c in joint.coordinates(name)),
                name,
                self.track(),
                partial(self._at_time, joint.position),
            )
            for name, body in self.model.file.bodies.items()
            for joint in body.joints
            if isinstance(joint, TrackFrameSet)
        ]

    def _guide(self, name: str) -> Callable[[Any], Any] | None:
        """Return the arc coordinate of a body that a track frame carries, but for small motions."""
        ahead: Any = 0.0
        while name in self.model.file.bodies:
            body = self.model.file.bodies[name]
            first = body.joints[0] if body.joints else None
            if isinstance(first, TrackFrameSet):
                return partial(self._ahead_of, first.position, ahead)
            name, ahead = body.parent, ahead + self.value(body.at)[0]
        return None

    def _first_place(self, name: str) -> float:
        """Return how far along x a body starts before anything turns it [m]."""
        file, place = self.model.file, 0.0
        laws = {drive.coordinate: drive.law for drive in file.drives.values()}
        while name in file.bodies:
            body = file.bodies[name]
            place += float(self.number(body.at)[0])
            slides = [c for c in body.coordinates(name) if c.joint == "T1"]
            for slide in slides:
                law = laws.get(slide.name)
                given = file.initial.get(slide.name, slide.start)
                place += float(self.number(given) if law is None else law.at(0.0, self._at_zero))
            name = body.parent
        return place

    def _at_zero(self, expression: Expression, **names: Any) -> Any:
        return expression.value({**self.numbers, **names}, NUMBERS)

    def _ahead_of(self, position: Expression, ahead: Any, time: Any) -> Any:
        return self._at_time(position, time) + ahead

    def _at_time(self, expression: Expression, time: Any) -> Any:
        return self.value(expression, time=time)

    def _drive(self, name: str, drive: DriveSet) -> Part:
        sign, law = -1.0 if drive.mirrored else 1.0, drive.law
        return TimeLaw(name, drive.coordinate, lambda t: sign * law.at(t, self.value))

    def _link(self, name: str, link: LinkSet) -> Part:
        a, b = self._attachment(link.a), self._attachment(link.b)

        def law(length: Any, rate: Any) -> Any:
            return link.law.tension(length, rate, self.value)

        if link.direction is None:
            return Link(name, a, b, law)
        return GuidedLink(name, a, self.value(link.direction), b, law)

    def _bushing(self, name: str, bushing: BushingSet) -> Part:
        return Bushing(
            name,
            self._attachment(bushing.a),
            self._attachment(bushing.b),
            self.value(bushing.stiffness),
            self.value(bushing.damping),
            self.value(bushing.turning_stiffness),
            self.value(bushing.turning_damping),
            self.value(bushing.preload),
            self.value(bushing.offset),
        )

    def _attachment(self, place: Place) -> Attachment:
        return Attachment(place.body, self.value(place.point))

    def _spring(self, name: str, spring: SpringSet) -> Part:
        coordinate, sign = spring.coordinate, -1.0 if spring.mirrored else 1.0

        def law(situation: Situation) -> Any:
            position = sign * situation.kinematics.coordinate(coordinate)
            rate = sign * situation.kinematics.rate(coordinate)
            return -sign * spring.law.tension(position, rate, self.value)

        return CoordinateForce(name, coordinate, law, self._force_unit(coordinate))

    def _force(self, name: str, force: ForceSet) -> Part:
        def law(situation: Situation) -> Any:
            names = motion_of(situation, list(self.model.coordinates))
            names["position"] = situation.kinematics.coordinate(force.coordinate)
            names["rate"] = situation.kinematics.rate(force.coordinate)
            return self.value(force.force, **names)

        return CoordinateForce(name, force.coordinate, law, self._force_unit(force.coordinate))

    def _force_unit(self, coordinate: str) -> str:
        return self.model.coordinates[coordinate].force_unit

    def _wrench(self, name: str, wrench: WrenchSet) -> Part:
        def at(expression: Expression) -> Callable[[Any], Any]:
            return lambda time: self.value(expression, time=time)

        return ExternalWrench(
            name,
            wrench.body,
            self.value(wrench.point),
            at(wrench.force),
            at(wrench.torque),
            follows=wrench.axes == "body",
        )

    def _wheels(self) -> list[Part]:
        wheels = self.model.file.wheels
        if not wheels:
            return []
        surface = self.surface_numbers()
        chosen = {"front": self.choice.front_tyre, "rear": self.choice.rear_tyre}
        self._need_road(surface, chosen)
        speed = self.table.add("speed", self.choice.speed, "m/s", "Forward speed at the start")
        self.symbols["speed"] = speed
        road = None if surface is None else self.table.add_set("road", surface)
        tyres = {
            axle: None if tyre is None else self.table.add_set(f"tyres.{axle}", tyre)
            for axle, tyre in chosen.items()
        }
        relaxation = self.choice.relaxation
        relaxed = None if relaxation is None else self.table.add_set("relaxation", relaxation)
        parts: list[Part] = []
        for name, wheel in wheels.items():
            own = wheel.tyre
            tyre = tyres[wheel.axle]
            if tyre is None and own is not None:
                tyre = self.table.add_set(f"{name}.tyre", own)
            part = RoadWheel(
                name,
                body=wheel.body,
                spin=self.spin(wheel),
                tyre=tyre,  # type: ignore[arg-type]
                surface=road,  # type: ignore[arg-type]
                radius=self.value(wheel.radius),
                stiffness=self.value(wheel.stiffness),
                damping=self.value(wheel.damping),
                contact=self.choice.contact,
                relaxation=relaxed,  # type: ignore[arg-type]
            )
            parts.append(part)
            if not self.choice.free_wheels:
                rate = speed / self.value(wheel.radius)
                parts.append(ConstantRate(f"{name}.prescribed_spin", part.spin, rate))
        return parts

    def _rail_wheels(self) -> list[Part]:
        file, path = self.model.file, self.model.path
        if not file.rail_wheels:
            return []
        creep = self.choice.creep or file.creep
        contact = self.choice.rail_contact or file.rail_contact
        problems = missing_choices(creep, contact)
        if problems:
            raise InputError("\n".join(f"{path}: {problem}" for problem in problems))
        track = self.track()
        law = self.table.add_set("creep", creep)  # type: ignore[type-var]
        entered = contact.entered(self.table)  # type: ignore[union-attr]
        parts: list[Part] = []
        for name, item in file.rail_wheels.items():
            try:
                tape_circle = float(self.number(item.tape_circle))
                item.check_gauge(tape_circle, track.gauge)
                wheels = RailWheels(
                    name,
                    item.body,
                    item.wheels,
                    item.open(path.parent),
                    radius=self.value(item.radius),
                    tape_circle=self.value(item.tape_circle),
                    radius_number=float(self.number(item.radius)),
                    track=track,
                    creep=law,  # type: ignore[arg-type]
                    guide=self._guide(item.body),
                    first_place=self._first_place(item.body),
                )
                wheels.check_fit(tape_circle)
                parts.append(entered.part(wheels))
            except InputError as error:
                raise InputError(f"{path}: rail_wheels.{name}: {error}") from None
        return parts

    def _need_road(
        self, surface: ParameterSet | None, chosen: dict[str, ParameterSet | None]
    ) -> None:
        wheels = self.model.file.wheels
        problems = []
        if surface is None:
            problems.append("road: missing: the system has wheels, give it a road")
        problems += [
            f"wheels.{name}.tyre: missing: give the wheel a tyre, or the scenario 'tyres'"
            for name, wheel in wheels.items()
            if wheel.tyre is None and chosen[wheel.axle] is None
        ]
        if problems:
            raise InputError("\n".join(f"{self.model.path}: {problem}" for problem in problems))
