"""Read a system file: every problem of it is told at once, with line and field."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from vehicledyn.base.problems import START, Place, Problem
from vehicledyn.base.units import describe
from vehicledyn.base.validation_messages import UNKNOWN_KEY
from vehicledyn.base.yaml import Document, read_yaml
from vehicledyn.files.expressions.parameters import Parameters, read_parameters
from vehicledyn.files.scenario.referenced_files import beside
from vehicledyn.files.scenario.sources import Sources
from vehicledyn.files.system import assemblies, changes
from vehicledyn.files.system.assemblies import Assembly, Library, PartFile, Use
from vehicledyn.files.system.checks import check
from vehicledyn.files.system.flat import Flat, flatten
from vehicledyn.files.system.instances import interface_problems
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.kinds import load_kinds
from vehicledyn.files.system.laws import TimeLaw
from vehicledyn.files.system.motion import read_motion
from vehicledyn.files.system.repeat import Expansion, expand
from vehicledyn.files.system.sets import Sections, SystemFile
from vehicledyn.files.system.structure_checks import given_twice
from vehicledyn.files.system.track_frame import runs_on_rails


@dataclass(frozen=True)
class SystemModel:
    """A system file that may be built.

    ``file`` has its repetition and mirror images carried out and its bodies parents first;
    ``places`` are the lines of coordinates, parts and bodies by name, without a message;
    ``motion`` are the laws that a scenario gives for inverse dynamics, by coordinate;
    ``text`` is that of the file and, as comments, those of the files it uses as ``assemblies``.
    """

    path: Path
    text: str
    file: SystemFile
    parameters: Parameters
    coordinates: dict[str, Coordinate]
    places: dict[str, Problem] = field(default_factory=dict)
    motion: dict[str, TimeLaw] = field(default_factory=dict)
    assemblies: tuple[Assembly, ...] = ()

    @property
    def name(self) -> str:
        """Name of the system, that of its file."""
        return self.path.stem

    @property
    def has_wheels(self) -> bool:
        """Whether it needs a road and tyres."""
        return bool(self.file.wheels)

    @property
    def has_rail_wheels(self) -> bool:
        """Whether it needs a track, a creep law and a model of contact."""
        return bool(self.file.rail_wheels)

    @property
    def is_vehicle(self) -> bool:
        """Whether it can drive a manoeuvre."""
        return self.file.vehicle is not None

    @property
    def needs_track(self) -> bool:
        """Whether it runs on rails."""
        return runs_on_rails(self.file)

    @property
    def has_track(self) -> bool:
        """Whether it says on which track."""
        return self.file.track is not None

    @property
    def resolved(self) -> dict[str, float]:
        """Parameters in SI by dotted name."""
        return {n: v for e in self.parameters.entries for n, _, _, v in e.components}

    @property
    def units(self) -> dict[str, str]:
        """Unit of each parameter."""
        return self.parameters.units


def read_system(
    path: Path, given: dict[str, Any] | None = None, sources: Sources | None = None
) -> tuple[SystemModel | None, list[Problem]]:
    """Return the system of a file, or None, and all that is wrong with it.

    Parameters
    ----------
    path
        The file.
    given
        What a scenario changes, under "parameters" and "initial".
    sources
        Where the scenario's values came from.

    Raises
    ------
    InputError
        If the file cannot be read or is no YAML.
    """
    load_kinds()
    document = read_yaml(path)
    if not isinstance(document.data, dict):
        return None, _no_mapping(document)
    own = sources or Sources(Document(str(path), ""))
    reading = _Reading(document, given or {}, own, Library(_read_part).inside(path))
    file = reading.read()
    if reading.problems or file is None:
        return None, _once(reading.problems)
    coordinates = _coordinates(file)
    places = reading.places(file)
    laws = reading.motion(coordinates)
    reading.look_beside(file, path.parent)
    if reading.problems:
        return None, _once(reading.problems)
    text, inner = _whole_text(reading.texts, path), tuple(reading.flat.assemblies)
    model = SystemModel(path, text, file, reading.parameters, coordinates, places, laws, inner)
    return model, []


def _read_part(path: Path, library: Library) -> tuple[PartFile | None, list[Problem]]:
    """Return a system file for use as an assembly, or None, and all that is wrong with it."""
    document = read_yaml(path)
    if not isinstance(document.data, dict):
        return None, _no_mapping(document)
    reading = _Reading(document, {}, Sources(Document(str(path), "")), library)
    file = reading.read()
    if file is not None and not reading.problems:
        reading.look_beside(file, path.parent)
    if reading.problems or file is None:
        return None, _once(reading.problems)
    return PartFile(
        path,
        file,
        reading.parameters,
        reading.expansion.data.get("parameters") or {},
        frozenset(_coordinates(file)),
        reading.problem,
        tuple(reading.flat.assemblies),
        reading.texts,
    ), []


def _no_mapping(document: Document) -> list[Problem]:
    words = f"the file holds {describe(document.data)}; a system is a mapping"
    return [*document.problems, Problem(document.name, START, "file", words)]


def _whole_text(texts: dict[Path, str], path: Path) -> str:
    """Return the text of a file, and in comments those of the files it uses."""
    lines = [texts[path]]
    for inner, text in texts.items():
        if inner != path:
            lines += [f"# {inner.name}", *(f"#   {line}".rstrip() for line in text.splitlines())]
    return "\n".join(lines)


class _Reading:
    """The steps of reading one file, and the problems they find."""

    def __init__(
        self, document: Document, given: dict[str, Any], sources: Sources, library: Library
    ) -> None:
        self.own, self.outer, self.given = Sources(document), sources, given
        self.path = library.chain[-1]
        self.texts = {self.path: document.text}
        self.problems = list(document.problems)
        self.expansion: Expansion = expand(document.data)
        self.flat = Flat({})
        self.uses: list[Use] = []
        self._open_assemblies(library)
        for inner, words in given_twice(self.expansion.data.get("initial")):
            self._note([(("initial", *inner), words)], at_key=True)
        self.changes = changes.apply(self.expansion.data, given)
        self.parameters = read_parameters(self.expansion.data.get("parameters"))

    def read(self) -> SystemFile | None:
        """Return the complete file, or None if its parts are not well formed."""
        self._note((self.expansion.place(p), w) for p, w in self.expansion.problems)
        for place, words in self.changes.problems:
            self.problems.append(self.outer.problem(place, words, at_key=True))
        self._tell(self.parameters.problems)
        changed = list(changes.changed_units(self.changes, self.parameters))
        unfit = [p for use in self.uses for p in assemblies.other_units(use, self.parameters)]
        self._tell([*changed, *unfit])
        if self.expansion.overflows or unfit:
            return None
        try:
            file = SystemFile.model_validate(self.expansion.data)
        except ValidationError as error:
            for line in error.errors():
                self._tell_one(line["loc"], line["msg"], at_key=line["type"] == UNKNOWN_KEY)
            return None
        if self.lacks_assemblies:
            return None
        flat, self.flat = flatten(file, self.uses, self.path)
        self.expansion.origins.update(self.flat.origins)
        for place, words, at_key in self.flat.problems:
            self._tell_one(place, words, at_key=at_key)
        if self.flat.problems and self.uses:
            return None
        known = self.changes.before if changed else self.parameters
        coordinates = _coordinates(flat)
        self._tell(check(flat, coordinates, known))
        self._tell(interface_problems(flat, coordinates, self.parameters.declared))
        return _parents_first(flat)

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
            self._tell_one(place, words)

    def motion(self, coordinates: dict[str, Coordinate]) -> dict[str, TimeLaw]:
        """Return the laws of the motion that a scenario prescribes."""
        laws, problems = read_motion(self.given.get("motion"), coordinates, self.parameters)
        self.problems += [self.outer.problem(place, words) for place, words in problems]
        return laws

    def _tell(self, found: Iterable[tuple[Place, str]]) -> None:
        for place, words in found:
            self._tell_one(place, words)

    def _tell_one(self, place: Place, words: str, *, at_key: bool = False) -> None:
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


def _once(problems: list[Problem]) -> list[Problem]:
    """Return the problems, those that repetition tells several times only once."""
    return list({(p.source, p.mark, p.message): p for p in reversed(problems)}.values())[::-1]


def _coordinates(file: SystemFile) -> dict[str, Coordinate]:
    found: dict[str, Coordinate] = {}
    for name, body in file.bodies.items():
        for coordinate in body.coordinates(name):
            found.setdefault(coordinate.name, coordinate)
    return found


def _parents_first(file: SystemFile) -> SystemFile:
    """Return the file with each body after its parent, else in the order it is written."""
    ordered: dict[str, Any] = {}
    waiting = dict(file.bodies)
    while waiting:
        ready = [n for n, b in waiting.items() if b.parent not in waiting]
        for name in ready or list(waiting):
            ordered[name] = waiting.pop(name)
    return file.model_copy(update={"bodies": ordered})
