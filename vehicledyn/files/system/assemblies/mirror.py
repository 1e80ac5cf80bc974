"""Mirror images in system files: one side is written, the other is made.

The mirror lies across axis x, y or z of the world and of all bodies in the position where
every coordinate is zero. With S the matrix that turns that component round, the mirror image of
a place or force is S p, of a torque -S t, of an inertia S I S. The axes of a mirrored body stay
right-handed and all joints keep their kinds and axes. So the mirror image of a slide along or
a turn about another axis than the mirror's differs: slides along the mirror's axis and turns
about the two others have the opposite sign, and with them their starts, fixed turns, drives and
forces; slides along the others and turns about the mirror's axis have the same sign. Bodies
outside the group whose image stands outside too have that for an image, all others are their own
images; their coordinates obey the same rule.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from vehicledyn.base.problems import Place
from vehicledyn.files.expressions.expressions import Expression, named
from vehicledyn.files.expressions.fields import SystemSet, fact
from vehicledyn.files.system.assemblies.outside import Outside, images
from vehicledyn.files.system.declared_sets import DeclaredSet
from vehicledyn.files.system.events import EventSet
from vehicledyn.files.system.joints import JointSet
from vehicledyn.files.system.rail_wheels import RailWheelSet
from vehicledyn.files.system.sets import (
    BodySet,
    DriveSet,
    ForceSet,
    MirrorSet,
    Sections,
    WheelSet,
)
from vehicledyn.files.system.shapes import ShapeSet

AXES = {"x": 1, "y": 2, "z": 3}
_PRODUCTS = ((1, 2), (1, 3), (2, 3))
_OTHER = {"left": "right", "right": "left"}


@dataclass
class Image:
    """The mirror image of a group.

    ``sections`` holds its parts by section and new name, ``old`` the name of the part that each
    is the image of; ``problems`` are names that cannot be made, by place in the group.
    """

    sections: dict[str, dict[str, Any]] = field(default_factory=dict)
    old: dict[tuple[str, str], str] = field(default_factory=dict)
    problems: list[tuple[Place, str]] = field(default_factory=list)


def mirror_image(group: MirrorSet, outside: Outside | None = None) -> Image:
    """Return the mirror image of a group of parts.

    Parameters
    ----------
    group
        The parts.
    outside
        What stands outside the group, other groups and their images too: what acts on it in the
        group, or uses it, acts in the image on its image, in its mirror motion.
    """
    image, outside = Image(), outside or Outside()
    axis, pieces = AXES[group.plane], _Pieces(group.names, frozenset(group.assemblies))
    coordinates = [c for name, body in group.bodies.items() for c in body.coordinates(name)]

    def renewed(names: Iterable[str]) -> dict[str, str]:
        return {name: _replaced(name, pieces) for name in names}

    def beside(names: Iterable[str]) -> dict[str, str]:
        return images(names, lambda name: _replaced(name, pieces))

    renamed = _Names(
        {**beside(outside.bodies), **renewed(group.bodies)},
        {
            **beside(c.name for c in outside.coordinates),
            **{c.name: _new_coordinate(c.name, group.bodies, pieces) for c in coordinates},
        },
        {c.name for c in (*outside.coordinates, *coordinates) if c.is_turned_by_mirror(axis)},
        {**beside(outside.constraints), **renewed((*group.cuts, *group.constraints))},
        {**beside(outside.switches), **renewed(group.switches)},
        {**beside(outside.elements), **renewed(group.elements)},
    )
    for section in (name for name in Sections.model_fields if name != "assemblies"):
        entries: dict[str, Any] = image.sections.setdefault(section, {})
        for name, item in getattr(group, section).items():
            words = renamed.without_image(
                {name: item} if section == "initial" else item, group.plane
            )
            if words:
                image.problems.append(((section, name), words))
            if section == "initial":
                new, value = _mirrored_start(name, item, renamed)
            else:
                new, value = _replaced(name, pieces), _mirrored(item, axis, renamed, pieces)
            if new == name:
                words = f"the name has none of the pieces {', '.join(pieces.texts)} of 'names'"
                image.problems.append(((section, name), words))
            elif new in entries:
                image.problems.append(((section, name), f"its image '{new}' is made twice"))
            elif why := getattr(getattr(item, "made_from", None), "has_no_mirror_image", ""):
                words = f"{why}; write it and its image beside the group"
                image.problems.append(((section, name), words))
            entries[new], image.old[section, new] = value, name
    return image


def with_group(
    outside: Outside, group: MirrorSet, sections: Mapping[str, Mapping[str, Any]]
) -> Outside:
    """Return what stands outside of other groups, with a group of such sections and its image."""
    pieces = _Pieces(group.names, frozenset(group.assemblies))
    return outside.with_images(
        sections,
        lambda name: _replaced(name, pieces),
        lambda name: _new_coordinate(name, sections["bodies"], pieces),
    )


def image_name(name: str, group: MirrorSet) -> str:
    """Return the name of the mirror image of an assembly."""
    return _replaced(name, _Pieces(group.names, frozenset()))


@dataclass(frozen=True)
class _Pieces:
    """Pieces of names and what they become; of the names in ``assemblies`` only the first word."""

    texts: Mapping[str, str]
    assemblies: frozenset[str]


@dataclass(frozen=True)
class _Names:
    """New names of bodies and coordinates, and which coordinates turn round."""

    bodies: Mapping[str, str]
    coordinates: Mapping[str, str]
    turned: set[str]
    constraints: Mapping[str, str] = field(default_factory=dict)
    switches: Mapping[str, str] = field(default_factory=dict)
    elements: Mapping[str, str] = field(default_factory=dict)

    def of(self, what: str, name: str | None) -> str | None:
        """Return the new name of a body, constraint or coordinate; its own where it has none."""
        if name is None or what == "body":
            return name and self.body(name)
        known = self.constraints if what == "constraint" else self.coordinates
        return known.get(name, name)

    def body(self, name: str) -> str:
        """Return the new name of a body, also of one that an element brings."""
        bringing = self._bringing(name)
        if bringing is None or name in self.bodies:
            return self.bodies.get(name, name)
        return self.elements[bringing] + name.removeprefix(bringing)

    def without_image(self, item: Any, plane: str) -> str:
        """Return which name in a part has no image that is known, and what to do; "" for none.

        The mirror motion of the coordinates that an element brings is not known. The axes of its
        frames are mirrored across their y axis, as bodies of the file are where the plane is y.
        """
        for what, name in _mentioned(item):
            bringing = self._bringing(name)
            if bringing is None or self.elements[bringing] == bringing:
                continue
            if what == "body":
                if plane == "y":
                    continue
                words = f"'{name}' belongs to an element, whose frames are mirrored across y only"
            else:
                words = f"the mirror motion of '{name}' of the element '{bringing}' is not known"
            return f"{words}; write both sides, or use 'repeat'"
        return ""

    def _bringing(self, name: str) -> str | None:
        """Return the element that brings a body or coordinate, None where none does."""
        if name in self.bodies or name in self.coordinates:
            return None
        heads = (name[:k] for k, letter in enumerate(name) if letter == ".")
        return next((head for head in heads if head in self.elements), None)

    def expressions(self) -> dict[str, Expression]:
        """Return what stands for each coordinate and rate in the expressions of the image."""
        found = {}
        for old, new in self.coordinates.items():
            sign = -1.0 if old in self.turned else 1.0
            found[old] = named(new, sign=sign)
            found[f"{old}_rate"] = named(f"{new}_rate", sign=sign)
        return found | {old: named(new) for old, new in self.switches.items()}


def _mentioned(item: Any) -> Iterator[tuple[str, str]]:
    """Yield the names of bodies and quantities in a part, each with what it names."""
    if isinstance(item, Expression):
        yield from (("quantity", name) for name in item.names)
    elif isinstance(item, dict):
        for key, entry in item.items():
            yield "quantity", str(key)
            yield from _mentioned(entry)
    elif isinstance(item, tuple):
        for entry in item:
            yield from _mentioned(entry)
    elif isinstance(item, SystemSet):
        for name in type(item).model_fields:
            value, what = getattr(item, name), fact(type(item), name, "names")
            if what is None:
                yield from _mentioned(value)
            elif isinstance(value, str):
                yield str(what), value


def _replaced(name: str, pieces: _Pieces) -> str:
    """Return a name with each piece replaced, once a place; inside an assembly names stay."""
    head, dot, inside = name.partition(".")
    if dot and head in pieces.assemblies:
        return _replaced(head, pieces) + dot + inside
    texts = pieces.texts
    if not texts:
        return name
    pattern = "|".join(re.escape(piece) for piece in sorted(texts, key=len, reverse=True))
    return re.sub(pattern, lambda match: texts[match[0]], name)


def _new_coordinate(name: str, bodies: Iterable[str], pieces: _Pieces) -> str:
    body = next((b for b in bodies if name.startswith(f"{b}.")), None)
    if body is None:
        return _replaced(name, pieces)
    return _replaced(body, pieces) + name[len(body) :]


def _mirrored_start(name: str, value: Expression, renamed: _Names) -> tuple[str, Expression]:
    coordinate = name if name in renamed.coordinates else name.removesuffix("_rate")
    new = renamed.coordinates.get(coordinate)
    if new is None:
        return name, value
    turned = value.negated() if coordinate in renamed.turned else value
    return new + name[len(coordinate) :], turned


def _mirrored(item: Any, axis: int, renamed: _Names, pieces: _Pieces) -> Any:
    """Return the mirror image of a part, of several, or of what is none unchanged."""
    if isinstance(item, dict):
        return {k: _mirrored(entry, axis, renamed, pieces) for k, entry in item.items()}
    if not isinstance(item, SystemSet):
        return item
    fields = type(item).model_fields
    update = {name: _mirrored_field(item, name, axis, renamed, pieces) for name in fields}
    image = item.model_copy(update=update)
    if isinstance(image, BodySet):
        joints = tuple(_mirrored_joint(joint, axis, pieces) for joint in image.joints)
        return image.model_copy(update={"joints": joints})
    if isinstance(image, WheelSet | RailWheelSet) and axis == AXES["y"]:
        return _on_other_side(image)
    if isinstance(item, EventSet):
        return _mirrored_event(item, image, axis, renamed)
    return image.mirrored(axis) if isinstance(image, ShapeSet) else _turned(item, image, renamed)


def _on_other_side(image: WheelSet | RailWheelSet) -> SystemSet:
    """Return what has a side of the vehicle on the other one."""
    if isinstance(image, RailWheelSet):
        return image.model_copy(update={"wheels": tuple(_OTHER[side] for side in image.wheels)})
    return image.model_copy(update={"side": _OTHER[image.side]}) if image.side else image


def _mirrored_event(item: EventSet, image: SystemSet, axis: int, renamed: _Names) -> SystemSet:
    """Return the image of an event: its points lie in the mirror, what it resets turns round."""
    across = "xyz"[axis - 1]
    names = [f"{p}.{across}" for p in item.points]
    names += [f"{p}_velocity.{across}" for p in item.points]
    known = renamed.expressions() | {name: named(name, sign=-1.0) for name in names}
    reset = {}
    for key, value in item.reset.items():
        new = renamed.switches.get(key) or _mirrored_start(key, value, renamed)[0]
        turned = key in renamed.turned or key.removesuffix("_rate") in renamed.turned
        replaced = value.replaced(known)
        reset[new] = replaced.negated() if turned and key not in renamed.switches else replaced
    return image.model_copy(update={"when": item.when.replaced(known), "reset": reset})


def _turned(item: SystemSet, image: SystemSet, renamed: _Names) -> SystemSet:
    """Return the image of what acts on coordinates that change their sign."""
    if isinstance(item, DeclaredSet):
        return _turned_numbers(item, image, renamed)
    if getattr(item, "coordinate", None) not in renamed.turned:
        return image
    if isinstance(image, DriveSet):
        return image.model_copy(update={"mirrored": not image.mirrored})
    if isinstance(image, ForceSet):
        opposite = {name: named(name, sign=-1.0) for name in ("position", "rate")}
        return image.model_copy(update={"force": image.force.replaced(opposite).negated()})
    return image


def _turned_numbers(item: DeclaredSet, image: SystemSet, renamed: _Names) -> SystemSet:
    """Return the image with numbers and flags that change their sign with coordinates."""
    update: dict[str, Any] = {}
    for name in type(item).model_fields:
        others = fact(type(item), name, "turns_with") or ()
        if sum(getattr(item, other) in renamed.turned for other in others) % 2:
            value = getattr(image, name)
            update[name] = not value if isinstance(value, bool) else value.negated()
    return image.model_copy(update=update)


def _mirrored_field(item: SystemSet, name: str, axis: int, renamed: _Names, pieces: _Pieces) -> Any:
    value, what = getattr(item, name), fact(type(item), name, "names")
    if what is not None:
        return renamed.of(what, value)
    nature = fact(type(item), name, "nature")
    if nature == "handed":
        return value.negated() if isinstance(value, Expression) else -value
    if isinstance(value, Expression):
        return _mirrored_expression(value, nature, axis).replaced(renamed.expressions())
    if nature == "side" and axis == AXES["y"]:
        return _OTHER.get(value, value)
    if isinstance(value, tuple) and nature == "inertia":
        return _mirrored_inertia(value, axis)
    return _mirrored(value, axis, renamed, pieces)


def _mirrored_expression(value: Expression, nature: str | None, axis: int) -> Expression:
    if nature == "polar":
        return value.mirrored(axis)
    if nature == "sectional":
        return value.mirrored(AXES["y"], -1.0)
    return value.mirrored(axis, -1.0) if nature == "axial" else value


def _mirrored_inertia(value: tuple[Expression, ...], axis: int) -> tuple[Expression, ...]:
    beside = zip(value[3:], _PRODUCTS, strict=False)
    return (*value[:3], *(e.negated() if axis in pair else e for e, pair in beside))


def _mirrored_joint(joint: JointSet, axis: int, pieces: _Pieces) -> JointSet:
    image, name = joint.mirrored(axis), getattr(joint, "name", "")
    if "." in name:
        return image.model_copy(update={"name": _replaced(name, pieces)})
    return image
