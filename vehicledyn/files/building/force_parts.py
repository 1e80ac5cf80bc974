"""Build the drives, springs, forces and wrenches that a system file describes."""

from __future__ import annotations

from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.files.building.values import Values
from vehicledyn.files.system.declared_sets import DeclaredSet, element_of
from vehicledyn.files.system.places import Place
from vehicledyn.files.system.sensors import motion_of
from vehicledyn.files.system.sets import (
    DriveSet,
    ForceSet,
    LinkSet,
    SpringSet,
)
from vehicledyn.multibody.elements.coordinate_forces import CoordinateForce
from vehicledyn.multibody.elements.drives import TimeLaw
from vehicledyn.multibody.elements.point_forces import Attachment, GuidedLink, Link
from vehicledyn.multibody.model.parts import Part, Situation


def force_parts(values: Values) -> list[Part]:
    """Return what drives coordinates and what exerts forces, section by section."""
    file = values.model.file
    return [
        *(_drive(values, n, d) for n, d in file.drives.items()),
        *(_link(values, n, link) for n, link in file.links.items()),
        *(built(values, n, b) for n, b in file.bushings.items()),
        *(_spring(values, n, s) for n, s in file.springs.items()),
        *(_force(values, n, f) for n, f in file.forces.items()),
        *(built(values, n, w) for n, w in file.wrenches.items()),
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


def built(values: Values, name: str, item: Any) -> Any:
    """Return the element, sensor or constraint that an entry of a section describes.

    Raises
    ------
    InputError
        If its class refuses the values.
    """
    coordinates = list(values.model.coordinates)
    if not isinstance(item, DeclaredSet):
        return item.element(name, values.value, coordinates)
    try:
        return element_of(item, name, values.value, coordinates)
    except InputError as error:
        raise InputError(f"{values.model.path}: {error}") from None
