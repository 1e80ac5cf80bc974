"""What an identification seeks: parameters and start values with bounds, starts and priors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.sensitivity.names import START
from vehicledyn.base.problems import Place
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.known_names import KnownNames, unknown_parameter
from vehicledyn.studies.mistakes import Mistakes
from vehicledyn.studies.refused_values import refused_ends

Floats = NDArray[np.float64]

KEYS = ("from", "to", "start", "prior", "deviation")

_AT_BOUND = 1e-6
"""Part of its range within which a parameter lies at its bound."""


@dataclass(frozen=True)
class Unknowns:
    """Parameters to identify, in SI: bounds and start (n,), and means and deviations of priors.

    Priors are not numbers where nothing is known beforehand.
    """

    quantities: tuple[Quantity, ...]
    low: Floats
    high: Floats
    start: Floats
    prior: Floats
    deviation: Floats

    @staticmethod
    def of(
        mistakes: Mistakes,
        given: Mapping[str, Any],
        scenarios: Sequence[tuple[LoadedScenario, KnownNames]],
    ) -> Unknowns:
        """Return what is sought in all of some scenarios; what is wrong with it is noted.

        Of parameters about which anything is wrong there is none.
        """
        if not given:
            mistakes.wrong(("parameters",), "name one or more with their bounds")
        known = {**scenarios[0][1].parameters, **scenarios[0][1].starts}
        keys: dict[str, str] = {}
        rows: dict[str, list[float]] = {}
        for key, item in given.items():
            name, place = key.removeprefix("parameters."), ("parameters", key)
            if words := _unknown(name, scenarios):
                mistakes.wrong(place, words, at_key=True)
            elif name in keys:
                mistakes.wrong(place, f"is the same parameter as '{keys[name]}'", at_key=True)
            elif numbers := _numbers(mistakes, place, item, *known[name]):
                rows[name] = numbers
            keys.setdefault(name, key)
        own = [name for name in rows if not name.startswith(START)]
        refused = refused_ends(
            [loaded for loaded, _ in scenarios],
            {name: (rows[name][0], rows[name][1]) for name in own},
            {name: known[name][1] for name in own},
            {name: known[name][0] for name in own},
        )
        for name, words in refused.items():
            mistakes.wrong(("parameters", keys[name]), words)
        columns = np.array(list(rows.values())).reshape(len(rows), len(KEYS)).T
        return Unknowns(tuple(known[name][0] for name in rows), *columns)

    @property
    def names(self) -> list[str]:
        """Names of parameters, and of start values as ``start.STATE``."""
        return [item.name for item in self.quantities]

    @property
    def units(self) -> list[str]:
        """Their SI units."""
        return [item.unit for item in self.quantities]

    def prior_residuals(self, point: Floats) -> tuple[Floats, Floats]:
        """Return how far a point is from what was known before, by deviations, and the slopes."""
        known = np.flatnonzero(np.isfinite(self.prior))
        missed = (point[known] - self.prior[known]) / self.deviation[known]
        return missed, np.eye(len(point))[known] / self.deviation[known][:, None]

    def at_bound(self, point: Floats) -> list[int]:
        """Return which lie at a bound."""
        width = self.high - self.low
        near = np.minimum(point - self.low, self.high - point) <= _AT_BOUND * width
        return [int(k) for k in np.flatnonzero(near)]


def _unknown(name: str, scenarios: Sequence[tuple[LoadedScenario, KnownNames]]) -> str:
    """Return what is wrong with the name of a parameter, by the first scenario that lacks it."""
    for _, own in scenarios:
        known = own.starts if name.startswith(START) else own.parameters
        if words := unknown_parameter(name, known, own.model, role="to identify"):
            return words
    return ""


def _numbers(
    mistakes: Mistakes, place: Place, item: Any, about: Quantity, value: float
) -> list[float]:
    """Return the numbers of one parameter in SI, in the order of :data:`KEYS`; none if wrong."""
    if not isinstance(item, Mapping):
        mistakes.wrong(place, f"expected a mapping with {', '.join(KEYS)}")
        return []
    if missing := [key for key in ("from", "to") if key not in item]:
        mistakes.wrong((*place, missing[0]), "missing; give both bounds")
        return []
    found = {"from": value, "to": value, "start": value, "prior": np.nan, "deviation": np.nan}
    count = len(mistakes.problems)
    for key in KEYS:
        if key in item:
            found[key] = mistakes.number((*place, key), item[key], about.unit)
    mistakes.check_keys(place, item, KEYS)
    if found["from"] >= found["to"]:
        mistakes.wrong(place, "from must be below to")
    elif "start" in item and not found["from"] <= found["start"] <= found["to"]:
        mistakes.wrong((*place, "start"), "its start lies outside its bounds")
    if ("prior" in item) != ("deviation" in item):
        mistakes.wrong(place, "a prior has both prior and deviation")
    if found["deviation"] <= 0.0:
        mistakes.wrong((*place, "deviation"), "the deviation of a prior must be above zero")
    if len(mistakes.problems) > count:
        return []
    found["start"] = float(np.clip(found["start"], found["from"], found["to"]))
    return list(found.values())
