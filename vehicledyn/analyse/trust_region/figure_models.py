"""Models of figures by what runs gave: each as a number, or drawn from a modelled curve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

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


@dataclass
class ModelErrors:
    """How far models of figures as numbers and as drawn from curves were off, in later runs."""

    as_number: dict[str, float] = field(default_factory=dict)
    by_curve: dict[str, float] = field(default_factory=dict)

    def note(self, models: FigureModels, run: EvaluatedPoint) -> None:
        """Compare models with a run that was made after them."""
        for name, figure in run.figures.items():
            for known, kinds in (
                (self.as_number, models.numbers),
                (self.by_curve, models.curves),
            ):
                if name in kinds:
                    error = abs(kinds[name].at(run.point).value - figure.value)
                    known[name] = _NEW * error + (1.0 - _NEW) * known.get(name, error)

    def prefer_curve(self, name: str) -> bool:
        """Return whether a figure is better drawn from its curve."""
        return self.by_curve.get(name, 0.0) <= self.as_number.get(name, np.inf)


class FigureModels:
    """Models of all figures around the first of some runs.

    A mean square of a curve is nearly a square of the variables, which a model of the curve knows
    after one run; the mean square of an oscillation whose phase moves is better modelled itself.
    Which way was closer in the runs so far decides.

    Parameters
    ----------
    runs
        The centre first.
    errors
        Of the models so far.
    """

    def __init__(self, runs: Sequence[EvaluatedPoint], errors: ModelErrors) -> None:
        points = np.array([run.point for run in runs])
        self.numbers: dict[str, _Number] = {}
        self.curves: dict[str, _Drawn] = {}
        for name in runs[0].figures:
            figures = [run.figures[name] for run in runs]
            self.numbers[name] = _Number(points, figures)
            curves = [item.curve for item in figures if item.curve is not None]
            if len({item.values.shape for item in curves}) == 1 and len(curves) == len(runs):
                self.curves[name] = _Drawn(points, curves)
        self._used: dict[str, _Number | _Drawn] = {
            name: self.curves[name]
            if name in self.curves and errors.prefer_curve(name)
            else self.numbers[name]
            for name in self.numbers
        }

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


class _Drawn:
    """A figure that is drawn from samples, each a function of the variables."""

    def __init__(self, points: Floats, curves: Sequence[FigureCurve]) -> None:
        self._draw = curves[0].draw
        values, slopes = [item.values for item in curves], [item.slopes for item in curves]
        self._found = Interpolant(points, np.array(values), np.array(slopes))

    def at(self, x: Floats) -> FigureValue:
        """Return the figure at a point."""
        return FigureValue(*self._draw(*self._found(x)))
