"""Drawing one figure from a result: a canvas, lines in a fixed style, labelled axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import errors_of
from vehicledyn.results.plots.arrangement import arranged
from vehicledyn.results.plots.path_figure import draw_path
from vehicledyn.results.plots.plot_description import Panel, PathPlot, Plot, TimePlot, unit_factor
from vehicledyn.results.plots.plot_style import (
    LEGEND_SIZE,
    LINE_STYLES,
    PALETTE,
    WIDTH,
    axis_label,
    plain,
)
from vehicledyn.results.store.reader import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

PANEL_HEIGHT = 1.75  # inch
HEADING_HEIGHT = 0.95  # inch: title, time axis and footer
LONGEST_FOOTER = 160  # characters
LONGEST_LABEL = 42  # characters of a legend in full size, two beside each other
ROUNDING = 1e-9  # of the values' size, at least of 1 in the unit shown


def draw_figure(result: Result, plot: Plot) -> Figure:
    """Return the figure a plot asks for, ready to be saved.

    Raises
    ------
    InputError
        If the result lacks a channel or a unit does not fit.
    """
    with errors_of(result.path):
        if isinstance(plot, TimePlot) and plot.arranged:
            plot = arranged(result, plot)
        figure = _time_figure(result, plot) if isinstance(plot, TimePlot) else _path(result, plot)
    figure.suptitle(_title(result, plot), fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    figure.supxlabel(_origin(result), fontsize=6.5, color="0.45", x=0.99, ha="right")
    return figure


def new_figure(height: float) -> Figure:
    """Return an empty figure of the report's width on a canvas without a window."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _path(result: Result, plot: PathPlot) -> Figure:
    return draw_path(result, plot, new_figure)


def _time_figure(result: Result, plot: TimePlot) -> Figure:
    figure = new_figure(HEADING_HEIGHT + PANEL_HEIGHT * max(len(plot.panels), 1.4))
    axes = figure.subplots(len(plot.panels), 1, sharex=True, squeeze=False)[:, 0]
    across, label = _across(result, plot)
    for place, panel in zip(axes, plot.panels, strict=True):
        _draw_panel(place, result, panel, across, named=plot.arranged)
    axes[-1].set_xlabel(label)
    figure.align_ylabels(axes)
    return figure


def _across(result: Result, plot: TimePlot) -> tuple[Floats, str]:
    """Return the values along the horizontal axis and its label."""
    if not plot.x:
        return result.time, axis_label("Time", "s")
    series = result.channel(plot.x)
    unit = plot.x_unit or series.unit
    return series.values * unit_factor(series.unit, unit), axis_label(plot.x, unit)


def _in_order(across: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Return points to join by a line, with a gap wherever the sweep begins anew."""
    steps = np.diff(across)
    back = np.flatnonzero(steps * np.sign(np.median(steps)) < 0.0) + 1 if steps.size else steps
    gaps = back.astype(int)
    return np.insert(across, gaps, np.nan), np.insert(values, gaps, np.nan)


def _draw_panel(axes: Axes, result: Result, panel: Panel, across: Floats, *, named: bool) -> None:
    for index, (name, label) in enumerate(zip(panel.channels, panel.labels, strict=True)):
        series = result.channel(name)
        style: dict[str, Any] = {
            "color": PALETTE[index % len(PALETTE)],
            "linestyle": LINE_STYLES[index % len(LINE_STYLES)],
        }
        values = series.values * unit_factor(series.unit, panel.unit)
        axes.plot(*_in_order(across, values), label=plain(label), **style)
    _keep_rounding_small(axes)
    axes.set_ylabel(axis_label(panel.label, panel.unit))
    if len(across) > 1 and np.ptp(across) > 0.0:
        axes.set_xlim(float(across.min()), float(across.max()))
    if named or len(panel.channels) > 1:
        longest = max(len(plain(label)) for label in panel.labels)
        columns = 4 if longest <= 14 else 3 if longest <= 22 else 2
        smaller = min(1.0, LONGEST_LABEL / longest)
        axes.legend(
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncols=columns,
            fontsize=LEGEND_SIZE * smaller,
        )


def _keep_rounding_small(axes: Axes) -> None:
    """Widen a scale that would show nothing but rounding errors."""
    low, high = axes.get_ylim()
    centre = 0.5 * (low + high)
    size = max(1.0, abs(centre))
    if high - low < ROUNDING * size:
        axes.set_ylim(centre - 0.05 * size, centre + 0.05 * size)


def _title(result: Result, plot: Plot) -> str:
    title = plain(plot.title)
    return title if result.is_whole else f"{title}\n({plain(result.state_of_run)})"


def _origin(result: Result) -> str:
    model = f"{result.model} {result.model_hash[:12]}".strip()
    text = f"{result.title}   |   {model}   |   vehicledyn {result.program_version}"
    return plain(text, LONGEST_FOOTER)
