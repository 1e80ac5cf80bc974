"""Figures of a study as curves: key figures over what was varied, and channels of all cases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.units import shown
from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.plot_description import unit_factor
from vehicledyn.results.plots.plot_style import (
    BLUE,
    LINE_STYLES,
    PALETTE,
    VERMILION,
    WIDTH,
    axis_label,
    in_words,
    plain,
)
from vehicledyn.results.plots.scales import leave_room, suitable_unit
from vehicledyn.results.store.study_reader import StudyFile

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_PANELS = 12
MOST_CASES = 500
"""Cases whose samples are read for the bands of the channels."""

MOST_LINES = 6
"""Cases up to which each is drawn as a line of its own."""

MOST_VALUES = 10_000_000
"""Samples that are read for the channels; of more only every so many-th."""

COLUMNS = 3
_ROW = 1.8  # inch
_BAND = (5.0, 50.0, 95.0)
_LONGEST = 30
"""Letters of an axis's label in one line."""


class Varied(NamedTuple):
    """What was varied: its name, unit and the values of the cases."""

    name: str
    unit: str
    values: NDArray[Any]


def grid_of(count: int, title: str, *, share_x: bool = False) -> tuple[Figure, list[Axes]]:
    """Return a figure with a number of panels; those at the bottom have tick labels."""
    rows, columns = -(-count // COLUMNS), min(count, COLUMNS)
    figure = new_canvas(WIDTH, 0.6 + _ROW * rows)
    grid = figure.subplots(rows, columns, squeeze=False, sharex=share_x)
    for axes in grid.ravel()[count:]:
        axes.set_visible(False)
    for axes in lowest(list(grid.ravel()[:count])):
        axes.tick_params(labelbottom=True)
    figure.suptitle(title, fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    return figure, list(grid.ravel()[:count])


def lowest(panels: Sequence[Axes]) -> list[Axes]:
    """Return the panels that have none below them."""
    return list(panels[-COLUMNS:])


def label_of(name: str, description: str, unit: str) -> str:
    """Return the label of an axis in words, in two lines where they are long."""
    words = in_words(name, description)
    if len(words) > _LONGEST:
        parts = words.split(" ")
        half = next(
            k for k in range(1, len(parts) + 1) if len(" ".join(parts[:k])) > len(words) / 2
        )
        words = "\n".join(filter(None, (" ".join(parts[:half]), " ".join(parts[half:]))))
    return axis_label(words, unit)


def draw_dependence(
    file: StudyFile, figures: Mapping[str, NDArray[Any]], axis: Varied, title: str
) -> Figure:
    """Return key figures over the one quantity that was varied."""
    figure, grid = grid_of(len(figures), title, share_x=True)
    order = np.argsort(axis.values, kind="stable")
    across_unit = suitable_unit(axis.unit, axis.values)
    across = axis.values[order] * unit_factor(axis.unit, across_unit)
    for axes, (name, column) in zip(grid, figures.items(), strict=True):
        facts = file.figures[name]
        unit = suitable_unit(facts.unit, column)
        heights = column[order] * unit_factor(facts.unit, unit)
        axes.plot(across, heights, ".-", color=BLUE, linewidth=0.9, markersize=5.0)
        leave_room(axes)
        axes.set_ylabel(label_of(name, facts.description, unit), fontsize=7.0)
    for axes in lowest(grid):
        axes.set_xlabel(label_of(axis.name.rpartition(".")[2], "", across_unit))
    return figure


def draw_channels(
    file: StudyFile, good: NDArray[np.intp], varied: Sequence[Varied], title: str
) -> Figure:
    """Return the channels over time: of few cases each by a line, of many the bands they fill."""
    step = max(1, -(-len(good) // MOST_CASES))
    chosen = good[::step]
    channels = file.channels[:MOST_PANELS]
    every = max(1, -(-len(chosen) * len(file.times) * len(channels) // MOST_VALUES))
    is_few = len(chosen) <= MOST_LINES
    what = (
        "channels" if is_few else f"median and {_BAND[0]:g}–{_BAND[2]:g} % of {len(chosen)} cases"
    )
    figure, grid = grid_of(len(channels), f"{title}: {what}", share_x=True)
    samples = np.stack([file.samples(int(case), every, len(channels)) for case in chosen])
    times = file.times[::every]
    for number, (axes, channel) in enumerate(zip(grid, channels, strict=True)):
        unit = suitable_unit(channel.unit, samples[:, :, number])
        values = samples[:, :, number] * unit_factor(channel.unit, unit)
        if is_few:
            for case, line in enumerate(values):
                axes.plot(
                    times,
                    line,
                    color=PALETTE[case % len(PALETTE)],
                    linestyle=LINE_STYLES[case % len(LINE_STYLES)],
                    label=_case_label(varied, case, int(chosen[case])),
                )
        else:
            _band(axes, times, values)
        leave_room(axes)
        axes.set_title(plain(channel.name), fontsize=7.5, loc="left")
        words = channel.description if channel.description != channel.name else ""
        axes.set_ylabel(axis_label(words if len(words) <= _LONGEST else "", unit), fontsize=7.0)
    for axes in lowest(grid):
        axes.set_xlabel(axis_label("Time", "s"))
    if is_few:
        handles, labels = grid[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure


def _band(axes: Axes, times: Any, values: Any) -> None:
    reached = np.isfinite(values).any(axis=0)
    low, middle, high = np.nanpercentile(values[:, reached], _BAND, axis=0)
    axes.fill_between(times[reached], low, high, color=BLUE, alpha=0.25, linewidth=0.0)
    axes.plot(times[reached], middle, color=VERMILION)


def _case_label(varied: Sequence[Varied], place: int, number: int) -> str:
    """Return what a case is: the values of what was varied, at most two, else its number."""
    if not 0 < len(varied) <= 2:
        return f"case {number}"
    parts = [
        f"{in_words(name.rpartition('.')[2], '')} {shown(float(values[place]), unit)}"
        for name, unit, values in varied
    ]
    return plain(", ".join(parts))
