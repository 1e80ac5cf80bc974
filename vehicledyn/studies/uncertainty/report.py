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
    risks: list[Risk] = field(default_factory=list)
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
