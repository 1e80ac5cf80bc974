"""Read a system file: every problem of it is reported at once, with line and field."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

from vehicledyn.base.problems import START, Problem
from vehicledyn.base.units import describe
from vehicledyn.base.yaml import Document, read_yaml
from vehicledyn.files.expressions.parameters import Parameters
from vehicledyn.files.scenario.sources import Sources
from vehicledyn.files.system.assemblies.read import Assembly, Library, PartFile
from vehicledyn.files.system.brought import brought_by
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.kinds import load_kinds
from vehicledyn.files.system.laws import TimeLaw
from vehicledyn.files.system.reading import Reading, coordinates_of, once
from vehicledyn.files.system.sets import SystemFile
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
    kind: ClassVar[str] = "system"
    usual_tyre: ClassVar[str] = ""
    classes: ClassVar[tuple[type, ...]] = ()

    @property
    def title(self) -> str:
        """What it is, in a sentence."""
        return self.file.title

    @property
    def reference(self) -> str:
        """What a scenario in any folder names it by."""
        return str(self.path.resolve())

    @property
    def described(self) -> dict[str, Any]:
        """What a resolved scenario holds of it."""
        return {"parameters": self.resolved, "system": self.text}

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
    reading = Reading(document, given or {}, own, Library(_read_part).inside(path))
    file = reading.read()
    if reading.problems or file is None:
        return None, once(reading.problems)
    brought = brought_by(file, reading.parameters).coordinates
    coordinates = {**coordinates_of(file), **brought}
    places = reading.places(file)
    laws = reading.motion(coordinates)
    reading.look_beside(file, path.parent)
    if reading.problems:
        return None, once(reading.problems)
    text, inner = _whole_text(reading.texts, path), tuple(reading.flat.assemblies)
    model = SystemModel(path, text, file, reading.parameters, coordinates, places, laws, inner)
    return model, []


def _read_part(path: Path, library: Library) -> tuple[PartFile | None, list[Problem]]:
    """Return a system file for use as an assembly, or None, and all that is wrong with it."""
    document = read_yaml(path)
    if not isinstance(document.data, dict):
        return None, _no_mapping(document)
    if "model" in document.data:
        words = "this is a scenario; an assembly is a system"
        return None, [Problem(document.name, document.keys["model",], "model", words)]
    reading = Reading(document, {}, Sources(Document(str(path), "")), library)
    file = reading.read()
    if file is not None and not reading.problems:
        reading.look_beside(file, path.parent)
    if reading.problems or file is None:
        return None, once(reading.problems)
    brought = brought_by(file, reading.parameters).coordinates
    return PartFile(
        path,
        file,
        reading.parameters,
        reading.expansion.data.get("parameters") or {},
        frozenset(coordinates_of(file)) | frozenset(brought),
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
