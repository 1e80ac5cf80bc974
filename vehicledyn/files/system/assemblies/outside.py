"""What stands outside a mirror group, and which of it is the image of what."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from vehicledyn.files.system.joints import Coordinate

_CONSTRAINTS = ("cuts", "constraints")


@dataclass(frozen=True)
class Outside:
    """Bodies, coordinates, constraints, switches and elements that a mirror group may refer to.

    Where the image of a name stands outside too, as where another group made both sides, it is
    the image; all others are their own images.
    """

    bodies: frozenset[str] = frozenset()
    coordinates: tuple[Coordinate, ...] = ()
    constraints: frozenset[str] = frozenset()
    switches: frozenset[str] = frozenset()
    elements: frozenset[str] = frozenset()

    def with_sections(self, sections: Mapping[str, Mapping[str, Any]]) -> Outside:
        """Return the same with what the sections of a file or group hold."""
        made = [c for name, b in sections["bodies"].items() for c in b.coordinates(name)]
        return Outside(
            self.bodies.union(sections["bodies"]),
            (*self.coordinates, *made),
            self.constraints.union(*(sections[name] for name in _CONSTRAINTS)),
            self.switches.union(sections["switches"]),
            self.elements.union(sections["elements"]),
        )

    def with_images(
        self,
        sections: Mapping[str, Mapping[str, Any]],
        renamed: Callable[[str], str],
        renamed_coordinate: Callable[[str], str],
    ) -> Outside:
        """Return the same with the sections of a group and their images under new names."""
        both = self.with_sections(sections)
        made = [c for name, b in sections["bodies"].items() for c in b.coordinates(name)]
        return Outside(
            both.bodies.union(map(renamed, sections["bodies"])),
            (*both.coordinates, *(replace(c, name=renamed_coordinate(c.name)) for c in made)),
            both.constraints.union(*(map(renamed, sections[name]) for name in _CONSTRAINTS)),
            both.switches.union(map(renamed, sections["switches"])),
            both.elements.union(map(renamed, sections["elements"])),
        )


def images(names: Iterable[str], renamed: Callable[[str], str]) -> dict[str, str]:
    """Return the image of each name among names: itself, where its image is none of them.

    >>> images(["wheel_left", "wheel_right", "left_rail"], lambda n: n.replace("left", "right"))
    {'wheel_left': 'wheel_right', 'wheel_right': 'wheel_right', 'left_rail': 'left_rail'}
    """
    known = dict.fromkeys(names)
    return {name: new if (new := renamed(name)) in known else name for name in known}
