"""System files used as parts of others: find and read them, and take over their parameters."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Any

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.problems import Place, Problem, is_count
from vehicledyn.files.expressions.algebra import ExpressionError
from vehicledyn.files.expressions.expressions import read_expression
from vehicledyn.files.expressions.parameters import RESERVED, Parameters, is_long, is_name
from vehicledyn.files.system import changes
from vehicledyn.files.system.assemblies.renaming import Renaming
from vehicledyn.files.system.sets import Sections, SystemFile
from vehicledyn.library import find_entry, library_hint, names_of

MOST_NESTED = 25
"""Assemblies inside each other, at most."""

MOST_PARTS = 5_000
"""Parts that all assemblies of a file make, at most."""


@dataclass(frozen=True)
class Assembly:
    """An assembly of a system, for people: its name, file, title, and assemblies of its own."""

    name: str
    file: str
    title: str
    inner: tuple[Assembly, ...] = ()


@dataclass(frozen=True)
class PartFile:
    """A system file as others use it.

    ``file`` has repetition, mirror images and its own assemblies carried out; ``raw`` is its
    section of parameters with those of its assemblies; ``problem`` makes the problem of a place
    of its expanded data; ``texts`` are its text and those of all files it uses, by path.
    """

    path: Path
    file: SystemFile
    parameters: Parameters
    raw: dict[str, Any]
    coordinates: frozenset[str]
    problem: Callable[..., Problem]
    inner: tuple[Assembly, ...]
    texts: dict[Path, str]

    @property
    def size(self) -> int:
        """How many parts it has."""
        return sum(len(getattr(self.file, section)) for section in Sections.model_fields)


@dataclass(frozen=True)
class Use:
    """An assembly of a file: where it stands in the expanded data, its name and what it is of.

    ``given`` are the places of parameters that the assembly gives, from its own.
    """

    place: Place
    name: str
    part: PartFile
    given: frozenset[Place] = frozenset()


Reader = Callable[[Path, "Library"], tuple[PartFile | None, list[Problem]]]


@dataclass
class Library:
    """The files in use: each is read once; ``chain`` are those being read, outermost first."""

    read: Reader
    chain: tuple[Path, ...] = ()
    known: dict[Path, PartFile | None] = field(default_factory=dict)

    def inside(self, path: Path) -> Library:
        """Return the library for the assemblies of a file."""
        return Library(self.read, (*self.chain, path), self.known)

    def open(self, name: str) -> tuple[PartFile | None, str, list[Problem]]:
        """Return the file of a name, what is wrong with the name, and with the file.

        Names are paths from the last file of the chain, or names of the library. A file that is
        wrong is complained about once.
        """
        user = self.chain[-1]
        entry = None if PurePath(name).suffix else find_entry(name, ("system",))
        if entry is None and not PurePath(name).suffix:
            guess = nearest_name(name, names_of("system"))
            hint = f"; did you mean '{guess}'?" if guess else ""
            return None, f"'{name}' is no YAML file and no system of the library{hint}", []
        path = user.parent / name if entry is None else entry.path
        key = path.resolve()
        if key in [p.resolve() for p in self.chain]:
            first = [p.resolve() for p in self.chain].index(key)
            circle = " -> ".join(p.name for p in (*self.chain[first:], path))
            return None, f"the file would be an assembly of itself: {circle}", []
        if len(self.chain) > MOST_NESTED:
            return None, f"assemblies are nested more than {MOST_NESTED} deep", []
        if key in self.known:
            return self.known[key], "", []
        try:
            part, problems = self.read(path, self.inside(path))
        except InputError as error:
            lines = [line for line in str(error).splitlines() if not is_count(line)]
            self.known[key] = None
            missing = "" if path.exists() else library_hint(path, ("system",))
            return None, missing or "; ".join(lines), []
        self.known[key] = part
        return part, "", problems


def raw_assemblies(data: dict[str, Any]) -> Iterator[tuple[Place, str, dict[str, Any]]]:
    """Yield the assemblies in the expanded data of a file that name a file, with places."""
    groups = data.get("mirror")
    holders: list[tuple[Place, Any]] = [((), data)]
    holders += [
        (("mirror", k), g) for k, g in enumerate(groups if isinstance(groups, list) else ())
    ]
    for at, holder in holders:
        entries = holder.get("assemblies") if isinstance(holder, dict) else None
        for name, entry in entries.items() if isinstance(entries, dict) else ():
            if isinstance(entry, dict) and isinstance(entry.get("file"), str):
                yield (*at, "assemblies", name), name, entry


def name_problem(name: str, data: dict[str, Any]) -> str:
    """Return what is wrong with the name of an assembly, or nothing."""
    if not is_name(name) or name in RESERVED or name == "ground":
        return f"'{name}' cannot be the name of an assembly; use letters, digits and _"
    for section in ("parameters", "bodies"):
        known = data.get(section)
        if isinstance(known, dict) and name in known:
            return f"the name is taken: {section} '{name}' has it"
    return ""


def take_parameters(
    data: dict[str, Any], place: Place, entry: dict[str, Any], part: PartFile
) -> tuple[Use, list[tuple[Place, str]]]:
    """Enter the parameters of an assembly under its name; return its use and what is wrong.

    What the assembly gives is in terms of the file that uses it and takes the place of the
    part's own values.
    """
    name = str(place[-1])
    known = frozenset(part.parameters.declared)
    renaming = Renaming(name, {}, {}, known)
    own = _without(_prefixed(part.raw, renaming), part.file.rig.get("parameters", ()))
    found = changes.Changes(part.parameters, needs_units=True)
    given = entry.get("parameters")
    if isinstance(given, dict):
        changes.merge(own, given, ("parameters",), found)
    holder = data.setdefault("parameters", {})
    if isinstance(holder, dict) and own:
        holder[name] = own
    use = Use(place, name, part, frozenset(p[1:] for p in found.given))
    return use, [((*place, *inner), words) for inner, words in found.problems]


def other_units(use: Use, parameters: Parameters) -> Iterator[tuple[Place, str]]:
    """Yield the parameters to which an assembly gives a quantity of another dimension."""
    before = {n: m for e in use.part.parameters.entries for n, _, m, _ in e.components}
    for entry in parameters.entries:
        for name, _, measure, _ in entry.components:
            head, _, inner = name.partition(".")
            old, place = before.get(inner), tuple(inner.split("."))
            is_given = any(place[: len(g)] == g for g in use.given)
            if head == use.name and old is not None and is_given and not measure.replaces(old):
                words = f"this is in {measure.unit}, the parameter is a quantity in {old.unit}"
                yield (*use.place, "parameters", *place), words


def way_between(part: Path, user: Path) -> str:
    """Return the folder of a part as seen from the folder of the file that uses it."""
    return os.path.relpath(part.parent, user.parent or ".")


def _prefixed(raw: Any, renaming: Renaming) -> Any:
    """Return a section of parameters whose expressions name them with the prefix."""
    if isinstance(raw, dict):
        inside = {"value": _prefixed(raw["value"], renaming)} if is_long(raw) else None
        long = {**raw, **inside} if inside is not None else None
        return long or {key: _prefixed(item, renaming) for key, item in raw.items()}
    if isinstance(raw, list):
        return [_prefixed(item, renaming) for item in raw]
    if isinstance(raw, int | float):
        return raw
    try:
        return renaming.expression(read_expression(raw))
    except ExpressionError:
        return raw


def _without(raw: dict[str, Any], names: tuple[str, ...]) -> dict[str, Any]:
    """Return a section of parameters without some, or groups of them, by dotted name."""
    kept = dict(raw)
    for name in names:
        head, _, rest = name.partition(".")
        if rest and isinstance(kept.get(head), dict):
            kept[head] = _without(kept[head], (rest,))
        else:
            kept.pop(name, None)
    return {key: item for key, item in kept.items() if item != {}}
