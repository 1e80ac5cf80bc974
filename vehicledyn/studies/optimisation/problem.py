"""An optimisation study made ready: figures of all scenarios with their gradients at a point."""

from __future__ import annotations

import os
import warnings
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimise import Values
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.confirmation import unconfirmed
from vehicledyn.analyses.sensitivity.figure_names import check_names
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import Wanted, directions, wanted
from vehicledyn.base.errors import InputError, NumericalError, nearest_name
from vehicledyn.base.units import to_si
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.kept_runs import KeptRuns
from vehicledyn.studies.optimisation.file import Limit, OptimisationStudy

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class _Part:
    """A scenario with the figures wanted of it, and their places among all figures."""

    study: MotionStudy
    asked: Wanted
    names: list[str]


class Problem:
    """Figures of a study's scenarios by its variables.

    Parameters
    ----------
    study
        The validated study.
    kept
        Evaluations that are known; further ones are added to it.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If a variable, figure, bound or limit means nothing.
    """

    def __init__(self, study: OptimisationStudy, kept: KeptRuns, progress: Progress) -> None:
        self._study, self._kept = study, kept
        self._parts = _parts(study, progress)
        self.figures = [name for part in self._parts for name in part.names]
        first = self._parts[0].study.prepared
        e = first.equations
        names = [p.name for p in e.parameters]
        for part in self._parts:
            own = part.study.prepared.equations
            for variable in study.variables:
                _check_variable(variable.name, [p.name for p in own.parameters], own.name)
        places = [names.index(v.name) for v in study.variables]
        self.variables = tuple(
            Quantity(e.parameters[k].name, e.parameters[k].unit, e.parameters[k].description)
            for k in places
        )
        values = first.kernel.parameters[places]
        self.low, self.high = (
            np.array([_si(v, e.parameters[k].unit, study, side) for v, k in zip(
                [getattr(item, side) for item in study.variables], places, strict=True)])
            for side in ("low", "high")
        )  # fmt: skip
        starts = [
            value if v.start is None else _si(v.start, e.parameters[k].unit, study, "start")
            for v, k, value in zip(study.variables, places, values, strict=True)
        ]
        self.start = np.array(starts)
        self._check_bounds()
        self.units: dict[str, str] = {}
        self.n_known = kept.n_known

    def _check_bounds(self) -> None:
        for item, low, high, start in zip(
            self.variables, self.low, self.high, self.start, strict=True
        ):
            if not low < high:
                raise InputError(
                    f"{self._study.path}: variables.{item.name}: from must be below to"
                )
            if not low <= start <= high:
                raise InputError(
                    f"{self._study.path}: variables.{item.name}: its start {start:g} {item.unit} "
                    "lies outside its bounds; give start or other bounds"
                )

    def evaluate(self, point: Floats) -> tuple[dict[str, float], dict[str, Floats]]:
        """Return all figures and their gradients at a point.

        Raises
        ------
        NumericalError
            If a run fails or a figure has no derivative there.
        """
        entry = self._kept.entry(point.tolist(), lambda: self._new(point))
        self.units |= entry.get("units", {})
        if "failure" in entry:
            raise NumericalError(str(entry["failure"]))
        slopes = {name: np.array(row) for name, row in entry["slopes"].items()}
        return dict(entry["values"]), slopes

    def values(self, point: Floats, further: Sequence[Limit] = ()) -> Values:
        """Return objective and constraints at a point, with further limits behind those given."""
        figures, slopes = self.evaluate(point)
        weights = self._study.weights
        constraints, rows = [], [np.zeros(len(point))][:0]
        for name, sign, limit in self.limits(further):
            constraints.append(sign * (figures[name] - limit))
            rows.append(sign * slopes[name])
        gradient = sum((w * slopes[name] for name, w in weights.items()), np.zeros(len(point)))
        return Values(
            float(sum(w * figures[name] for name, w in weights.items())),
            gradient,
            np.array(constraints),
            np.array(rows).reshape(len(rows), len(point)),
        )

    def limits(self, further: Sequence[Limit] = ()) -> list[tuple[str, float, float]]:
        """Return the figure, sign and value of each limit: sign (figure - value) >= 0."""
        found = []
        for limit in (*self._study.limits, *further):
            unit = self.units.get(limit.figure, "1")
            for value, sign in ((limit.at_least, 1.0), (limit.at_most, -1.0)):
                if value is not None:
                    number = _si(value, unit, self._study, limit.figure)
                    found.append((limit.figure, sign, number))
        return found

    def idle(self) -> list[str]:
        """Return the variables that change no figure at the start."""
        slopes = self.evaluate(self.start)[1]
        rows = np.array(list(slopes.values()))
        return [item.name for k, item in enumerate(self.variables) if not rows[:, k].any()]

    def unconfirmed(self) -> list[str]:
        """Return warnings of derivatives at the start that differences of runs do not confirm."""
        names, notes = [item.name for item in self.variables], []
        for part in self._parts:
            point = dict(zip(names, map(float, self.start), strict=True))
            study = part.study.moved(point)
            e, kernel = study.prepared.equations, study.prepared.kernel
            chosen = directions(e, kernel.parameters, study.start.state, names)
            motion = study.followed(chosen, _silent)
            own = {e.channels[k].name: place for place, k in enumerate(study.channels)}
            judged = (
                range(len(own)) if part.asked.others else [own[c] for _, c in part.asked.figures]
            )
            notes += unconfirmed(study, chosen, motion, list(dict.fromkeys(judged)))
        return notes

    def starts(self, number: int, seed: int) -> list[Floats]:
        """Return points to search from: the one given, and others of a scrambled Sobol sequence."""
        from scipy.stats import qmc

        if number == 1:
            return [self.start]
        sequence = qmc.Sobol(len(self.start), rng=np.random.default_rng(seed))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # numbers that are no power of two serve
            shares = sequence.random(number - 1)
        return [self.start, *(self.low + (self.high - self.low) * shares)]

    def _new(self, point: Floats) -> dict[str, Any]:
        """Return figures and gradients of all scenarios, computed at once on several cores."""
        if len(self._parts) == 1:
            found = [self._part_at(self._parts[0], point)]
        else:
            with ThreadPoolExecutor(os.cpu_count()) as pool:
                found = list(pool.map(partial(self._part_at, point=point), self._parts))
        whole: dict[str, Any] = {"values": {}, "slopes": {}, "units": {}}
        for entry in found:
            if "failure" in entry:
                return entry
            for key in whole:
                whole[key] |= entry[key]
        return whole

    def _part_at(self, part: _Part, point: Floats) -> dict[str, Any]:
        """Return figures and gradients of one scenario, or why there are none."""
        names = [item.name for item in self.variables]
        try:
            study = part.study.moved(dict(zip(names, map(float, point), strict=True)))
            e, kernel = study.prepared.equations, study.prepared.kernel
            chosen = directions(e, kernel.parameters, study.start.state, names)
            motion = study.followed(chosen, _silent)
        except NumericalError as error:
            return {"failure": f"{part.study.loaded.title}: {error}"}
        found = study.figures(part.asked, motion)
        for name, (slope, _) in zip(part.names, found, strict=True):
            if slope.trouble:
                return {"failure": f"'{name}' has no derivative: {slope.trouble}"}
        return {
            "values": {n: slope.value for n, (slope, _) in zip(part.names, found, strict=True)},
            "slopes": {
                n: slope.slope.tolist() for n, (slope, _) in zip(part.names, found, strict=True)
            },
            "units": {n: quantity.unit for n, (_, quantity) in zip(part.names, found, strict=True)},
        }


def _parts(study: OptimisationStudy, progress: Progress) -> list[_Part]:
    wanted_of: dict[str, list[str]] = {name: [] for name in study.scenarios}
    for figure in study.all_figures:
        scenario, _, name = figure.rpartition("/")
        if scenario not in wanted_of:
            guess = nearest_name(scenario, wanted_of)
            hint = f"; did you mean '{guess}'?" if guess else ""
            raise InputError(f"{study.path}: '{figure}' names no scenario{hint}")
        wanted_of[scenario].append(name)
    parts = []
    for scenario, names in wanted_of.items():
        loaded = study.scenarios[scenario]
        channels = [name.partition("(")[2].removesuffix(")") for name in names if "(" in name]
        progress(f"preparing {loaded.title}", None)
        try:
            check_names(loaded, names, progress)
        except InputError as error:
            raise InputError(f"{study.path}: {error}") from None
        motion = MotionStudy.of(loaded, channels, progress)
        asked = wanted(motion.prepared.equations, names, [n for n in names if "(" not in n])
        if asked.curves:
            raise InputError(
                f"{study.path}: '{asked.curves[0]}' is a curve; take a figure of it, such as "
                f"rms({asked.curves[0]})"
            )
        own = [*asked.others, *(f"{kind}({channel})" for kind, channel in asked.figures)]
        parts.append(_Part(motion, asked, [f"{scenario}/{n}" if scenario else n for n in own]))
    return parts


def _check_variable(name: str, known: Sequence[str], model: str) -> None:
    if name == "speed":
        raise InputError("'speed' is the scenario's; it cannot be a variable")
    if name not in known:
        guess = nearest_name(name, known)
        hint = f"; did you mean '{guess}'?" if guess else ""
        raise InputError(f"'{name}' is no parameter of '{model}'{hint}")


def _si(value: Any, unit: str, study: OptimisationStudy, field: str) -> float:
    try:
        return float(to_si(value, unit))
    except InputError as error:
        raise InputError(f"{study.path}: {field}: {error}") from None


def _silent(text: str, fraction: float | None = None) -> None:
    """Report nothing."""
