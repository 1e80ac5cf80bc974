"""Figures of a fitted tyre: measured forces beside those of the law."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.plot_style import BLUE, VERMILION, WIDTH, axis_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
_UNITS = {"longitudinal_force": "N", "lateral_force": "N", "aligning_moment": "N m"}


def fit_figures(
    inputs: Mapping[str, Array], measured: Mapping[str, Array], fitted: Mapping[str, Array]
) -> Iterator[tuple[str, Figure]]:
    """Give the figures of a fit with their names, drawn on demand."""
    for name in measured:
        yield f"fit_{name}", _draw(name, inputs, measured[name], fitted[name])


def _draw(name: str, inputs: Mapping[str, Array], measured: Array, fitted: Array) -> Figure:
    figure = new_canvas(WIDTH, 0.5 * WIDTH)
    left, right = figure.subplots(1, 2)
    along = name == "longitudinal_force"
    slip = inputs["longitudinal_slip"] if along else inputs["slip_angle"] * 180.0 / math.pi
    left.plot(slip, measured, ".", ms=3, color=VERMILION, label="measured")
    left.plot(slip, fitted, ".", ms=2, color=BLUE, label="fitted")
    left.set_xlabel(axis_label(*(("Longitudinal slip", "1") if along else ("Slip angle", "deg"))))
    left.set_ylabel(axis_label(name.replace("_", " ").capitalize(), _UNITS[name]))
    left.legend(loc="best")
    right.plot(slip, fitted - measured, ".", ms=3, color=BLUE)
    right.axhline(0.0, color="0.5", lw=0.8)
    right.set_xlabel(left.get_xlabel())
    right.set_ylabel(axis_label("Residual", _UNITS[name]))
    return figure
