"""Figures of a railway track: its plan, its design along the chainage, its irregularities."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.plot_style import BLUE, VERMILION, WIDTH, axis_label, plain
from vehicledyn.results.tables.track_table import TrackTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DESIGN = ("curvature", "cant", "gradient")
_RAILS = ("lateral", "vertical")


def track_figures(table: TrackTable) -> Iterator[tuple[str, Figure]]:
    """Give the figures of a table with their names, drawn on demand."""
    if any(np.any(table[name]) for name in _DESIGN):
        yield "plan", _draw_plan(table)
        yield "design", _draw_design(table)
    if any(np.any(table[f"{side}_{way}"]) for side in ("left", "right") for way in _RAILS):
        yield "rails", _draw_rails(table)


def _draw_plan(table: TrackTable) -> Figure:
    x, y = table["x"], table["y"]
    across = (np.ptp(y) + 1.0) / (np.ptp(x) + 1.0)
    height = WIDTH * min(max(across, 0.35), 1.3)
    figure = new_canvas(WIDTH, height)
    axes = figure.subplots()
    axes.plot(x, y, color=BLUE)
    _mark(axes, table)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(axis_label("x", "m"))
    axes.set_ylabel(axis_label("y", "m"))
    figure.suptitle(plain(f"{table.title}, seen from above"), fontsize=10.5, x=0.01, ha="left")
    return figure


def _mark(axes: Axes, table: TrackTable) -> None:
    """Mark chainages along the plan."""
    s = table["s"]
    for place in np.linspace(s[0], s[-1], 6):
        x, y = (float(np.interp(place, s, table[name])) for name in ("x", "y"))
        axes.plot([x], [y], "o", ms=3, color=VERMILION)
        axes.annotate(
            f"{place:.0f} m", (x, y), xytext=(4, 4), textcoords="offset points", fontsize=7.5
        )


def _draw_design(table: TrackTable) -> Figure:
    figure = new_canvas(WIDTH, 0.8 * WIDTH)
    rows = figure.subplots(len(_DESIGN), 1, sharex=True)
    for axes, name in zip(rows, _DESIGN, strict=True):
        axes.plot(table["s"], table[name], color=BLUE)
        axes.set_ylabel(axis_label(name.capitalize(), table.columns[name].unit))
    rows[-1].set_xlabel(axis_label("Chainage", "m"))
    figure.suptitle(plain(table.title), fontsize=10.5, x=0.01, ha="left")
    return figure


def _draw_rails(table: TrackTable) -> Figure:
    figure = new_canvas(WIDTH, 0.55 * WIDTH)
    rows = figure.subplots(2, 1, sharex=True)
    for axes, way, label in zip(rows, _RAILS, ("To the left", "Upwards"), strict=True):
        for side, colour in (("left", BLUE), ("right", VERMILION)):
            axes.plot(table["s"], table[f"{side}_{way}"], lw=0.9, color=colour, label=side)
        axes.set_ylabel(axis_label(label, "mm"))
    rows[0].legend(ncols=2, loc="upper right")
    rows[-1].set_xlabel(axis_label("Chainage", "m"))
    figure.suptitle(
        plain(f"{table.title}, displacement of the rails"), fontsize=10.5, x=0.01, ha="left"
    )
    return figure
