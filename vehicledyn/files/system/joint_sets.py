"""Sets of system files for the joints of the catalogue, made from what their types declare."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial
from typing import Any, get_type_hints

from pydantic import Field, create_model

from vehicledyn.base.registry import announce, find, kinds
from vehicledyn.files.expressions.fields import Scalar, Scalars, measured
from vehicledyn.files.system.joints import ElementsJointSet, JointSet, TypedJointSet, settings_of
from vehicledyn.multibody.joints.joint_type import FAMILY, Element, JointType


def announce_joints() -> None:
    """Enter a set for each type of joint that has none of its own."""
    for kind in set(kinds(FAMILY)) - set(kinds("joint")):
        announce("joint", kind, partial(joint_set, kind))


@cache
def joint_set(kind: str) -> type[JointSet]:
    """Return the set of a type of joint: its settings, and what any joint has."""
    entry = find(FAMILY, kind)
    if entry.elements:
        return _made(entry, ElementsJointSet, _starts(entry))
    hints = get_type_hints(entry)
    declared: dict[str, Any] = {}
    for name, item in settings_of(kind).items():
        unit, text = item.metadata.get("unit"), item.metadata["description"]
        if unit is None:
            declared[name] = (hints[name], Field(description=text))
        else:
            declared[name] = (Scalar, measured(unit, text))
    return _made(entry, TypedJointSet, declared)


def _starts(entry: type[JointType]) -> dict[str, Any]:
    """Return the fields for where a joint with several coordinates starts."""
    positions, speeds = entry.elements[: entry.positions], entry.elements[entry.positions :]
    return {
        "start": _listed(positions, "Positions it starts from"),
        "start_rate": _listed(speeds, "Speeds it starts with, zero if left out"),
    }


def _listed(elements: Sequence[Element], text: str) -> tuple[Any, Any]:
    names = ", ".join(element.name for element in elements)
    return (Scalars | None, measured(elements[0].unit, f"{text}: {names}", default=None))


def _made(entry: type[Any], base: type[JointSet], declared: dict[str, Any]) -> type[JointSet]:
    made: type[JointSet] = create_model(
        entry.__name__,
        __base__=base,
        __doc__=entry.__doc__,
        __module__=entry.__module__,
        **declared,
    )
    return made
