"""Put assemblies, mirror groups and their images into the sections of a file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import unknown_name
from vehicledyn.base.problems import Place
from vehicledyn.files.system.assemblies.instances import instance
from vehicledyn.files.system.assemblies.mirror import image_name, mirror_image, with_group
from vehicledyn.files.system.assemblies.outside import Outside
from vehicledyn.files.system.assemblies.read import Assembly, Use
from vehicledyn.files.system.assembly_sets import AssemblySet
from vehicledyn.files.system.sets import MirrorSet, Sections, SystemFile
from vehicledyn.multibody.model.ground import GROUND

_SECTIONS = tuple(name for name in Sections.model_fields if name != "assemblies")


@dataclass
class FlatFile:
    """The sections of a file with all that its assemblies and mirror groups make.

    ``origins`` says where in the expanded data an entry comes from, ``inner`` which assembly it
    is of and where in its file; ``problems`` are what is wrong, with places and whether to point
    at the key; ``assemblies`` are those of the file and their mirror images, for people.
    """

    sections: dict[str, dict[str, Any]]
    origins: dict[Place, Place] = field(default_factory=dict)
    inner: dict[Place, tuple[Use, Place]] = field(default_factory=dict)
    problems: list[tuple[Place, str, bool]] = field(default_factory=list)
    assemblies: list[Assembly] = field(default_factory=list)

    def enter(self, use: Use, item: AssemblySet, path: Path, group: Group | None = None) -> None:
        """Enter the parts of an assembly of the file at ``path``, into a mirror group if given."""
        at, sections = ((), self.sections) if group is None else (group.at, group.sections)
        made = instance(use, item, path)
        self.problems += [((*use.place, *place), words, True) for place, words in made.problems]
        for section, entries in made.sections.items():
            for name, entry in entries.items():
                if name not in sections[section]:
                    sections[section][name] = entry
                    self._note(use, (*at, section, name), made.inner.get((section, name)))
                elif section != "initial":
                    words = f"{section}: '{name}' is defined twice"
                    self.problems.append((use.place, words, True))
        for (body, *rest), origin in made.mounts.items():
            self.origins[(*at, "bodies", body, *rest)] = (*use.place, *origin)
        self.assemblies.append(Assembly(use.name, item.file, use.part.file.title, use.part.inner))

    def enter_group(self, group: Group, outside: Outside) -> None:
        """Enter the parts of a mirror group and of its image."""
        image = mirror_image(group.file.model_copy(update=group.sections), outside)
        self.problems += [((*group.at, *place), words, False) for place, words in image.problems]
        for section, entries in self.sections.items():
            made = [(n, e, n) for n, e in group.sections[section].items()]
            made += [(n, e, image.old[section, n]) for n, e in image.sections[section].items()]
            for name, entry, old in made:
                is_start_of_part = section == "initial" and (*group.at, section, old) in self.inner
                if name in entries and not is_start_of_part:
                    words = f"'{name}' is defined twice"
                    self.problems.append(((*group.at, section, old), words, True))
                elif name not in entries:
                    entries[name] = entry
                    self.origins[section, name] = (*group.at, section, old)
        for name in group.file.assemblies:
            words = f"mirror image of {name}, with its parameters"
            self.assemblies.append(Assembly(image_name(name, group.file), "", words))

    def check_connections(self, use: Use, item: AssemblySet) -> None:
        """Note connections of an assembly to bodies and coordinates that are not there."""
        bodies = self.sections["bodies"]
        known = {
            "body": [GROUND, *bodies],
            "coordinate": [c.name for n, b in bodies.items() for c in b.coordinates(n)],
        }
        for key, place in item.connect.items():
            asked = use.part.file.connections.get(key)
            if asked is None and key != GROUND:
                continue
            what = "coordinate" if asked is not None and asked.coordinate else "body"
            if place.body not in known[what]:
                words = unknown_name(what, place.body, known[what])
                self.problems.append(((*use.place, "connect", key), words, False))

    def _note(self, use: Use, place: Place, inner: Place | None) -> None:
        if inner is not None:
            self.inner[place] = (use, inner)


@dataclass
class Group:
    """A mirror group, its place in the expanded data and its sections with its assemblies."""

    file: MirrorSet
    at: Place
    sections: dict[str, dict[str, Any]]


def flatten(file: SystemFile, uses: Sequence[Use], path: Path) -> tuple[SystemFile, FlatFile]:
    """Return a file without assemblies and groups, and where its parts come from.

    Parameters
    ----------
    file
        The file, repetition carried out.
    uses
        Its assemblies, with the files that were read.
    path
        Where it is.
    """
    flat = FlatFile({name: dict(getattr(file, name)) for name in _SECTIONS})
    items: dict[Place, AssemblySet] = {
        ("assemblies", name): item for name, item in file.assemblies.items()
    }
    by_place = {use.place: use for use in uses}
    for place, item in items.items():
        flat.enter(by_place[place], item, path)
    plain = Outside().with_sections(flat.sections)
    groups = []
    for number, written in enumerate(file.mirror):
        sections = {name: dict(getattr(written, name)) for name in _SECTIONS}
        group = Group(written, ("mirror", number), sections)
        for name, item in written.assemblies.items():
            if image_name(name, written) == name:
                words = f"the name has none of the pieces {', '.join(written.names)} of 'names'"
                flat.problems.append(((*group.at, "assemblies", name), words, True))
                continue
            flat.enter(by_place[*group.at, "assemblies", name], item, path, group)
            items[*group.at, "assemblies", name] = item
        groups.append(group)
    for group in groups:
        outside = plain
        for other in groups:
            if other is not group:
                outside = with_group(outside, other.file, other.sections)
        flat.enter_group(group, outside)
    for use in uses:
        if use.place in items:
            flat.check_connections(use, items[use.place])
    return file.model_copy(update={**flat.sections, "mirror": (), "assemblies": {}}), flat
