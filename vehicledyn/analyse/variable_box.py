"""Bounds of variables, and their shares of the way from one to the other, linear or by ratios."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.objective import Evaluated, FigureCurve, FigureValue, ObjectiveParts

Floats = NDArray[np.float64]

_BY_RATIO = 10.0
"""Ratio of positive bounds from which equal shares are equal ratios, as of a stiffness."""


class VariableBox:
    """Lowest and highest values of variables, shape (n,) each."""

    def __init__(self, low: Floats, high: Floats) -> None:
        self._low, self._high = low, high
        self._by_ratio = (low > 0.0) & (high >= _BY_RATIO * low)
        ratios = np.divide(high, low, out=np.ones_like(low), where=self._by_ratio)
        self._logs = np.log(ratios)

    def point(self, shares: Floats) -> Floats:
        """Return values of the variables for shares between 0 and 1."""
        straight = self._low + (self._high - self._low) * shares
        curved = np.where(self._by_ratio, self._low, 1.0) * np.exp(self._logs * shares)
        return np.clip(np.where(self._by_ratio, curved, straight), self._low, self._high)

    def shares(self, point: Floats) -> Floats:
        """Return the shares of values within the bounds."""
        ratios = np.where(self._by_ratio, point, 1.0) / np.where(self._by_ratio, self._low, 1.0)
        curved = np.log(ratios) / np.where(self._by_ratio, self._logs, 1.0)
        straight = (point - self._low) / (self._high - self._low)
        return np.asarray(np.clip(np.where(self._by_ratio, curved, straight), 0.0, 1.0))

    def by_shares(self, values: Evaluated, point: Floats) -> Evaluated:
        """Return an evaluation at a point with derivatives by the shares."""
        rates = np.where(self._by_ratio, self._logs * point, self._high - self._low)
        turns = np.where(self._by_ratio, self._logs * rates, 0.0)
        slopes, parts = values.residual_slopes, values.parts
        if parts is not None:
            figures = {name: _moved(item, rates, turns) for name, item in parts.figures.items()}
            parts = ObjectiveParts(figures, parts.compose)
        return replace(
            values,
            gradient=values.gradient * rates,
            jacobian=values.jacobian * rates,
            residual_slopes=None if slopes is None else slopes * rates,
            parts=parts,
        )


def _moved(figure: FigureValue, rates: Floats, turns: Floats) -> FigureValue:
    """Return a figure with derivatives by the shares, second ones by how these bend."""
    slope, bend, curve = figure.slope * rates, figure.bend, figure.curve
    if turns.any():
        own = np.diag(figure.slope * turns)
        bend = own if bend is None else bend * np.outer(rates, rates) + own
    elif bend is not None:
        bend = bend * np.outer(rates, rates)
    if curve is not None:
        curve = FigureCurve(curve.values, curve.slopes * rates, curve.draw)
    return FigureValue(figure.value, slope, bend, curve)
