"""Drawing one figure from a result: a canvas, lines in a fixed style, labelled axes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import errors_of
from vehicledyn.results.plots.absent_contacts import shown_values
from vehicledyn.results.plots.arrangement import arranged
from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.path_figure import draw_path
from vehicledyn.results.plots.plot_description import Panel, Plot, TimePlot, unit_factor
from vehicledyn.results.plots.plot_style import (
    LEGEND_SIZE,
    LINE_STYLES,
    PALETTE,
    WIDTH,
    axis_label,
    plain,
)
from vehicledyn.results.plots.scales import leave_room
from vehicledyn.results.store.reader import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

PANEL_HEIGHT = 1.75  # inch
HEADING_HEIGHT = 0.95  # inch: title, time axis and footer
LONGEST_FOOTER = 120  # characters: as many as the width takes
LONGEST_LABEL = 42  # characters of a legend in full size, two beside each other


def draw_figure(result: Result, plot: Plot, *, beside: Sequence[Result] = ()) -> Figure:
    """Return the figure a plot asks for, ready to be saved.

    Parameters
    ----------
    result
        An open result with samples.
    plot
        What to draw.
    beside
        Results to be laid over it: a path leaves room for theirs.

    Raises
    ------
    InputError
        If the result lacks a channel or a unit does not fit.
    """
    with errors_of(result.path):
        if isinstance(plot, TimePlot) and plot.arranged:
            plot = replace(arranged(result, plot), named=True)
        if isinstance(plot, TimePlot):
            figure = _time_figure(result, plot)
        else:
            figure = draw_path(result, plot, new_figure, beside)
    figure.suptitle(_title(result, plot), fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    figure.supxlabel(_origin(result), fontsize=6.5, color="0.45", x=0.99, ha="right")
    return figure


def new_figure(height: float) -> Figure:
    """Return an empty figure of the report's width on a canvas without a window."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = new_canvas(WIDTH, height)
    FigureCanvasAgg(figure)
    return figure


def _time_figure(result: Result, plot: TimePlot) -> Figure:
    figure = new_figure(HEADING_HEIGHT + PANEL_HEIGHT * max(len(plot.panels), 1.4))
    axes = figure.subplots(len(plot.panels), 1, sharex=True, squeeze=False)[:, 0]
    across, label = _across(result, plot)
    for place, panel in zip(axes, plot.panels, strict=True):
        _draw_panel(place, result, panel, across, named=plot.named)
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
    """Return points to join by a line, with a gap wherever the sweep begins again."""
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
        values = shown_values(result, name) * unit_factor(series.unit, panel.unit)
        axes.plot(*_in_order(across, values), label=plain(label), **style)
    leave_room(axes)
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


def _title(result: Result, plot: Plot) -> str:
    title = plain(plot.title)
    return title if result.is_whole else f"{title}\n({plain(result.state_of_run)})"


def _origin(result: Result) -> str:
    model = f"{result.model.rsplit('/', 1)[-1]} {result.model_hash[:12]}".strip()
    origin = plain(f"{model}   |   vehicledyn {result.program_version}", LONGEST_FOOTER - 40)
    return f"{plain(result.title, LONGEST_FOOTER - len(origin) - 7)}   |   {origin}"
