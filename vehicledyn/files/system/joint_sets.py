"""Sets of system files for the joints of the catalogue, made from what their types declare."""

from __future__ import annotations

from functools import cache, partial
from typing import Any, get_type_hints

from pydantic import Field, create_model

from vehicledyn.base.registry import announce, find, kinds
from vehicledyn.files.expressions.fields import Scalar, measured
from vehicledyn.files.system.joints import TypedJointSet, settings_of
from vehicledyn.multibody.joints.joint_type import FAMILY


def announce_joints() -> None:
    """Enter a set for each type of joint that has none of its own."""
    for kind in set(kinds(FAMILY)) - set(kinds("joint")):
        announce("joint", kind, partial(joint_set, kind))


@cache
def joint_set(kind: str) -> type[TypedJointSet]:
    """Return the set of a type of joint: its settings, and what any joint has."""
    entry = find(FAMILY, kind)
    hints = get_type_hints(entry)
    declared: dict[str, Any] = {}
    for name, item in settings_of(kind).items():
        unit, text = item.metadata.get("unit"), item.metadata["description"]
        if unit is None:
            declared[name] = (hints[name], Field(description=text))
        else:
            declared[name] = (Scalar, measured(unit, text))
    return create_model(
        entry.__name__, __base__=TypedJointSet, __doc__=entry.__doc__, __module__=__name__,
        **declared,
    )  # fmt: skip
