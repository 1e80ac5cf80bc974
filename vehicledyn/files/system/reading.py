"""The steps of reading a system file, each with the problems that it finds."""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from vehicledyn.base.problems import MOST_FOUND, Place, Problem
from vehicledyn.base.validation_messages import UNKNOWN_KEY, words_of
from vehicledyn.base.yaml import Document
from vehicledyn.files.expressions.parameters import read_parameters
from vehicledyn.files.scenario.referenced_files import beside
from vehicledyn.files.scenario.sources import Sources
from vehicledyn.files.system import changes
from vehicledyn.files.system.assemblies import read as assemblies
from vehicledyn.files.system.assemblies.flat import FlatFile, flatten
from vehicledyn.files.system.assemblies.instances import interface_problems
from vehicledyn.files.system.assemblies.read import Library, Use
from vehicledyn.files.system.assemblies.repeat import Expansion, expand
from vehicledyn.files.system.brought import brought_by
from vehicledyn.files.system.checks.references import check
from vehicledyn.files.system.checks.structure import given_twice
from vehicledyn.files.system.declared_sets import with_files_in
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.laws import TimeLaw
from vehicledyn.files.system.motion import read_motion
from vehicledyn.files.system.sets import Sections, SystemFile


class Reading:
    """The steps of reading one file; ``problems`` are those that they find."""

    def __init__(
        self, document: Document, given: dict[str, Any], sources: Sources, library: Library
    ) -> None:
        self.own, self.outer, self.given = Sources(document), sources, given
        self.path = library.chain[-1]
        self.texts = {self.path: document.text}
        self.problems = list(document.problems)
        self.expansion: Expansion = expand(document.data)
        self.flat = FlatFile({})
        self.uses: list[Use] = []
        self._open_assemblies(library)
        for inner, words in given_twice(self.expansion.data.get("initial")):
            self._note([(("initial", *inner), words)], at_key=True)
        self.changes = changes.apply(self.expansion.data, given)
        self.parameters = read_parameters(
            self.expansion.data.get("parameters"), self.changes.before
        )

    def read(self) -> SystemFile | None:
        """Return the complete file, or None if its parts are not well formed."""
        self._note((self.expansion.place(p), w) for p, w in self.expansion.problems)
        for place, words in self.changes.problems:
            self.problems.append(self.outer.problem(place, words, at_key=True))
        self._add(self.parameters.problems)
        changed = list(changes.changed_units(self.changes, self.parameters))
        unfit = [p for use in self.uses for p in assemblies.other_units(use, self.parameters)]
        self._add([*changed, *unfit])
        if self.expansion.overflows or unfit:
            return None
        try:
            file = SystemFile.model_validate(self.expansion.data)
        except ValidationError as error:
            for line in error.errors():
                self._add_one(line["loc"], words_of(line), at_key=line["type"] == UNKNOWN_KEY)
            return None
        if self.lacks_assemblies:
            return None
        file = self._with_folders(file)
        flat, self.flat = flatten(file, self.uses, self.path)
        self.expansion.origins.update(self.flat.origins)
        for place, words, at_key in self.flat.problems:
            self._add_one(place, words, at_key=at_key)
        if self.flat.problems and self.uses:
            return None
        known = self.changes.before if changed else self.parameters
        brought = brought_by(flat, known)
        coordinates = {**brought.coordinates, **coordinates_of(flat)}
        self._add(brought.problems)
        self._add(brought.hanging_problems(flat))
        found = check(flat, coordinates, known, brought.parents, brought.carriers)
        self._add(item for item in found if not brought.is_consequence(item[1]))
        self._add(interface_problems(flat, coordinates, self.parameters.declared))
        return _parents_first(flat)

    def _with_folders(self, file: SystemFile) -> SystemFile:
        """Return the file with the folder before the names of files that elements give."""

        def placed(group: Any) -> Any:
            folder = self.path.parent
            found = {name: with_files_in(item, folder) for name, item in group.elements.items()}
            return group.model_copy(update={"elements": found})

        groups = type(file.mirror)(placed(group) for group in file.mirror)
        return placed(file.model_copy(update={"mirror": groups}))  # type: ignore[no-any-return]

    def _open_assemblies(self, library: Library) -> None:
        """Read the files of the assemblies and take over their parameters."""
        data, found = self.expansion.data, list(assemblies.raw_assemblies(self.expansion.data))
        self.lacks_assemblies = False
        seen: set[str] = set()
        for place, name, entry in found:
            wrong = "" if name in seen else assemblies.name_problem(name, data)
            wrong = f"'{name}' is defined twice" if name in seen else wrong
            seen.add(name)
            part, words, problems = library.open(entry["file"])
            if wrong:
                self._note([(self.expansion.place(place), wrong)], at_key=True)
            if words:
                self._note([(self.expansion.place((*place, "file")), words)])
            self.problems += [self._used_as(place, problem) for problem in problems]
            if part is None or wrong:
                self.lacks_assemblies = True
                continue
            use, unknown = assemblies.take_parameters(data, place, entry, part)
            self._note(((self.expansion.place(p), w) for p, w in unknown), at_key=True)
            self.uses.append(use)
            self.texts |= part.texts
            for given in use.given:
                origin = (*place, "parameters", *given)
                self.expansion.origins["parameters", name, *given] = origin
        if sum(use.part.size for use in self.uses) > assemblies.MOST_PARTS:
            words = f"the assemblies make more than {assemblies.MOST_PARTS} parts"
            self._note([(self.expansion.place(self.uses[-1].place), words)], at_key=True)
            self.lacks_assemblies = True

    def places(self, file: SystemFile) -> dict[str, Problem]:
        """Return where coordinates, parts and bodies stand, in this order of precedence."""
        found: dict[str, Place] = {}
        for name, body in file.bodies.items():
            for number, joint in enumerate(body.joints):
                for coordinate in joint.coordinates(name):
                    found.setdefault(coordinate.name, ("bodies", name, "joints", number))
        sections = [s for s in Sections.model_fields if s not in ("bodies", "initial")]
        for section in (*sections, "bodies"):
            for name in getattr(file, section):
                found.setdefault(name, (section, name))
        rates = {name: ("initial", name) for name in file.initial if name not in found}
        return {name: self.problem(place, "") for name, place in (found | rates).items()}

    def look_beside(self, file: SystemFile, folder: Path) -> None:
        """Note what is wrong with the files that the parts of the file name."""
        for place, words in beside(file, folder):
            self._add_one(place, words)

    def motion(self, coordinates: dict[str, Coordinate]) -> dict[str, TimeLaw]:
        """Return the laws of the motion that a scenario prescribes."""
        laws, problems = read_motion(self.given.get("motion"), coordinates, self.parameters)
        self.problems += [self.outer.problem(place, words) for place, words in problems]
        return laws

    def _add(self, found: Iterable[tuple[Place, str]]) -> None:
        for place, words in found:
            self._add_one(place, words)
            if len(self.problems) >= MOST_FOUND:
                return

    def _add_one(self, place: Place, words: str, *, at_key: bool = False) -> None:
        self.problems.append(self.problem(place, words, at_key=at_key))

    def problem(self, place: Place, words: str, *, at_key: bool = True) -> Problem:
        """Return the problem of a place of the expanded data: of a file or the scenario."""
        if self.changes.gave(place):
            known = self.outer.options.keys() | self.outer.document.keys.keys()
            split = (place[0], *".".join(map(str, place[1:])).split("."))
            nested = place if place in known else split
            return self.outer.problem(nested, words, at_key=at_key)
        for size in range(len(place), 0, -1):
            head, rest = place[:size], place[size:]
            if head in self.flat.inner:
                use, inner = self.flat.inner[head]
                return self._used_as(use.place, use.part.problem((*inner, *rest), words))
            if head in self.flat.origins or head in self.expansion.origins:
                return self.problem((*self.expansion.origins[head], *rest), words, at_key=at_key)
            used = [use for use in self.uses if head == ("parameters", use.name)]
            if used:
                inner_problem = used[0].part.problem(("parameters", *rest), words, at_key=at_key)
                return self._used_as(used[0].place, inner_problem)
        return self.own.problem(place, words, at_key=at_key)

    def _used_as(self, place: Place, problem: Problem) -> Problem:
        """Return the problem of a file with where it is used as an assembly."""
        if not problem.message:
            return problem
        here = self.own.problem(self.expansion.place(place), "", at_key=True)
        line = f":{here.mark.line}" if here.mark else ""
        words = f"{problem.message} (in '{place[-1]}' of {here.source}{line})"
        return problem._replace(message=words)

    def _note(self, found: Iterable[tuple[Place, str]], *, at_key: bool = False) -> None:
        self.problems += [self.own.problem(place, words, at_key=at_key) for place, words in found]


def once(problems: list[Problem]) -> list[Problem]:
    """Return the problems, those that repetition gives several times only once."""
    return list({(p.source, p.mark, p.message): p for p in reversed(problems)}.values())[::-1]


def coordinates_of(file: SystemFile) -> dict[str, Coordinate]:
    """Return the coordinates of all bodies of a file by name."""
    found: dict[str, Coordinate] = {}
    for name, body in file.bodies.items():
        for coordinate in body.coordinates(name):
            found.setdefault(coordinate.name, coordinate)
    return found


def _parents_first(file: SystemFile) -> SystemFile:
    """Return the file with bodies by generations, each in the order it is written."""
    generations: dict[str, float] = {}
    for start in file.bodies:
        line: dict[str, None] = {}
        name = start
        while name in file.bodies and name not in generations and name not in line:
            line[name] = None
            name = file.bodies[name].parent
        generation = math.inf if name in line else generations.get(name, -1.0)
        for descendant in reversed(line):
            generation += 1.0
            generations[descendant] = generation
    ordered = {name: file.bodies[name] for name in sorted(file.bodies, key=generations.__getitem__)}
    return file.model_copy(update={"bodies": ordered})
