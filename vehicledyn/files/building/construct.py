"""Build the multibody system that a system file describes."""

from __future__ import annotations

from collections import ChainMap
from dataclasses import replace
from typing import Any

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.files.building.force_parts import built, force_parts
from vehicledyn.files.building.rail_parts import rail_wheel_parts, track_frames
from vehicledyn.files.building.road_choice import RoadChoice
from vehicledyn.files.building.values import Values
from vehicledyn.files.building.wheel_parts import spin_of, surface_numbers, wheel_parts
from vehicledyn.files.expressions.dimensions import MEASURES, multiplier_unit
from vehicledyn.files.system.constraints import WrittenConstraint, WrittenRate
from vehicledyn.files.system.cuts import CutSet
from vehicledyn.files.system.events import switch
from vehicledyn.files.system.joints import JointSet
from vehicledyn.files.system.read import SystemModel
from vehicledyn.files.system.sets import BodySet, PedalSet
from vehicledyn.files.system.shapes import ShapeSet
from vehicledyn.multibody.elements.drawn_shapes import DrawnShapes
from vehicledyn.multibody.elements.motion_sensors import Accelerometer, BodySensor
from vehicledyn.multibody.model.bodies import Body, Joint, Turn
from vehicledyn.multibody.model.constraints import Constraint
from vehicledyn.multibody.model.parts import Part
from vehicledyn.multibody.model.system import System
from vehicledyn.road.vehicle import Corner, Pedal, RoadVehicle


def build_system(model: SystemModel, choice: RoadChoice | None = None) -> System:
    """Return the system of a file.

    Every number of the file's ``parameters`` is a symbol of the equations; numbers written
    directly in its parts are constants.

    Raises
    ------
    InputError
        If it has wheels but neither file nor choice give them tyres and a road.
    """
    return _system(Values(model, choice or RoadChoice()))


def build_vehicle(model: SystemModel, choice: RoadChoice) -> RoadVehicle:
    """Return the road vehicle of a file that has a section ``vehicle``, not yet steered.

    Raises
    ------
    InputError
        If it lacks what a vehicle needs.
    """
    values = Values(model, choice)
    system, file, v = _system(values), model.file, model.file.vehicle
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
            spin_of(values, wheel),
            is_front=wheel.axle == "front",
            is_left=wheel.side != "right",
            radius=float(values.number(wheel.radius)),
        )
        for name, wheel in file.wheels.items()
    )
    return RoadVehicle(
        system=system.with_parts(
            BodySensor("body", v.chassis), Accelerometer("accelerometer", v.chassis)
        ),
        chassis=v.chassis,
        rack=v.rack,
        steering_gain=values.value(v.steering_gain),
        wheelbase=values.value(v.wheelbase),
        front_distance=values.value(v.front_distance),
        outline=_corners(
            *map(values.number, (v.outline.front, v.outline.rear, v.outline.half_width))
        ),
        corners=corners,
        free_wheels=choice.free_wheels,
        speed=values.symbols["speed"],
        surface=surface_numbers(values),  # type: ignore[arg-type]
        drive=v.drive or "",
        steering_ratio=values.value(v.steering_ratio),
        throttle=_pedal(values, "throttle", v.throttle),
        brake=_pedal(values, "brake", v.brake),
    )


def _pedal(values: Values, name: str, given: PedalSet | None) -> Pedal | None:
    """Return the pedal that a file describes."""
    if given is None:
        return None
    known = values.model.file.switches
    if given.switch not in known:
        words = unknown_name("switch", given.switch, known)
        raise InputError(f"{values.model.path}: vehicle.{name}.switch: {words}")
    return Pedal(given.switch, values.value(given.torque))


def _corners(front: float, rear: float, side: float) -> tuple[tuple[float, float], ...]:
    return ((front, side), (rear, side), (rear, -side), (front, -side))


def _system(values: Values) -> System:
    """Return the system."""
    file = values.model.file
    parts = [
        *track_frames(values),
        *force_parts(values),
        *wheel_parts(values),
        *rail_wheel_parts(values),
        *(switch(n, float(values.number(start))) for n, start in file.switches.items()),
        *(
            e.part(n, values.value, list(values.model.coordinates), list(file.switches))
            for n, e in file.events.items()
        ),
        *(
            built(values, n, s)
            for section in (file.elements, file.sensors)
            for n, s in section.items()
        ),
    ]
    parts += _drawn(values)
    system = System(
        name=values.model.name,
        table=values.table,
        bodies=tuple(_body(values, n, b) for n, b in file.bodies.items()),
        cuts=tuple(
            cut.cut(n, values.value) for n, cut in file.cuts.items() if isinstance(cut, CutSet)
        ),
        constraints=(*(_constraint(values, n, c) for n, c in file.constraints.items()),),
        parts=tuple(parts),
        gravity=values.value(file.gravity),
        constraint_method=file.constraint_method,
        starts=_starts(values),
    )
    return _with_brought_starts(values, system)


def _starts(values: Values) -> dict[str, Any]:
    """Return the start values that follow from parameters, in symbols."""
    file, given = values.model.file, dict[str, Any]()
    for name, body in file.bodies.items():
        for c in body.coordinates(name):
            given[c.name] = c.start if c.type.has_position else c.start_rate
            given[f"{c.name}_rate"] = c.start_rate
    return {n: values.value(item) for n, item in {**given, **file.initial}.items() if item.names}


def _drawn(values: Values) -> list[Part]:
    """Return the part that draws the shapes of the file, none if it has none."""
    sets = {n: s for n, s in values.model.file.shapes.items() if isinstance(s, ShapeSet)}
    if not sets:
        return []
    shapes = tuple(s.shape(name, values.value) for name, s in sets.items())
    return [DrawnShapes(given=shapes, bodies=frozenset(s.body for s in sets.values()))]


def _with_brought_starts(values: Values, system: System) -> System:
    """Return a system in which coordinates that elements bring start and are driven as said."""
    if not system.brought:
        return system
    file, driven = values.model.file, _driven(values)

    def started(item: Joint | Turn) -> Joint | Turn:
        if not isinstance(item, Joint):
            return item
        place, rate = (file.initial.get(name) for name in (item.name, f"{item.name}_rate"))
        return replace(
            item,
            start=item.start if place is None else float(values.number(place)),
            start_rate=item.start_rate if rate is None else float(values.number(rate)),
            role="driven" if item.name in driven else item.role,
        )

    bodies = tuple(
        body if body.name in file.bodies else replace(body, joints=tuple(map(started, body.joints)))
        for body in system.bodies
    )
    return replace(system, bodies=bodies)


def _constraint(values: Values, name: str, item: ParameterSet) -> Constraint:
    """Return a constraint; that of an expression has the unit of what is zero."""
    made: Constraint = built(values, name, item)
    if not isinstance(item, WrittenConstraint | WrittenRate):
        return made
    is_rate = isinstance(item, WrittenRate)
    kind = "movement" if is_rate else "geometry"
    known = values.variables.of(kind, "m", item.points)
    measure = item.zero.value(ChainMap(known, values.model.parameters.measures), MEASURES)
    unit, force = measure.unit, multiplier_unit(measure, is_rate=is_rate)
    return replace(made, unit=unit, force_unit=force)  # type: ignore[type-var]


def _body(values: Values, name: str, body: BodySet) -> Body:
    inertia = (0.0,) * 6 if body.inertia is None else tuple(map(values.value, body.inertia))
    return Body(
        name,
        body.parent,
        values.value(body.at),
        tuple(item for joint in body.joints for item in _chain(values, name, joint)),
        mass=None if body.mass is None else values.value(body.mass),
        com=values.value(body.com),
        inertia=inertia,
        spins_about=body.spins_about,
        apparent_inertia=body.apparent_inertia,
    )


def _chain(values: Values, body: str, joint: JointSet) -> list[Joint | Turn]:
    turn = joint.turn(values.value)
    if turn is not None:
        return [turn]
    initial = values.model.file.initial
    return [
        Joint(
            c.joint,
            c.name,
            start=float(values.number(c.start if speed else initial.get(c.name, c.start))),
            role="driven" if c.name in _driven(values) else c.role,
            start_rate=float(
                values.number(initial.get(c.name if speed else f"{c.name}_rate", c.start_rate))
            ),
            description=c.description,
            settings={n: values.setting(item) for n, item in c.settings.items()},
            siblings=c.siblings,
            reflected_inertia=(
                0.0 if c.reflected_inertia is None else values.value(c.reflected_inertia)
            ),
        )
        for c in joint.coordinates(body)
        for speed in (not c.type.has_position,)
    ]


def _driven(values: Values) -> set[str]:
    driven = {drive.coordinate for drive in values.model.file.drives.values()}
    if not values.choice.free_wheels:
        driven |= {spin_of(values, wheel) for wheel in values.model.file.wheels.values()}
    if values.model.file.vehicle is not None:
        driven.add(values.model.file.vehicle.rack)
    return driven
