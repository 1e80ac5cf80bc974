"""Bodies and coordinates that the elements of a system file bring with them."""

from __future__ import annotations

from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.files.expressions.algebra import NUMBERS, ExpressionError
from vehicledyn.files.expressions.expressions import Expression, read_expression
from vehicledyn.files.expressions.parameters import Parameters
from vehicledyn.files.system.declared_sets import DeclaredSet, element_of
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.sets import SystemFile
from vehicledyn.multibody.model.bodies import Body, Joint


def brought_bodies(file: SystemFile, parameters: Parameters) -> list[Body]:
    """Return the bodies that elements bring, with the present values of all parameters.

    Those of elements with mistakes are left out, which the checks of the file name.
    """

    def value(expression: Expression, **names: Any) -> Any:
        return expression.value({**parameters.values, **names}, NUMBERS)

    found: list[Body] = []
    for name, item in file.elements.items():
        if isinstance(item, DeclaredSet) and hasattr(item.made_from, "added_bodies"):
            try:
                found += element_of(item, name, value, ()).added_bodies()
            except (ExpressionError, InputError):
                continue
    return found


def brought_coordinates(bodies: list[Body]) -> dict[str, Coordinate]:
    """Return the coordinates of bodies by name."""
    joints = [j for body in bodies for j in body.joints if isinstance(j, Joint)]
    return {
        j.name: Coordinate(
            j.name,
            j.kind,
            j.role,  # type: ignore[arg-type]
            read_expression(j.start),
            read_expression(j.start_rate),
            j.description,
            j.settings,
            j.siblings,
        )
        for j in joints
    }
