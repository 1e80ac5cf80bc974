"""Figures of a scenario whose parameters have distributions: spread, shares, risk of a limit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.key_figures import unit_of
from vehicledyn.analyse.uncertainty import (
    Distribution,
    Spread,
    failing,
    first_order,
    first_order_shares,
    normal,
    samples,
    sobol,
    spread,
    triangular,
    uniform,
)
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.figure_names import check_names
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import Wanted, directions, named_channels, wanted
from vehicledyn.base.errors import InputError, NumericalError, nearest_name
from vehicledyn.base.units import shown, to_si
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.kept_runs import KeptRuns

Floats = NDArray[np.float64]

METHODS = ("first_order", "monte_carlo", "sequence", "sobol")
_LAWS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "normal": (normal, ("mean", "deviation")),
    "uniform": (uniform, ("from", "to")),
    "triangular": (triangular, ("from", "mode", "to")),
}


@dataclass(frozen=True)
class UncertaintyReport:
    """Spread of figures, and the shares of their variance that parameters bring.

    ``shares`` (m, n) are first-order ones, ``totals`` those with interactions, None where a
    method does not give them. ``risks`` hold figure, words of the limit, share and its interval.
    ``points`` (n_runs, n) and ``samples`` (n_runs, m) are the runs, None for one with gradients.
    """

    title: str
    method: str
    parameters: tuple[Quantity, ...]
    figures: tuple[Quantity, ...]
    found: Spread
    shares: Floats | None
    totals: Floats | None
    n_runs: int
    risks: list[tuple[str, str, float, float, float]] = field(default_factory=list)
    notes: tuple[str, ...] = ()
    points: Floats | None = None
    samples: Floats | None = None

    @property
    def messages(self) -> tuple[str, ...]:
        """Remarks."""
        return self.notes

    def as_text(self) -> str:
        """Return mean and deviation of each figure, and the parameters that matter most."""
        lines = [f"{self.title}: {self.method}, {self.n_runs} runs"]
        for row, item in enumerate(self.figures):
            mean, deviation = (
                shown(float(v[row]), item.unit) for v in (self.found.mean, self.found.deviation)
            )
            lines.append(f"{item.name} = {mean}, deviation {deviation}")
            if self.shares is None:
                continue
            for k in np.argsort(-self.shares[row]):
                total = (
                    "" if self.totals is None else f", with interactions {self.totals[row, k]:.1%}"
                )
                lines.append(f"  {self.parameters[k].name}: {self.shares[row, k]:.1%}{total}")
        lines += [
            f"{name} {words} in {share:.2%} (95 %: {low:.2%} to {high:.2%})"
            for name, words, share, low, high in self.risks
        ]
        return "\n".join([*lines, *self.notes])

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data, in SI."""
        found = self.found
        return {
            "title": self.title,
            "method": self.method,
            "runs": self.n_runs,
            "parameters": [item.name for item in self.parameters],
            "figures": {
                item.name: {
                    "mean": float(found.mean[k]),
                    "deviation": float(found.deviation[k]),
                    "mean_error": float(found.mean_error[k]),
                    "deviation_error": float(found.deviation_error[k]),
                    "shares": None if self.shares is None else self.shares[k].tolist(),
                    "totals": None if self.totals is None else self.totals[k].tolist(),
                }
                for k, item in enumerate(self.figures)
            },
            "risks": [
                {"figure": name, "limit": words, "share": share, "interval": [low, high]}
                for name, words, share, low, high in self.risks
            ],
            "notes": list(self.notes),
        }


def find_uncertainty(
    loaded: LoadedScenario,
    of: Sequence[str],
    parameters: Mapping[str, Mapping[str, Any]],
    *,
    method: str,
    number: int,
    seed: int,
    limits: Mapping[str, Mapping[str, Any]],
    progress: Progress,
    runs: KeptRuns | None = None,
) -> UncertaintyReport:
    """Return how the figures of a scenario scatter.

    Parameters
    ----------
    loaded
        The scenario.
    of
        Key figures of the run, or figures of channels such as ``max(chassis.roll)``.
    parameters
        Distribution of each uncertain parameter: ``kind`` and its numbers.
    method
        One of :data:`METHODS`.
    number
        Runs; of Sobol indices those of each sample, a power of two.
    seed
        Equal seeds give equal results.
    limits
        By figure ``at_most`` or ``at_least``, whose risk is wanted.
    progress
        Called with what is going on.
    runs
        Runs that are known, to which further ones are added.

    Raises
    ------
    InputError
        If a name, distribution, method or limit means nothing.
    NumericalError
        If a run fails.
    """
    if method not in METHODS:
        raise InputError(f"method '{method}' is unknown; known are {', '.join(METHODS)}")
    if number < 2 or (method == "sobol" and number & (number - 1)):
        raise InputError(f"number: {number}: at least 2, of Sobol indices a power of two")
    cases = _Cases.of(loaded, list(of), parameters, progress)
    cases.runs = runs or KeptRuns(None, (), resume=False)
    cases.check_limits(method, limits)
    if method == "first_order":
        values, slopes = cases.linear()
        found, shares = (
            first_order(values, slopes, cases.laws),
            first_order_shares(slopes, cases.laws),
        )
        return cases.report(method, limits, found, shares=shares)
    if method == "sobol":
        first, total = sobol(cases.figures_at, cases.laws, number, seed)
        points = np.array(cases.known)
        return cases.report(
            method, limits, spread(points), shares=first, totals=total, figures=points
        )
    drawn = samples(cases.laws, number, seed, scrambled=method == "sequence")
    figures = cases.figures_at(drawn)
    return cases.report(method, limits, spread(figures), figures=figures)


@dataclass
class _Cases:
    """A scenario at many values of its uncertain parameters."""

    study: MotionStudy
    asked: Wanted
    names: list[str]
    laws: list[Distribution]
    progress: Progress
    runs: KeptRuns = field(default_factory=lambda: KeptRuns(None, (), resume=False))
    known: list[Floats] = field(default_factory=list)
    points: list[Floats] = field(default_factory=list)
    quantities: tuple[Quantity, ...] = ()
    limits: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @staticmethod
    def of(
        loaded: LoadedScenario,
        of: list[str],
        parameters: Mapping[str, Mapping[str, Any]],
        progress: Progress,
    ) -> _Cases:
        """Prepare a scenario and read the distributions."""
        check_names(loaded, of, progress)
        study = MotionStudy.of(loaded, named_channels(of), progress)
        e = study.prepared.equations
        asked = wanted(e, of, [name for name in of if "(" not in name])
        if asked.curves:
            raise InputError(
                f"'{asked.curves[0]}' is a curve; take a figure of it, such as rms(...)"
            )
        units = {p.name: p.unit for p in e.parameters}
        names = [name.removeprefix("parameters.") for name in parameters]
        if not names:
            raise InputError("parameters: name at least one with its distribution")
        for name in names:
            if name not in units or name == "speed":
                guess = nearest_name(name, units)
                hint = f"; did you mean '{guess}'?" if guess else ""
                raise InputError(f"'{name}' is no parameter of '{e.name}' that can scatter{hint}")
        pairs = zip(names, parameters.values(), strict=True)
        laws = [_law(name, given, units[name]) for name, given in pairs]
        return _Cases(study, asked, names, laws, progress)

    def check_limits(self, method: str, limits: Mapping[str, Mapping[str, Any]]) -> None:
        """Raise InputError for limits that mean nothing, before anything is computed."""
        channels = {
            channel.name: channel.unit for channel in self.study.prepared.equations.channels
        }
        units: dict[str, str | None] = dict.fromkeys(self.asked.others)
        for kind, channel in self.asked.figures:
            units[f"{kind}({channel})"] = unit_of(kind, channels[channel])
        for name, given in limits.items():
            if name not in units:
                raise _wrong(f"limits.{name}", "this is not among the figures asked for")
            for key, value in given.items():
                if key not in ("at_most", "at_least"):
                    raise _wrong(f"limits.{name}", f"expected at_most or at_least, found '{key}'")
                if units[name] is not None:
                    _limit(name, key, value, units[name])
        if limits and method == "first_order":
            raise _wrong("limits", "the risk of a limit needs samples; take another method")
        self.limits = limits

    def linear(self) -> tuple[Floats, Floats]:
        """Return the figures at the means and their derivatives."""
        means = {name: law.mean for name, law in zip(self.names, self.laws, strict=True)}
        study = self.study.moved(means)
        e, kernel = study.prepared.equations, study.prepared.kernel
        chosen = directions(e, kernel.parameters, study.start.state, self.names)
        pairs = study.figures(self.asked, study.followed(chosen, self.progress))
        self.quantities = tuple(quantity for _, quantity in pairs)
        self.known.append(np.array([slope.value for slope, _ in pairs]))
        for slope, quantity in pairs:
            if slope.trouble:
                raise NumericalError(f"'{quantity.name}' has no derivative: {slope.trouble}")
        return self.known[0], np.array([slope.slope for slope, _ in pairs])

    def figures_at(self, points: Floats) -> Floats:
        """Return the figures at some points, shape (number, m)."""
        rows = []
        for count, point in enumerate(points):
            entry = self.runs.entry(point.tolist(), partial(self._run, point))
            self.quantities = tuple(Quantity(*item) for item in entry["figures"])
            if "failure" in entry:
                raise NumericalError(str(entry["failure"]))
            rows.append(np.array(entry["values"], dtype=float))
            self.progress("computing samples", (count + 1) / len(points))
        self.known += rows
        self.points += list(points)
        return np.array(rows)

    def _run(self, point: Floats) -> dict[str, Any]:
        """Return the figures at a point, or why there are none."""
        changes = dict(zip(self.names, map(float, point), strict=True))
        try:
            study = self.study.moved(changes)
            pairs = study.figures(self.asked, study.plain(self.progress))
        except NumericalError as error:
            values = ", ".join(f"{name} = {value:.6g}" for name, value in changes.items())
            return {"figures": [], "failure": f"the run with {values} failed: {error}"}
        for _, item in pairs:
            for key, value in self.limits.get(item.name, {}).items():
                _limit(item.name, key, value, item.unit)  # before anything is kept
        about = [(q.name, q.unit, q.description) for _, q in pairs]
        return {"figures": about, "values": [slope.value for slope, _ in pairs]}

    def report(
        self,
        method: str,
        limits: Mapping[str, Mapping[str, Any]],
        found: Spread,
        *,
        shares: Floats | None = None,
        totals: Floats | None = None,
        figures: Floats | None = None,
    ) -> UncertaintyReport:
        """Return the report, with the risks of limits."""
        e = self.study.prepared.equations
        about = {p.name: Quantity(p.name, p.unit, p.description) for p in e.parameters}
        risks = list(self._risks(limits, figures))
        return UncertaintyReport(
            self.study.loaded.title,
            method,
            tuple(about[name] for name in self.names),
            self.quantities,
            found,
            shares,
            totals,
            len(self.known),
            risks,
            tuple(self.study.notes),
            np.array(self.points) if self.points else None,
            np.array(self.known) if self.points else None,
        )

    def _risks(
        self, limits: Mapping[str, Mapping[str, Any]], figures: Floats | None
    ) -> Iterator[tuple[str, str, float, float, float]]:
        """Yield figure, words of a limit, the share beyond it and its interval."""
        places = {item.name: k for k, item in enumerate(self.quantities)}
        for name, given in limits.items():
            if figures is None:
                continue
            k = places[name]
            unit = self.quantities[k].unit
            for key, value in given.items():
                limit = _limit(name, key, value, unit)
                share, low, high = failing(figures[:, k], limit, above=key == "at_most")
                words = f"{'above' if key == 'at_most' else 'below'} {shown(limit, unit)}"
                yield name, words, share, low, high


def _limit(name: str, key: str, value: Any, unit: str | None) -> float:
    """Return a limit of a figure in SI."""
    place = f"limits.{name}.{key}"
    try:
        limit = to_si(value, unit or "1")
    except InputError as error:
        raise _wrong(place, str(error)) from None
    if not np.isfinite(limit):
        raise _wrong(place, "expected a finite number")
    return limit


def _wrong(place: str, words: str) -> InputError:
    """Return the error of a key of a study."""
    return InputError(f"{place}: {words}", about=(place,))


def _law(name: str, given: Mapping[str, Any], unit: str) -> Distribution:
    """Return a distribution from its kind and numbers."""
    kind = given.get("kind")
    if not isinstance(kind, str) or kind not in _LAWS:
        known = ", ".join(_LAWS)
        raise _wrong(f"parameters.{name}", f"kind '{kind!s:.40}' is unknown; known are {known}")
    make, fields = _LAWS[kind]
    if set(given) != {"kind", *fields}:
        raise _wrong(f"parameters.{name}", f"a {kind} distribution has {', '.join(fields)}")
    try:
        numbers = [to_si(given[item], unit) for item in fields]
    except InputError as error:
        raise _wrong(f"parameters.{name}", str(error)) from None
    ordered = numbers[1] > 0.0 if kind == "normal" else numbers == sorted(set(numbers))
    if not ordered:
        raise _wrong(f"parameters.{name}", "its numbers must grow, a deviation be above zero")
    found: Distribution = make(*numbers)
    return found
