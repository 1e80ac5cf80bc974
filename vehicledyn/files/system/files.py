"""System files as models of scenarios; nothing else of this package is loaded before one is."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from vehicledyn.base.problems import Problem
from vehicledyn.base.registry import register
from vehicledyn.base.yaml import read_yaml
from vehicledyn.files.scenario.sources import Sources

if TYPE_CHECKING:
    from vehicledyn.files.system.read import SystemModel

KEYS = ("bodies", "elements", "repeat", "mirror", "assemblies")
"""Keys by which a file shows that it is a system."""


@register("model_file", "system")
class SystemFiles:
    """System files, as models of scenarios."""

    @staticmethod
    def is_one(data: Any) -> bool:
        """Return whether a file's data is a system."""
        return isinstance(data, dict) and "model" not in data and any(key in data for key in KEYS)

    @staticmethod
    def read(
        path: Path, given: dict[str, Any], sources: Sources
    ) -> tuple[SystemModel | None, list[Problem]]:
        """Return the system of a file; see :func:`vehicledyn.files.system.read.read_system`."""
        from vehicledyn.files.system.read import read_system

        return read_system(path, given, sources)

    @staticmethod
    def groups(path: Path) -> set[str]:
        """Return the first words of the names of its parameters."""
        data = read_yaml(path).data
        if not isinstance(data, dict):
            return set()
        known = data.get("parameters")
        names = set(known) if isinstance(known, dict) else set()
        if "assemblies" in read_yaml(path).text:
            from vehicledyn.files.system.assemblies.read import raw_assemblies
            from vehicledyn.files.system.assemblies.repeat import expand

            names |= {name for _, name, _ in raw_assemblies(expand(data).data)}
        return names
