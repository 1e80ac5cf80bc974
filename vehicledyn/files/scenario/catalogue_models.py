"""Vehicles written in Python, entries of the catalogue, as the models of scenarios."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from vehicledyn.base.parameters import ParameterSet, as_plain, units_of
from vehicledyn.base.problems import Problem
from vehicledyn.base.registry import find
from vehicledyn.files.scenario.merge import merge_parameters
from vehicledyn.files.scenario.sources import Sources


@dataclass(frozen=True)
class CatalogueModel:
    """An entry of the catalogue with its parameters, see :class:`WrittenModel`."""

    name: str
    entry: Any
    parameters: ParameterSet
    kind: ClassVar[str] = "catalogue"
    text: ClassVar[str] = ""
    has_wheels: ClassVar[bool] = True
    has_rail_wheels: ClassVar[bool] = False
    is_vehicle: ClassVar[bool] = True
    needs_track: ClassVar[bool] = False
    has_track: ClassVar[bool] = False
    file: ClassVar[Any] = None
    coordinates: ClassVar[Mapping[str, Any]] = {}
    places: ClassVar[Mapping[str, Problem]] = {}
    motion: ClassVar[dict[str, Any]] = {}
    assemblies: ClassVar[tuple[Any, ...]] = ()

    @classmethod
    def read(
        cls, name: str, changes: Any, sources: Sources
    ) -> tuple[CatalogueModel | None, list[Problem]]:
        """Return the entry of a name with changed parameters, or None, and all that is wrong."""
        entry = find("model", name)
        parameters, problems = merge_parameters(entry, changes, sources)
        return None if parameters is None else cls(name, entry, parameters), problems

    @property
    def path(self) -> Path:
        """File of its parameters; its name where it has none."""
        return Path(getattr(self.entry, "parameter_file", self.name))

    @property
    def reference(self) -> str:
        """What a scenario in any folder names it by."""
        return self.name

    @property
    def title(self) -> str:
        """What it is, in a sentence."""
        return (self.entry.__doc__ or "").strip().partition("\n")[0]

    @property
    def resolved(self) -> dict[str, Any]:
        """Parameters in SI, in groups."""
        plain: dict[str, Any] = as_plain(self.parameters)
        return plain

    @property
    def described(self) -> dict[str, Any]:
        """What a resolved scenario holds of it."""
        return {"parameters": self.resolved}

    @property
    def units(self) -> dict[str, str]:
        """Unit of each parameter by dotted name."""
        return units_of(self.parameters)

    @property
    def usual_tyre(self) -> str:
        """Kind of its usual tyre."""
        return str(self.entry.standard_options().front_tyre.kind)

    @property
    def classes(self) -> tuple[type, ...]:
        """The entry."""
        return (self.entry,)
