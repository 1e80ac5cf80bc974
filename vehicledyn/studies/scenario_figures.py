"""Figures of one scenario at any values of its parameters: of its run, or of an analysis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol

import numpy as np

from vehicledyn.analyse.gradients.key_figures import NOT_LINEAR, FigureSlope, unit_of
from vehicledyn.analyse.gradients.motion_slopes import MotionSlopes
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.confirmation import unconfirmed_of
from vehicledyn.analyses.sensitivity.driving_failures import driving_failure
from vehicledyn.analyses.sensitivity.known_analyses import ANALYSES, RUN, analysis_of
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import RequestedNames, directions, named_channels, wanted
from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.base.errors import InputError, MissingPartError, NumericalError
from vehicledyn.base.problems import Place
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.studies.known_names import Parameters, parameters_of
from vehicledyn.studies.mistakes import Mistakes, silent
from vehicledyn.studies.refused_values import written

_LISTED = 4

_FIRST: BoundedCache[tuple[int, str, tuple[str, ...]], tuple[LoadedScenario, SensitivityTable]]
_FIRST = BoundedCache(16)
"""What analyses found of scenarios as they are, which a check of a study and its start ask for;
the scenario is kept, so that no other has its ``id``."""

_MOST_SAMPLES = 50_000
"""Derivatives of the samples of a channel that are kept of a run."""


class FigureSamples(NamedTuple):
    """Samples of a channel (s,), their times, and derivatives (s, n); ``kind`` is its figure's."""

    kind: str
    times: np.ndarray
    values: np.ndarray
    slopes: np.ndarray


class Found(NamedTuple):
    """Figures with their derivatives, and how the vehicle failed in the run, empty if it did not.

    Where derivatives were not wanted they are zero. ``samples`` are those of the figures of a
    channel that are not linear in it, by name, unless they are too many.
    """

    pairs: list[tuple[FigureSlope, Quantity]]
    failure: str = ""
    samples: Mapping[str, FigureSamples] = MappingProxyType({})


class ScenarioFigures(Protocol):
    """Figures of one scenario, all of its run or all of one analysis."""

    @property
    def title(self) -> str:
        """Title of the scenario."""

    @property
    def model(self) -> str:
        """Name of the model."""

    @property
    def parameters(self) -> Parameters:
        """Parameters of the model."""

    @property
    def notes(self) -> list[str]:
        """What is to be said of the figures; others may add to it."""

    @property
    def units(self) -> Mapping[str, str | None]:
        """Units of the figures by name, None where only a run shows them."""

    def at(
        self,
        changes: Mapping[str, float],
        variables: Sequence[str],
        *,
        follows: bool,
        progress: Progress,
    ) -> Found:
        """Return the figures, in the order of ``units``, at other values of parameters.

        Parameters
        ----------
        changes
            Values of parameters.
        variables
            Parameters that derivatives are by.
        follows
            Whether derivatives are wanted.
        progress
            Called with what is going on.

        Raises
        ------
        NumericalError
            If the run or analysis fails.
        """

    def unconfirmed(self, point: Mapping[str, float]) -> list[str]:
        """Return warnings of derivatives by what a point gives that differences do not confirm."""


@dataclass(frozen=True)
class RunFigures:
    """Key figures of a run, and figures of its channels."""

    study: MotionStudy
    asked: RequestedNames

    @classmethod
    def of(cls, loaded: LoadedScenario, names: Sequence[str], progress: Progress) -> RunFigures:
        """Return figures of a run by their names, which were checked.

        Raises
        ------
        NumericalError
            If the run fails.
        """
        study = MotionStudy.of(loaded, named_channels(names), progress)
        e = study.prepared.equations
        return cls(study, wanted(e, names, [name for name in names if "(" not in name]))

    @property
    def title(self) -> str:
        """Title of the scenario."""
        return self.study.loaded.title

    @property
    def model(self) -> str:
        """Name of the model."""
        return self.study.prepared.equations.name

    @property
    def parameters(self) -> Parameters:
        """Parameters of the model."""
        return parameters_of(self.study.prepared)

    @property
    def notes(self) -> list[str]:
        """What is to be said of the run."""
        return self.study.notes

    @property
    def units(self) -> Mapping[str, str | None]:
        """Units of the figures by name, None of those that only a run shows."""
        channels = {c.name: c.unit for c in self.study.prepared.equations.channels}
        found: dict[str, str | None] = dict.fromkeys(self.asked.others)
        for kind, channel in self.asked.figures:
            found[f"{kind}({channel})"] = unit_of(kind, channels[channel])
        return found

    def at(
        self,
        changes: Mapping[str, float],
        variables: Sequence[str],
        *,
        follows: bool,
        progress: Progress,
    ) -> Found:
        """Return the figures of the run at other values of parameters."""
        study = self.study.moved(dict(changes))
        if follows:
            e, kernel = study.prepared.equations, study.prepared.kernel
            chosen = directions(e, kernel.parameters, study.start.state, variables)
            motion = study.followed(chosen, progress)
        else:
            motion = study.plain(progress)
        pairs = study.figures(self.asked, motion)
        for slope, item in pairs:
            if not np.isfinite(slope.value):
                raise NumericalError(f"'{item.name}' is not a number")
        samples = self._samples(motion) if follows else {}
        return Found(pairs, driving_failure(study, motion), samples)

    def _samples(self, motion: MotionSlopes) -> dict[str, FigureSamples]:
        """Return the samples of channels whose figures are not linear in them."""
        channels = self.study.prepared.equations.channels
        names = [channels[k].name for k in self.study.channels]
        if motion.slopes[:, 0].size > _MOST_SAMPLES or motion.ended_by:
            return {}
        return {
            f"{kind}({name})": FigureSamples(
                kind, motion.times, motion.values[:, place], motion.slopes[:, place]
            )
            for kind, name in self.asked.figures
            if kind in NOT_LINEAR
            for place in (names.index(name),)
        }

    def unconfirmed(self, point: Mapping[str, float]) -> list[str]:
        """Return warnings of derivatives at a point that differences of runs do not confirm."""
        study = self.study.moved(dict(point))
        e, kernel = study.prepared.equations, study.prepared.kernel
        chosen = directions(e, kernel.parameters, study.start.state, list(point))
        motion = study.followed(chosen, silent)
        return unconfirmed_of(study, chosen, motion, self.asked)


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


def figures_of(
    mistakes: Mistakes,
    loaded: LoadedScenario,
    places: Mapping[str, Place],
    progress: Progress,
) -> list[ScenarioFigures]:
    """Return figures of a scenario, analysis by analysis; what is wrong with them is noted.

    Parameters
    ----------
    mistakes
        What is wrong in the study so far.
    loaded
        The scenario.
    places
        Names of the figures, those of the run checked, and where the study gives them.
    progress
        Called with what is going on.

    Raises
    ------
    NumericalError
        If the run or an analysis fails.
    """
    found: list[ScenarioFigures] = []
    for kind in dict.fromkeys(analysis_of(name) for name in places):
        own = [name for name in places if analysis_of(name) == kind]
        if kind == RUN:
            found.append(RunFigures.of(loaded, own, progress))
            continue
        progress(f"preparing {kind}", None)
        try:
            found.append(AnalysisFigures.of(loaded, kind, own))
        except InputError as error:
            wrong = _wrong_alone(loaded, kind, own) or {own[0]: str(error)}
            for name, words in wrong.items():
                mistakes.wrong(places[name], words, at_key=len(places[name]) > 1)
            if right := [name for name in own if name not in wrong]:
                found.append(AnalysisFigures.of(loaded, kind, right))
    return found


def quick_figures(
    mistakes: Mistakes,
    loaded: LoadedScenario,
    places: Mapping[str, Place],
    progress: Progress,
) -> list[ScenarioFigures]:
    """Return figures of analyses other than the run that take no longer than a check of a study.

    What is wrong with them is noted; an analysis that fails is left to the study to report. The
    arguments are those of :func:`figures_of`.
    """
    found: list[ScenarioFigures] = []
    kinds = dict.fromkeys(map(analysis_of, places))
    for kind in kinds:
        if kind == RUN or ANALYSES[kind].is_slow:
            continue
        own = {name: place for name, place in places.items() if analysis_of(name) == kind}
        with suppress(NumericalError, MissingPartError):
            found += figures_of(mistakes, loaded, own, progress)
    return found


def _wrong_alone(loaded: LoadedScenario, kind: str, names: Sequence[str]) -> dict[str, str]:
    """Return what is wrong with each figure of an analysis that is no figure on its own."""
    wrong = {}
    for name in names:
        try:
            AnalysisFigures.of(loaded, kind, [name])
        except InputError as error:
            wrong[name] = str(error)
    return wrong


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
