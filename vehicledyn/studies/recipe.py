"""How the scenario of any case of a study is made, in this process or another."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Problem
from vehicledyn.base.yaml import Document, read_yaml, remembered_files
from vehicledyn.files.scenario.load import LoadedScenario, examine_scenario
from vehicledyn.files.scenario.overrides import Change
from vehicledyn.studies.axes import Axis

if TYPE_CHECKING:
    from vehicledyn.files.scenario.portable_models import PortableModel


@dataclass(frozen=True)
class Recipe:
    """How to make the scenario of any case, with no file at hand but those it carries."""

    path: Path
    changes: tuple[Change, ...]
    axes: tuple[Axis, ...]
    documents: dict[str, Document] = field(default_factory=dict)
    built: PortableModel | None = None

    def scenario(self, values: Sequence[float], name: str) -> LoadedScenario:
        """Return the scenario of a case with these values, in the order of the axes.

        Raises
        ------
        InputError
            If there is something wrong with it; ``name`` stands before each problem.
        """
        found = [
            Change(axis.key, axis.value(value), f"{name}: {axis.key}")
            for axis, value in zip(self.axes, values, strict=True)
        ]
        loaded, problems = self.examine(found)
        if loaded is None:
            raise InputError("; ".join(map(str, problems)))
        return loaded

    def examine(
        self, further: Sequence[Change] = ()
    ) -> tuple[LoadedScenario | None, list[Problem]]:
        """Return the scenario with further changes, or None, and all that is wrong with it."""
        with remembered_files(self.documents):
            document = read_yaml(self.path)
            built = None if self.built is None else self.built.model
            return examine_scenario(document, self.path, (), [*self.changes, *further], built)
