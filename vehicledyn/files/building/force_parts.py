"""Build the drives, springs, forces and wrenches that a system file describes."""

from __future__ import annotations

from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.files.building.values import Values
from vehicledyn.files.system.declared_sets import DeclaredSet, element_of
from vehicledyn.files.system.sensors import motion_of
from vehicledyn.files.system.sets import (
    DriveSet,
    ForceSet,
)
from vehicledyn.multibody.elements.coordinate_forces import CoordinateForce
from vehicledyn.multibody.elements.drives import TimeLaw
from vehicledyn.multibody.model.parts import Part, Situation


def force_parts(values: Values) -> list[Part]:
    """Return what drives coordinates and what exerts forces, section by section."""
    file = values.model.file
    return [
        *(_drive(values, n, d) for n, d in file.drives.items()),
        *(built(values, n, link) for n, link in file.links.items()),
        *(built(values, n, b) for n, b in file.bushings.items()),
        *(built(values, n, s) for n, s in file.springs.items()),
        *(_force(values, n, f) for n, f in file.forces.items()),
        *(built(values, n, w) for n, w in file.wrenches.items()),
    ]


def _drive(values: Values, name: str, drive: DriveSet) -> Part:
    sign, law = -1.0 if drive.mirrored else 1.0, drive.law
    return TimeLaw(name, drive.coordinate, lambda t: sign * law.at(t, values.value))


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
