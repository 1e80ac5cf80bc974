"""Carry out an assembly: the parts of a file under its name, bound to what it is connected to.

An assembly without a place uses a connected body as it is: its axes are those of the stand-in. One
with ``at`` or ``turns`` gets a body without mass on it, which carries the axes of the file.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import unknown_name
from vehicledyn.base.problems import Place
from vehicledyn.files.expressions.expressions import Expression, origin
from vehicledyn.files.system.assemblies.read import Use, way_between
from vehicledyn.files.system.assemblies.renaming import Renaming
from vehicledyn.files.system.assembly_sets import AssemblySet
from vehicledyn.files.system.joints import Coordinate, FixedTurn
from vehicledyn.files.system.rail_wheels import RailWheelSet
from vehicledyn.files.system.sets import BodySet, Sections, SystemFile, WheelSet
from vehicledyn.files.system.walk import NameUse, PlacedExpression, walk
from vehicledyn.multibody.model.ground import GROUND

_SECTIONS = tuple(name for name in Sections.model_fields if name != "assemblies")


@dataclass
class Instance:
    """The parts of an assembly by section and new name.

    ``inner`` says what each is in the assembly's own file; ``mounts`` where in the entry of the
    assembly the fields of the bodies come from that carry its axes; ``problems`` what is wrong
    with the entry.
    """

    sections: dict[str, dict[str, Any]] = field(default_factory=dict)
    inner: dict[tuple[str, str], Place] = field(default_factory=dict)
    mounts: dict[Place, Place] = field(default_factory=dict)
    problems: list[tuple[Place, str]] = field(default_factory=list)


def instance(use: Use, item: AssemblySet, user: Path) -> Instance:
    """Return the parts of an assembly.

    Parameters
    ----------
    use
        The assembly and its file.
    item
        Its entry in the file that uses it.
    user
        That file.
    """
    made = Instance({section: {} for section in _SECTIONS})
    file, rig = use.part.file, rig_of(use.part.file)
    made.problems += connection_problems(item, file)
    renaming = _renaming(use, item, made)
    for section in _SECTIONS:
        for name, entry in getattr(file, section).items():
            if rig.holds(section, name):
                continue
            new = _start_name(name, renaming) if section == "initial" else renaming.under(name)
            made.sections[section][new] = _adapted(renaming.item(entry), item, use.part.path, user)
            made.inner[section, new] = (section, name)
    return made


@dataclass(frozen=True)
class Rig:
    """What an assembly of a file leaves out: its rig and the stand-ins of its connections."""

    sections: dict[str, frozenset[str]]
    coordinates: frozenset[str]

    def holds(self, section: str, name: str) -> bool:
        """Return whether the entry of a section is left out."""
        if section == "initial":
            names = {name, name.removesuffix("_rate")}
            return bool(names & self.coordinates) or name in self.sections.get(section, ())
        return name in self.sections.get(section, ())

    def holds_parameter(self, name: str) -> bool:
        """Return whether a parameter is left out, or the group it is in."""
        left_out = self.sections.get("parameters", ())
        return any(name == group or name.startswith(f"{group}.") for group in left_out)


def rig_of(file: SystemFile) -> Rig:
    """Return the rig of a file."""
    sections = {section: frozenset(names) for section, names in file.rig.items()}
    stand_ins = {c.body for c in file.connections.values() if c.body not in (None, GROUND)}
    bodies = sections.get("bodies", frozenset()) | frozenset(map(str, stand_ins))
    chains = [c for b in bodies if b in file.bodies for c in file.bodies[b].coordinates(b)]
    return Rig({**sections, "bodies": bodies}, frozenset(c.name for c in chains))


def interface_problems(
    file: SystemFile, coordinates: dict[str, Coordinate], parameters: set[str]
) -> Iterator[tuple[Place, str]]:
    """Yield rigs and connections that name nothing, and what would lack something without the rig.

    ``parameters`` are the names of all of the file.
    """
    known = {section: set(getattr(file, section)) for section in _SECTIONS}
    groups = {n[:k] for n in parameters for k, c in enumerate(n) if c == "."}
    known["parameters"] = parameters | groups
    for section, names in file.rig.items():
        if section not in known:
            yield ("rig", section), unknown_name("section", section, known)
            continue
        for k, name in enumerate(names):
            if name not in known[section]:
                yield ("rig", section, k), unknown_name(section, name, known[section])
    if not file.rig and not file.connections:
        return
    rig = rig_of(file)
    asked = {name for c in file.connections.values() for name in (c.body, c.coordinate)}
    hint = "belongs to the rig, which an assembly leaves out; put this into 'rig' too"
    for name, start in file.initial.items():
        lost = [] if rig.holds("initial", name) else start.names
        for used in filter(rig.holds_parameter, lost):
            yield ("initial", name), f"'{used}' {hint}"
    for item in walk(file, coordinates):
        section, name = str(item.place[0]), str(item.place[1]) if len(item.place) > 1 else ""
        if section not in _SECTIONS or rig.holds(section, name):
            continue
        for used in _lost(item, rig, asked):
            yield item.place, f"'{used}' {hint}, or make a connection of it"


def _lost(item: PlacedExpression | NameUse, rig: Rig, asked: set[str | None]) -> list[str]:
    """Return the names in a part that an assembly would not have: ``asked`` are connections."""
    if isinstance(item, NameUse):
        left_out = {"body": rig.sections["bodies"], "coordinate": rig.coordinates}
        return [n for n in [item.name] if n in left_out.get(item.what, ()) and n not in asked]
    stems = {name: name.removesuffix("_rate") for name in item.expression.names}
    moved = [n for n, stem in stems.items() if stem in rig.coordinates and stem not in asked]
    return moved + [n for n in stems if rig.holds_parameter(n)]


def connection_problems(item: AssemblySet, file: SystemFile) -> Iterator[tuple[Place, str]]:
    """Yield connections that the file of an assembly does not have, and those it lacks."""
    known = {GROUND, *file.connections}
    for name, place in item.connect.items():
        if name not in known:
            yield ("connect", name), unknown_name("connection", name, known)
        elif name != GROUND and file.connections[name].coordinate and place.point is not None:
            yield ("connect", name, "point"), "a coordinate has no point; leave this out"
    for name, connection in file.connections.items():
        if name not in item.connect:
            meaning = f" ({connection.description})" if connection.description else ""
            what = "body" if connection.body else "coordinate"
            words = f"missing: the {what} for the connection '{name}'{meaning}"
            yield ("connect",), words


def _renaming(use: Use, item: AssemblySet, made: Instance) -> Renaming:
    """Return the new names; bodies that carry the axes of the file are entered into ``made``."""
    file, name = use.part.file, use.name
    bodies = {body: f"{name}.{body}" for body in file.bodies}
    coordinates = {c: f"{name}.{c}" for c in use.part.coordinates}
    wanted = {key: c.body for key, c in file.connections.items()} | {GROUND: GROUND}
    for key, stand_in in wanted.items():
        place = item.connect.get(key)
        if stand_in is None:
            if place is not None:
                coordinates[str(file.connections[key].coordinate)] = place.body
            continue
        if place is None and key != GROUND:
            continue
        body = GROUND if place is None else place.body
        point = item.at if place is None or place.point is None else place.point
        if point is None and not item.turns:
            bodies[stand_in] = body
        elif key != GROUND or _stands_on_ground(file):
            bodies[stand_in] = _mount(f"{name}.{key}", body, point, item, made)
            is_point = place is not None and point is place.point
            field = ("connect", key, "point") if is_point else ("at",)
            made.mounts[bodies[stand_in], "at"] = field
            made.mounts[bodies[stand_in], "joints"] = ("turns",)
            made.mounts[bodies[stand_in], "parent"] = ("connect", key)
        else:
            bodies[stand_in] = body
    switches = frozenset(file.switches)
    return Renaming(name, bodies, coordinates, frozenset(use.part.parameters.declared), switches)


def _mount(
    name: str, body: str, point: Expression | None, item: AssemblySet, made: Instance
) -> str:
    """Enter a body that carries the axes of the file; return its name."""
    turns = tuple(FixedTurn(axis=turn.axis, angle=turn.angle) for turn in item.turns)
    mount = BodySet(parent=body, at=origin() if point is None else point)
    made.sections["bodies"][name] = mount.model_copy(update={"joints": turns})
    return name


def _stands_on_ground(file: SystemFile) -> bool:
    """Return whether a part that an assembly keeps names the ground."""
    rig = rig_of(file)
    coordinates = {c.name: c for n, b in file.bodies.items() for c in b.coordinates(n)}
    return any(
        isinstance(item, NameUse)
        and (item.what, item.name) == ("body", GROUND)
        and item.place[0] in _SECTIONS
        and item.place[-1] != "seen_from"
        and not rig.holds(str(item.place[0]), str(item.place[1]))
        for item in walk(file, coordinates)
    )


def _start_name(name: str, renaming: Renaming) -> str:
    return renaming.quantity(name) or renaming.under(name)


def _adapted(part: Any, item: AssemblySet, path: Path, user: Path) -> Any:
    """Return a part with the axle of its assembly, and with files as seen from the user's."""
    if isinstance(part, WheelSet) and item.axle is not None:
        return part.model_copy(update={"axle": item.axle})
    if isinstance(part, RailWheelSet):
        return part.seen_from(way_between(path, user))
    return part
