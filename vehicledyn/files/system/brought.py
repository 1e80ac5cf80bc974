"""Bodies and coordinates that the elements of a system file bring with them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Place
from vehicledyn.files.expressions.algebra import NUMBERS, ExpressionError
from vehicledyn.files.expressions.expressions import Expression, read_expression
from vehicledyn.files.expressions.parameters import Parameters
from vehicledyn.files.system.declared_sets import DeclaredSet, element_of
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.sets import SystemFile
from vehicledyn.multibody.model.bodies import Body, Joint


@dataclass
class Brought:
    """Bodies that elements bring, with numbers for parameters, and what is wrong with elements."""

    bodies: list[Body] = field(default_factory=list)
    problems: list[tuple[Place, str]] = field(default_factory=list)

    @property
    def coordinates(self) -> dict[str, Coordinate]:
        """Coordinates of the bodies by name; the file may drive those that are independent."""
        joints = [j for body in self.bodies for j in body.joints if isinstance(j, Joint)]
        return {
            j.name: Coordinate(
                j.name,
                j.kind,
                "dependent" if j.role == "dependent" else "auto",
                read_expression(j.start),
                read_expression(j.start_rate),
                j.description,
                j.settings,
                j.siblings,
            )
            for j in joints
        }


def brought_by(file: SystemFile, parameters: Parameters) -> Brought:
    """Return what the elements of a file bring, with the present values of all parameters.

    Elements whose expressions have mistakes are left out, which the checks of the file name.
    """

    def value(expression: Expression, **names: Any) -> Any:
        return expression.value({**parameters.values, **names}, NUMBERS)

    found = Brought()
    taken = set(file.bodies)
    for name, item in file.elements.items():
        if not isinstance(item, DeclaredSet) or not hasattr(item.made_from, "added_bodies"):
            continue
        try:
            bodies = element_of(item, name, value, ()).added_bodies()
        except ExpressionError:
            continue
        except InputError as error:
            found.problems.append((("elements", name), str(error)))
            continue
        clash = sorted({body.name for body in bodies} & taken)
        if clash:
            words = f"brings a body '{clash[0]}', a name that is taken"
            found.problems.append((("elements", name), words))
        taken |= {body.name for body in bodies}
        found.bodies += bodies
    return found
