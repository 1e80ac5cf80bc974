"""Build the drives, springs, forces and wrenches that a system file describes."""

from __future__ import annotations

from functools import partial
from typing import Any

from vehicledyn.files.building.values import Values
from vehicledyn.files.system.places import Place
from vehicledyn.files.system.sensors import motion_of
from vehicledyn.files.system.sets import (
    BushingSet,
    DriveSet,
    ForceSet,
    LinkSet,
    SpringSet,
    WrenchSet,
)
from vehicledyn.multibody.elements.bushing import Bushing
from vehicledyn.multibody.elements.coordinate_forces import CoordinateForce
from vehicledyn.multibody.elements.drives import TimeLaw
from vehicledyn.multibody.elements.external_wrenches import ExternalWrench
from vehicledyn.multibody.elements.point_forces import Attachment, GuidedLink, Link
from vehicledyn.multibody.model.parts import Part, Situation


def force_parts(values: Values) -> list[Part]:
    """Return what drives coordinates and what exerts forces, section by section."""
    file = values.model.file
    return [
        *(_drive(values, n, d) for n, d in file.drives.items()),
        *(_link(values, n, link) for n, link in file.links.items()),
        *(_bushing(values, n, b) for n, b in file.bushings.items()),
        *(_spring(values, n, s) for n, s in file.springs.items()),
        *(_force(values, n, f) for n, f in file.forces.items()),
        *(_wrench(values, n, w) for n, w in file.wrenches.items()),
    ]


def _drive(values: Values, name: str, drive: DriveSet) -> Part:
    sign, law = -1.0 if drive.mirrored else 1.0, drive.law
    return TimeLaw(name, drive.coordinate, lambda t: sign * law.at(t, values.value))


def _link(values: Values, name: str, link: LinkSet) -> Part:
    a, b = _attachment(values, link.a), _attachment(values, link.b)

    def law(length: Any, rate: Any) -> Any:
        return link.law.tension(length, rate, values.value)

    if link.direction is None:
        return Link(name, a, b, law)
    return GuidedLink(name, a, values.value(link.direction), b, law)


def _bushing(values: Values, name: str, bushing: BushingSet) -> Part:
    return Bushing(
        name,
        _attachment(values, bushing.a),
        _attachment(values, bushing.b),
        values.value(bushing.stiffness),
        values.value(bushing.damping),
        values.value(bushing.turning_stiffness),
        values.value(bushing.turning_damping),
        values.value(bushing.preload),
        values.value(bushing.offset),
    )


def _attachment(values: Values, place: Place) -> Attachment:
    return Attachment(place.body, values.value(place.point))


def _spring(values: Values, name: str, spring: SpringSet) -> Part:
    coordinate, sign = spring.coordinate, -1.0 if spring.mirrored else 1.0

    def law(situation: Situation) -> Any:
        position = sign * situation.kinematics.coordinate(coordinate)
        rate = sign * situation.kinematics.rate(coordinate)
        return -sign * spring.law.tension(position, rate, values.value)

    return CoordinateForce(name, coordinate, law, _force_unit_of(values, coordinate))


def _force(values: Values, name: str, force: ForceSet) -> Part:
    def law(situation: Situation) -> Any:
        names = motion_of(situation, list(values.model.coordinates))
        names["position"] = situation.kinematics.coordinate(force.coordinate)
        names["rate"] = situation.kinematics.rate(force.coordinate)
        return values.value(force.force, **names)

    return CoordinateForce(name, force.coordinate, law, _force_unit_of(values, force.coordinate))


def _force_unit_of(values: Values, coordinate: str) -> str:
    return values.model.coordinates[coordinate].force_unit


def _wrench(values: Values, name: str, wrench: WrenchSet) -> Part:
    return ExternalWrench(
        name,
        wrench.body,
        values.value(wrench.point),
        partial(values.at_time, wrench.force),
        partial(values.at_time, wrench.torque),
        follows=wrench.axes == "body",
    )
