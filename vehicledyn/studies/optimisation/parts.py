"""Figures of one scenario of an optimisation study at any point: of its run, or of an analysis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

import numpy as np

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.confirmation import unconfirmed
from vehicledyn.analyses.sensitivity.driving_failures import driving_failure
from vehicledyn.analyses.sensitivity.figure_names import check_figures
from vehicledyn.analyses.sensitivity.known_analyses import ANALYSES, RUN, analysis_of
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import Wanted, directions, wanted
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.studies.optimisation.file import OptimisationStudy

Parameters: TypeAlias = Mapping[str, tuple[Quantity, float]]
"""Parameters by name, with their values."""


class Part(Protocol):
    """Figures of one scenario."""

    @property
    def names(self) -> list[str]:
        """Names of the figures in the study."""

    @property
    def model(self) -> str:
        """Name of the model."""

    @property
    def parameters(self) -> Parameters:
        """Parameters of the model."""

    def at(
        self, changes: Mapping[str, float], variables: Sequence[str], *, follows: bool
    ) -> dict[str, Any]:
        """Return figures and gradients by variables, or why there are none.

        Parameters
        ----------
        changes
            Values of parameters.
        variables
            Parameters that gradients are by.
        follows
            Whether gradients are wanted; else they are zero.
        """

    def unconfirmed(self, point: Mapping[str, float]) -> list[str]:
        """Return warnings of derivatives by what a point gives that differences do not confirm."""


@dataclass(frozen=True)
class RunPart:
    """Key figures of a run, and figures of its channels."""

    study: MotionStudy
    asked: Wanted
    names: list[str]

    @property
    def model(self) -> str:
        """Name of the model."""
        return self.study.prepared.equations.name

    @property
    def parameters(self) -> Parameters:
        """Parameters of the model."""
        prepared = self.study.prepared
        pairs = zip(prepared.equations.parameters, prepared.kernel.parameters, strict=True)
        return {p.name: (Quantity(p.name, p.unit, p.description), float(v)) for p, v in pairs}

    def at(
        self, changes: Mapping[str, float], variables: Sequence[str], *, follows: bool
    ) -> dict[str, Any]:
        """Return figures and gradients of the run, or why there are none."""
        title = self.study.loaded.title
        try:
            study = self.study.moved(dict(changes))
            e, kernel = study.prepared.equations, study.prepared.kernel
            if follows:
                chosen = directions(e, kernel.parameters, study.start.state, variables)
                motion = study.followed(chosen, _silent)
            else:
                motion = study.plain(_silent)
        except NumericalError as error:
            return {"failure": f"{title}: {error}"}
        if lost := driving_failure(study, motion):
            return {"failure": f"{title}: {lost}"}
        found = list(zip(self.names, study.figures(self.asked, motion), strict=True))
        for name, (slope, _) in found:
            if slope.trouble and follows:
                return {"failure": f"'{name}' has no derivative: {slope.trouble}"}
        nothing = [0.0] * len(variables)
        return {
            "values": {n: slope.value for n, (slope, _) in found},
            "slopes": {n: slope.slope.tolist() if follows else nothing for n, (slope, _) in found},
            "units": {n: quantity.unit for n, (_, quantity) in found},
        }

    def unconfirmed(self, point: Mapping[str, float]) -> list[str]:
        """Return warnings of derivatives at a point that differences of runs do not confirm."""
        study = self.study.moved(dict(point))
        e, kernel = study.prepared.equations, study.prepared.kernel
        chosen = directions(e, kernel.parameters, study.start.state, list(point))
        motion = study.followed(chosen, _silent)
        own = {e.channels[k].name: place for place, k in enumerate(study.channels)}
        figures = self.asked.figures
        judged = range(len(own)) if self.asked.others else [own[c] for _, c in figures]
        return unconfirmed(study, chosen, motion, list(dict.fromkeys(judged)))


@dataclass(frozen=True)
class AnalysisPart:
    """Figures of an analysis other than the run, all of one.

    ``asked`` are their own names, ``first`` what the analysis finds by all parameters of the
    scenario as it is.
    """

    loaded: LoadedScenario
    analysis: str
    asked: list[str]
    names: list[str]
    first: SensitivityTable

    @classmethod
    def of(cls, loaded: LoadedScenario, analysis: str, asked: list[str], head: str) -> AnalysisPart:
        """Return the part of some figures, whose names in the study begin with ``head``.

        Raises
        ------
        InputError
            If a name means nothing, or more than one figure.
        NumericalError
            If the analysis fails.
        """
        if ANALYSES[analysis].subject == "file":
            raise InputError(f"'{asked[0]}' is of a file, not of a scenario")
        first = _table(loaded, analysis, asked, ["parameters.*"])
        _places(asked, first)
        return cls(loaded, analysis, asked, [f"{head}{name}" for name in asked], first)

    @property
    def model(self) -> str:
        """Name of the model."""
        return self.first.model

    @property
    def parameters(self) -> Parameters:
        """Parameters of the model."""
        pairs = zip(self.first.parameters, self.first.parameter_values, strict=True)
        return {quantity.name: (quantity, float(value)) for quantity, value in pairs}

    def at(
        self, changes: Mapping[str, float], variables: Sequence[str], *, follows: bool
    ) -> dict[str, Any]:
        """Return figures and gradients of the analysis, or why there are none."""
        known = self.parameters
        texts = [f"parameters.{n}={v!r} {known[n][0].unit}".rstrip() for n, v in changes.items()]
        try:
            target = self.loaded.with_overrides(texts)
            table = _table(target, self.analysis, self.asked, variables)
        except NumericalError as error:
            return {"failure": f"{self.loaded.title}: {error}"}
        places = _places(self.asked, table)
        for name, k in zip(self.names, places, strict=True):
            if follows and not np.isfinite([table.values[k], *table.slopes[k]]).all():
                return {"failure": f"'{name}' has no derivative at this point"}
        nothing, found = [0.0] * len(variables), list(zip(self.names, places, strict=True))
        return {
            "values": {n: float(table.values[k]) for n, k in found},
            "slopes": {n: table.slopes[k].tolist() if follows else nothing for n, k in found},
            "units": {n: table.figures[k].unit for n, k in found},
        }

    def unconfirmed(self, point: Mapping[str, float]) -> list[str]:
        """Return nothing: these derivatives are not those of steps through events."""
        return []


_LISTED = 4


def _table(
    loaded: LoadedScenario, analysis: str, asked: Sequence[str], to: Sequence[str]
) -> SensitivityTable:
    """Return derivatives of figures of an analysis by parameters, at the scenario's own speed."""
    own = ANALYSES[analysis]
    find, _ = own.load()
    speeds = (None,) if own.has_speed else ()
    return find(loaded, list(asked), list(to), *speeds, _silent, memory=Memory())


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


def parts_of(study: OptimisationStudy, progress: Progress) -> list[Part]:
    """Return the figures of a study, scenario by scenario and analysis by analysis.

    Raises
    ------
    InputError
        If a name means nothing.
    """
    parts: list[Part] = []
    for scenario, names in study.figures_by_scenario().items():
        loaded = study.scenarios[scenario]
        progress(f"preparing {loaded.title}", None)
        head = f"{scenario}/" if scenario else ""
        try:
            for kind in dict.fromkeys(analysis_of(name) for name in names):
                own = [name for name in names if analysis_of(name) == kind]
                if kind == RUN:
                    parts.append(_run_part(loaded, own, head, progress))
                else:
                    parts.append(AnalysisPart.of(loaded, kind, own, head))
        except InputError as error:
            raise InputError(f"{study.path}: {error}") from None
    return parts


def _run_part(loaded: LoadedScenario, names: list[str], head: str, progress: Progress) -> RunPart:
    channels = [name.partition("(")[2].removesuffix(")") for name in names if "(" in name]
    check_figures(loaded, names, progress)
    motion = MotionStudy.of(loaded, channels, progress)
    asked = wanted(motion.prepared.equations, names, [n for n in names if "(" not in n])
    own = [*asked.others, *(f"{kind}({channel})" for kind, channel in asked.figures)]
    return RunPart(motion, asked, [f"{head}{name}" for name in own])


def _silent(text: str, fraction: float | None = None) -> None:
    """Report nothing."""
