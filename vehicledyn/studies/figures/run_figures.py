"""Figures of one scenario, and those of its run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple, Protocol

import numpy as np

from vehicledyn.analyse.gradients.key_figures import NOT_LINEAR, FigureSlope, unit_of
from vehicledyn.analyse.gradients.motion_slopes import MotionSlopes
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.confirmation import unconfirmed_of
from vehicledyn.analyses.sensitivity.driving_failures import driving_failure
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import RequestedNames, directions, named_channels, wanted
from vehicledyn.base.errors import NumericalError
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.known_names import Parameters, parameters_of
from vehicledyn.studies.mistakes import silent

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
