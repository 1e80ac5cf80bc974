"""What an uncertainty study finds, for people and programs."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.uncertainty import Spread
from vehicledyn.base.units import shown
from vehicledyn.results.store.linear_file import Quantity

Floats = NDArray[np.float64]

Risk = tuple[str, str, float, float, float]
"""Figure, words of the limit, chance of passing it, and its 95 % interval."""


@dataclass(frozen=True)
class UncertaintyReport:
    """Spread of figures, and the shares of their variance that parameters bring.

    ``shares`` (m, n) are first-order ones, ``totals`` those with interactions, None where a
    method does not give them. ``risks`` hold figure, words of the limit, share and its interval.
    ``points`` (n_runs, n) and ``samples`` (n_runs, m) are the runs, None for one with gradients;
    samples of runs that failed are not a number. ``shares_error`` and ``totals_error`` (m, n) are
    the standard errors of shares, None where they have none.
    """

    title: str
    method: str
    parameters: tuple[Quantity, ...]
    figures: tuple[Quantity, ...]
    found: Spread
    shares: Floats | None
    totals: Floats | None
    n_runs: int
    risks: list[Risk] = field(default_factory=list)
    notes: tuple[str, ...] = ()
    points: Floats | None = None
    samples: Floats | None = None
    shares_error: Floats | None = None
    totals_error: Floats | None = None

    @property
    def messages(self) -> tuple[str, ...]:
        """Remarks."""
        return self.notes

    def as_text(self) -> str:
        """Return mean and deviation of each figure, and the parameters that matter most."""
        lines = [f"{self.title}: {self.method}, {self.n_runs} runs"]
        for row, item in enumerate(self.figures):
            found = self.found
            mean, deviation = (
                _with_error(float(value[row]), float(error[row]), item.unit)
                for value, error in (
                    (found.mean, found.mean_error),
                    (found.deviation, found.deviation_error),
                )
            )
            lines.append(f"{item.name} = {mean}, deviation {deviation}")
            if self.shares is None:
                continue
            for k in np.argsort(-self.shares[row]):
                alone = _share(self.shares, self.shares_error, row, k)
                total = _share(self.totals, self.totals_error, row, k)
                words = f"{alone}, with interactions {total}" if total else alone
                lines.append(f"  {self.parameters[k].name}: {words}")
        if np.any(self.found.mean_error > 0.0) or self.shares_error is not None:
            lines.append("+- is one standard error")
        lines += [risk_words(risk) for risk in self.risks]
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
                    "shares": _row(self.shares, k),
                    "totals": _row(self.totals, k),
                    "shares_error": _row(self.shares_error, k),
                    "totals_error": _row(self.totals_error, k),
                }
                for k, item in enumerate(self.figures)
            },
            "risks": [
                {"figure": name, "limit": words, "share": share, "interval": [low, high]}
                for name, words, share, low, high in self.risks
            ],
            "notes": list(self.notes),
        }


def risk_words(risk: Risk) -> str:
    """Return how likely a limit is passed, with the interval."""
    name, words, *chances = risk
    share, low, high = map(_chance, chances)
    return f"{name} {words} in {share} (95 %: {low} to {high})"


def _chance(value: float) -> str:
    """Return a chance with digits that count, also of what is rare or nearly sure."""
    if value in {0.0, 1.0}:
        return f"{value:.0%}"
    if min(value, 1.0 - value) >= 1e-3:
        return f"{value:.2%}"
    rare = f"{100.0 * min(value, 1.0 - value):.4g}%"
    return rare if value < 0.5 else f"all but {rare}"


def _row(values: Floats | None, row: int) -> list[float] | None:
    return None if values is None else values[row].tolist()


def _with_error(value: float, error: float, unit: str) -> str:
    """Return a number with its standard error, if it has one."""
    return f"{shown(value, unit)} +- {shown(error, unit)}" if error > 0.0 else shown(value, unit)


def _share(values: Floats | None, errors: Floats | None, row: int, k: int) -> str:
    """Return a share with its standard error, nothing if it is not known."""
    if values is None:
        return ""
    return f"{values[row, k]:.1%}" + ("" if errors is None else f" +- {errors[row, k]:.1%}")
