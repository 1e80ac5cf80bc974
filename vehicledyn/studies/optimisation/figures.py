"""Figures of an evaluation of a study, with all that a search can make use of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.key_figures import figure_slope, gauss_newton
from vehicledyn.analyse.objective import Evaluated, FigureCurve, FigureValue, ObjectiveParts

Floats = NDArray[np.float64]

_DEVIATION = "deviation of "
"""What the name of a deviation begins with, among the parts of an objective."""


@dataclass(frozen=True)
class Figures:
    """Figures by name with gradients (n,), means of scattering ones with their deviations.

    ``samples`` are those that figures are drawn from: kind of the figure, times, values, slopes.
    """

    values: dict[str, float]
    slopes: dict[str, Floats]
    deviations: dict[str, float]
    deviation_slopes: dict[str, Floats]
    samples: dict[str, tuple[str, Floats, Floats, Floats]] = field(default_factory=dict)

    @staticmethod
    def of(entry: dict[str, Any]) -> Figures:
        """Return the figures of an evaluation that was kept."""
        deviations = entry.get("deviations", {})
        slopes, others = (
            {name: np.array(row) for name, row in entry.get(key, {}).items()}
            for key in ("slopes", "deviation_slopes")
        )
        return Figures(
            dict(entry["values"]), slopes, dict(deviations), others, entry.get("samples", {})
        )

    def parts(self, compose: Callable[[Figures], Evaluated]) -> ObjectiveParts:
        """Return them one by one, and how the objective is made of such figures."""
        found = {name: self._part(name) for name in self.values}
        for name, value in self.deviations.items():
            found[f"{_DEVIATION}{name}"] = FigureValue(value, self.deviation_slopes[name])
        return ObjectiveParts(found, lambda parts: compose(_joined(parts)))

    def _part(self, name: str) -> FigureValue:
        """Return a figure with its curve, if it has one."""
        value, slope = self.values[name], self.slopes[name]
        if name not in self.samples:
            return FigureValue(value, slope)
        kind, times, samples, slopes = self.samples[name]

        def draw(moved: Floats, leaning: Floats) -> tuple[float, Floats]:
            found = figure_slope(kind, times, moved, leaning)
            return found.value, found.slope

        bend = gauss_newton(kind, times, samples, slopes)
        return FigureValue(value, slope, bend, FigureCurve(samples, slopes, draw))


def _joined(parts: Mapping[str, FigureValue]) -> Figures:
    """Return figures and deviations that were taken apart."""
    own = {name: item for name, item in parts.items() if not name.startswith(_DEVIATION)}
    others = {
        name.removeprefix(_DEVIATION): item
        for name, item in parts.items()
        if name.startswith(_DEVIATION)
    }
    return Figures(
        {name: item.value for name, item in own.items()},
        {name: item.slope for name, item in own.items()},
        {name: item.value for name, item in others.items()},
        {name: item.slope for name, item in others.items()},
    )
