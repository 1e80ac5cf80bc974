"""Models of figures by what runs gave: as numbers, by logarithms, or drawn from modelled curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.objective import FigureCurve, FigureValue
from vehicledyn.analyse.trust_region.interpolant import Interpolant

Floats = NDArray[np.float64]

_NEW = 0.7
"""Share of the last error in the one that a way of modelling is judged by."""


@dataclass(frozen=True)
class EvaluatedPoint:
    """A point (n,), with the figures there and gradients by its scaled variables."""

    point: Floats
    figures: Mapping[str, FigureValue]


class FigureModel(Protocol):
    """A figure as a function of the variables."""

    def at(self, x: Floats) -> FigureValue:
        """Return the figure at a point."""


@dataclass
class ModelErrors:
    """How far each way of modelling a figure was off in the runs made after it, by figures."""

    known: dict[str, dict[str, float]] = field(default_factory=dict)

    def note(self, models: FigureModels, run: EvaluatedPoint) -> None:
        """Compare models with a run that was made after them."""
        for name, ways in models.ways.items():
            known = self.known.setdefault(name, {})
            for way, model in ways.items():
                error = abs(model.at(run.point).value - run.figures[name].value)
                known[way] = _NEW * error + (1.0 - _NEW) * known.get(way, error)

    def best(self, name: str, ways: Mapping[str, FigureModel]) -> FigureModel:
        """Return the model of a figure that was closest, the first one of those not judged."""
        known = self.known.get(name, {})
        return ways[min(ways, key=lambda way: known.get(way, 0.0 if not known else np.inf))]


class FigureModels:
    """Models of all figures around the first of some runs.

    A mean square of a curve is nearly a square of the variables, which a model of the curve knows
    after one run; the mean square of an oscillation whose phase moves is better modelled itself,
    and what grows by factors by its logarithm. Which was closest in the runs so far decides.

    Parameters
    ----------
    runs
        The centre first.
    errors
        Of the models so far.
    """

    def __init__(self, runs: Sequence[EvaluatedPoint], errors: ModelErrors) -> None:
        points = np.array([run.point for run in runs])
        self.ways: dict[str, dict[str, FigureModel]] = {}
        for name in runs[0].figures:
            figures = [run.figures[name] for run in runs]
            ways = self.ways[name] = {}
            curves = [item.curve for item in figures if item.curve is not None]
            if len({item.values.shape for item in curves}) == 1 and len(curves) == len(runs):
                ways["curve"] = _Drawn(points, curves)
            ways["number"] = _Number(points, figures)
            if min(item.value for item in figures) > 0.0:
                ways["logarithm"] = _Logarithm(points, figures)
        self._used = {name: errors.best(name, ways) for name, ways in self.ways.items()}

    def at(self, x: Floats) -> dict[str, FigureValue]:
        """Return the figures that the models have at a point."""
        return {name: model.at(x) for name, model in self._used.items()}


class _Number:
    """A figure as a function of the variables."""

    def __init__(self, points: Floats, figures: Sequence[FigureValue]) -> None:
        bend = figures[0].bend
        self._found = Interpolant(
            points,
            np.array([[item.value] for item in figures]),
            np.array([[item.slope] for item in figures]),
            None if bend is None else bend[None],
        )

    def at(self, x: Floats) -> FigureValue:
        """Return the figure at a point."""
        value, slope = self._found(x)
        return FigureValue(float(value[0]), slope[0])


class _Logarithm:
    """A figure whose logarithm is a function of the variables."""

    def __init__(self, points: Floats, figures: Sequence[FigureValue]) -> None:
        self._found = _Number(points, [_logarithm(item) for item in figures])

    def at(self, x: Floats) -> FigureValue:
        """Return the figure at a point."""
        found = self._found.at(x)
        value = float(np.exp(min(found.value, _MOST_LOG)))
        return FigureValue(value, value * found.slope)


_MOST_LOG = 200.0
"""Logarithm of the largest figure of a model."""


def _logarithm(figure: FigureValue) -> FigureValue:
    """Return the logarithm of a figure."""
    slope, bend = figure.slope / figure.value, figure.bend
    bend = None if bend is None else bend / figure.value - np.outer(slope, slope)
    return FigureValue(float(np.log(figure.value)), slope, bend)


class _Drawn:
    """A figure that is drawn from samples, each a function of the variables."""

    def __init__(self, points: Floats, curves: Sequence[FigureCurve]) -> None:
        self._draw = curves[0].draw
        values, slopes = [item.values for item in curves], [item.slopes for item in curves]
        self._found = Interpolant(points, np.array(values), np.array(slopes))

    def at(self, x: Floats) -> FigureValue:
        """Return the figure at a point."""
        return FigureValue(*self._draw(*self._found(x)))
