"""Systems built in Python as the models of scenarios."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.problems import Place, Problem
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario.model_names import PYTHON
from vehicledyn.files.scenario.sources import Sources
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.system import System


@dataclass(frozen=True)
class PythonModel:
    """A system that was built in Python, see :class:`WrittenModel` for what scenarios ask."""

    system: System
    text: str = ""
    has_wheels: bool = False
    has_rail_wheels: bool = False
    is_vehicle: bool = False
    needs_track: bool = False
    has_track: bool = False
    kind: ClassVar[str] = "python"
    title: ClassVar[str] = ""
    usual_tyre: ClassVar[str] = ""
    file: ClassVar[Any] = None
    places: ClassVar[Mapping[str, Problem]] = {}
    motion: ClassVar[dict[str, Any]] = {}
    assemblies: ClassVar[tuple[Any, ...]] = ()
    classes: ClassVar[tuple[type, ...]] = ()

    @property
    def path(self) -> Path:
        """A name in place of a file."""
        return Path(f"{PYTHON}{self.name}")

    @property
    def name(self) -> str:
        """Name of the system."""
        return self.system.name

    @property
    def resolved(self) -> dict[str, float]:
        """Parameters in SI by dotted name."""
        return {entry.name: entry.value for entry in self.system.table.entries}

    @property
    def reference(self) -> str:
        """What a scenario names it by."""
        return str(self.path)

    @property
    def described(self) -> dict[str, Any]:
        """What a resolved scenario holds of it."""
        return {"parameters": self.resolved, "system": self.text}

    @property
    def units(self) -> dict[str, str]:
        """Unit of each parameter."""
        return {entry.name: entry.unit for entry in self.system.table.entries}

    @property
    def coordinates(self) -> dict[str, Joint]:
        """Joints by the name of their coordinate."""
        return {joint.name: joint for joint in self.system.joints()}

    @property
    def groups(self) -> set[str]:
        """First words of its parameters."""
        return {name.partition(".")[0] for name in self.resolved}

    def changed(
        self, given: Mapping[str, Any], sources: Sources
    ) -> tuple[PythonModel | None, list[Problem]]:
        """Return it with other parameters and start values, or None, and all that is wrong."""
        problems: list[Problem] = []
        units = {"parameters": self.units, "initial": self._coordinate_units()}
        values: dict[str, dict[str, float]] = {"parameters": {}, "initial": {}}
        for section, known in units.items():
            for place, value in _leaves(given.get(section) or {}, ()):
                name = ".".join(map(str, place))
                try:
                    values[section][name] = _value(section, name, value, known)
                except InputError as error:
                    problems.append(sources.problem((section, *place), str(error)))
        if problems:
            return None, problems
        table = replace(self.system.table, entries=self._entries(values["parameters"]))
        system = replace(self.system, table=table).with_starts(values["initial"])
        return replace(self, system=system), []

    def _entries(self, values: Mapping[str, float]) -> list[Any]:
        entries = self.system.table.entries
        return [replace(entry, value=values.get(entry.name, entry.value)) for entry in entries]

    def _coordinate_units(self) -> dict[str, str]:
        units = {name: joint.unit for name, joint in self.coordinates.items()}
        return units | {f"{name}_rate": f"{unit}/s" for name, unit in units.items()}


def _value(section: str, name: str, value: Any, units: Mapping[str, str]) -> float:
    if name not in units:
        what = "parameter" if section == "parameters" else "coordinate"
        raise InputError(unknown_name(what, name, units))
    return to_si(value, units[name])


def _leaves(data: Any, place: Place) -> Iterator[tuple[Place, Any]]:
    """Yield the values of nested mappings with their places; dotted keys are several steps."""
    for key, value in data.items():
        inner = (*place, *str(key).split("."))
        if isinstance(value, Mapping):
            yield from _leaves(value, inner)
        else:
            yield inner, value
