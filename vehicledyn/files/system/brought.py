"""Bodies and coordinates that the elements of a system file bring with them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Place
from vehicledyn.files.expressions.algebra import NUMBERS, ExpressionError
from vehicledyn.files.expressions.expressions import Expression, read_expression
from vehicledyn.files.expressions.parameters import Parameters
from vehicledyn.files.system.declared_sets import DeclaredSet, element_of, in_words
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.sets import SystemFile
from vehicledyn.multibody.model.bodies import Body, Joint


@dataclass
class Brought:
    """Bodies that elements bring, with numbers for parameters, and what is wrong with elements."""

    bodies: list[Body] = field(default_factory=list)
    problems: list[tuple[Place, str]] = field(default_factory=list)
    failed: dict[str, DeclaredSet] = field(default_factory=dict)

    @property
    def parents(self) -> dict[str, str]:
        """Parent of each body by name."""
        return {body.name: body.parent for body in self.bodies}

    @property
    def carriers(self) -> set[str]:
        """Bodies that these hang on, and all names that elements with mistakes mention."""
        named = (value for item in self.failed.values() for value in vars(item).values())
        return {*self.parents.values(), *(value for value in named if isinstance(value, str))}

    def is_consequence(self, words: str) -> bool:
        """Return whether a problem is but that an element with mistakes brings nothing."""
        return any(f"'{name}." in words or f"'{name}'" in words for name in self.failed)

    def hanging_problems(self, file: SystemFile) -> Iterator[tuple[Place, str]]:
        """Yield bodies of the file that hang on one that deforms, not on a frame of it."""
        deformable = {body.name for body in self.bodies if body.flexibility is not None}
        for name, item in file.bodies.items():
            if item.parent in deformable:
                words = f"'{item.parent}' deforms; hang it on a frame, such as '{item.parent}.tip'"
                yield ("bodies", name, "parent"), words

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


def _field_of(item: DeclaredSet, words: str) -> tuple[Place, str]:
    """Return the field that a message begins with, if it does, and the rest of the message."""
    head, _, rest = words.partition(": ")
    place = tuple(head.split("."))
    return (place, rest) if place[0] in type(item).model_fields else ((), words)


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
        except (InputError, OverflowError) as error:
            head = f"{item.kind} '{name}': "
            own = in_words(error).removeprefix(head)
            field, words = _field_of(item, own)
            words = words if field else f"{head}{own}"
            found.problems.append((("elements", name, *field), words))
            found.failed[name] = item
            continue
        clash = sorted({body.name for body in bodies} & taken)
        if clash:
            words = f"brings a body '{clash[0]}', a name that is taken"
            found.problems.append((("elements", name), words))
        taken |= {body.name for body in bodies}
        found.bodies += bodies
    return found
