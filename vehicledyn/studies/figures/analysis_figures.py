"""Figures of one scenario that an analysis other than the run finds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vehicledyn.analyse.gradients.key_figures import FigureSlope
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.known_analyses import ANALYSES
from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.studies.figures.run_figures import Found
from vehicledyn.studies.known_names import Parameters
from vehicledyn.studies.mistakes import silent
from vehicledyn.studies.refused_values import written

_LISTED = 4

_FIRST: BoundedCache[tuple[int, str, tuple[str, ...]], tuple[LoadedScenario, SensitivityTable]]
_FIRST = BoundedCache(16)
"""What analyses found of scenarios as they are, which a check of a study and its start ask for;
the scenario is kept, so that no other has its ``id``."""


@dataclass(frozen=True)
class AnalysisFigures:
    """Figures of an analysis other than the run, all of one.

    ``asked`` are their names, ``first`` what the analysis finds by all parameters of the scenario
    as it is.
    """

    loaded: LoadedScenario
    analysis: str
    asked: list[str]
    first: SensitivityTable
    notes: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, loaded: LoadedScenario, analysis: str, asked: Sequence[str]) -> AnalysisFigures:
        """Return figures of an analysis by their names.

        Raises
        ------
        InputError
            If a name means nothing, or more than one figure.
        NumericalError
            If the analysis fails.
        """
        if ANALYSES[analysis].subject == "file":
            raise InputError(f"'{asked[0]}' is of a file, not of a scenario")
        key = id(loaded), analysis, tuple(asked)
        _, first = _FIRST.get(
            key, lambda: (loaded, _table(loaded, analysis, asked, ["parameters.*"], silent))
        )
        _places(asked, first)
        return cls(loaded, analysis, list(asked), first)

    @property
    def title(self) -> str:
        """Title of the scenario."""
        return self.loaded.title

    @property
    def model(self) -> str:
        """Name of the model."""
        return self.first.model

    @property
    def parameters(self) -> Parameters:
        """Parameters of the model."""
        pairs = zip(self.first.parameters, self.first.parameter_values, strict=True)
        return {quantity.name: (quantity, float(value)) for quantity, value in pairs}

    @property
    def units(self) -> Mapping[str, str | None]:
        """Units of the figures by name."""
        places = _places(self.asked, self.first)
        return {n: self.first.figures[k].unit for n, k in zip(self.asked, places, strict=True)}

    def at(
        self,
        changes: Mapping[str, float],
        variables: Sequence[str],
        *,
        follows: bool,
        progress: Progress,
    ) -> Found:
        """Return the figures of the analysis at other values of parameters."""
        known = self.parameters
        texts = [f"parameters.{n}={written(v, known[n][0].unit)}" for n, v in changes.items()]
        target = self.loaded.with_overrides(texts)
        table = _table(target, self.analysis, self.asked, variables, progress)
        pairs = []
        for name, k in zip(self.asked, _places(self.asked, table), strict=True):
            value, slope, about = float(table.values[k]), table.slopes[k], table.figures[k]
            if not np.isfinite(value):
                raise NumericalError(f"'{name}' has no value there")
            lost = "" if np.isfinite(slope).all() else "it does not exist at this point"
            slope = slope if follows else np.zeros(len(variables))
            quantity = Quantity(name, about.unit, about.description)
            pairs.append((FigureSlope(value, slope, lost if follows else ""), quantity))
        return Found(pairs)

    def unconfirmed(self, point: Mapping[str, float]) -> list[str]:
        """Return nothing: these derivatives are not those of steps through events."""
        return []


def _table(
    loaded: LoadedScenario,
    analysis: str,
    asked: Sequence[str],
    to: Sequence[str],
    progress: Progress,
) -> SensitivityTable:
    """Return derivatives of figures of an analysis by parameters, at the scenario's own speed."""
    own = ANALYSES[analysis]
    find, _ = own.load()
    speeds: tuple[Any, ...] = (None,) if own.has_speed else ()
    return find(loaded, list(asked), list(to), *speeds, progress, memory=Memory())


def _places(asked: Sequence[str], table: SensitivityTable) -> list[int]:
    """Return the numbers of figures among those of a table.

    Raises
    ------
    InputError
        If a name stands for several figures, or for a curve.
    """
    names = [quantity.name for quantity in table.figures]
    if not table.channels and len(names) == len(asked):
        return list(range(len(names)))
    for name in asked:
        if name not in names:
            listed = ", ".join(f"'{n}'" for n in names[:_LISTED])
            raise InputError(
                f"'{name}' stands for several figures or a curve: name one figure; here are "
                f"{listed}"
            )
    return [names.index(name) for name in asked]
