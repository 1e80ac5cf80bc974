"""What an identification seeks: parameters and start values with bounds, starts and priors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import START
from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.units import to_si
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.refused_values import refuse_ends

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
    def of(given: Mapping[str, Mapping[str, Any]], studies: Sequence[MotionStudy]) -> Unknowns:
        """Return what is sought in all of some studies.

        Raises
        ------
        InputError
            If a name, a unit or a bound means nothing.
        """
        names = [name.removeprefix("parameters.") for name in given]
        if not names:
            raise InputError("parameters: name one or more with their bounds")
        known = [_known(study) for study in studies]
        for name in names:
            for study, items in zip(studies, known, strict=True):
                _check_name(name, items, study.prepared.equations.name)
        quantities = tuple(known[0][name][0] for name in names)
        columns: dict[str, list[float]] = {key: [] for key in KEYS}
        for name, quantity, item in zip(names, quantities, given.values(), strict=True):
            for key, value in _numbers(name, quantity.unit, item, known[0][name][1]).items():
                columns[key].append(value)
        low, high, start, prior, deviation = (np.array(columns[key]) for key in KEYS)
        own = [k for k, name in enumerate(names) if not name.startswith(START)]
        refuse_ends(
            [study.loaded for study in studies],
            {names[k]: (float(low[k]), float(high[k])) for k in own},
            {names[k]: known[0][names[k]][1] for k in own},
            {names[k]: quantities[k] for k in own},
            place="parameters.",
        )
        return Unknowns(quantities, low, high, start, prior, deviation)

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


def _known(study: MotionStudy) -> dict[str, tuple[Quantity, float]]:
    """Return what a study could identify, with its present values."""
    e, parameters = study.prepared.equations, study.prepared.kernel.parameters
    found = {
        p.name: (Quantity(p.name, p.unit, p.description), float(value))
        for p, value in zip(e.parameters, parameters, strict=True)
        if p.name != "speed"
    }
    for item, value in zip(e.states, study.start.state, strict=True):
        name = f"{START}{item.name}"
        found[name] = Quantity(name, item.unit, item.description), float(value)
    return found


def _check_name(name: str, known: Mapping[str, Any], model: str) -> None:
    if name not in known:
        guess = nearest_name(name, known)
        hint = f"; did you mean '{guess}'?" if guess else ""
        raise InputError(f"'{name}' is no parameter of '{model}' to identify{hint}")


def _numbers(name: str, unit: str, item: Mapping[str, Any], value: float) -> dict[str, float]:
    """Return the numbers of one parameter in SI."""
    missing = [key for key in ("from", "to") if key not in item]
    if missing:
        raise InputError(f"parameters.{name}.{missing[0]}: missing; give both bounds")
    found = {"start": value, "prior": np.nan, "deviation": np.nan}
    for key, text in item.items():
        try:
            found[key] = float(to_si(text, unit))
        except InputError as error:
            raise InputError(f"parameters.{name}.{key}: {error}") from None
    if not found["from"] < found["to"]:
        raise InputError(f"parameters.{name}: from must be below to")
    if "start" in item and not found["from"] <= found["start"] <= found["to"]:
        raise InputError(f"parameters.{name}: its start lies outside its bounds")
    if ("prior" in item) != ("deviation" in item):
        raise InputError(f"parameters.{name}: a prior has both prior and deviation")
    if "deviation" in item and not found["deviation"] > 0.0:
        raise InputError(f"parameters.{name}: the deviation of a prior must be above zero")
    found["start"] = float(np.clip(found["start"], found["from"], found["to"]))
    return found
