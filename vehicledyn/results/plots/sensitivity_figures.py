"""Figures of derivatives: a tornado for each figure, curves over time for each channel."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.results.plots.figures import new_figure
from vehicledyn.results.plots.plot_style import LINE_STYLES, PALETTE, axis_label, plain
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_BARS, _CURVES = 12, 6
_HEIGHT = 4.6  # inch


def sensitivity_figures(table: SensitivityTable) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of all figures and channels that have derivatives."""
    for row, figure in enumerate(table.figures):
        if np.any(np.nan_to_num(table.elasticities[row])):
            yield f"tornado_{_file_name(figure.name)}", _tornado(table, row)
    for row, channel in enumerate(table.channels):
        yield f"curves_{_file_name(channel.name)}", _curves(table, row)


def _tornado(table: SensitivityTable, row: int) -> Figure:
    """Draw what one per cent more and less of each parameter does to a figure."""
    drawn = new_figure(_HEIGHT)
    axes = drawn.subplots()
    effects = table.elasticities[row]
    chosen = [k for k in table.ranked(row) if effects[k]][:_BARS][::-1]
    places = np.arange(len(chosen))
    for sign, color, words in ((1.0, PALETTE[0], "1 % more"), (-1.0, PALETTE[1], "1 % less")):
        axes.barh(places, sign * effects[chosen], color=color, height=0.7, label=words)
    axes.set_yticks(places, [plain(table.parameters[k].name) for k in chosen])
    figure = table.figures[row]
    axes.set_xlabel(axis_label(f"Change of {plain(figure.name)}", figure.unit))
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.grid(visible=True, axis="x")
    axes.legend(loc="lower right")
    return drawn


def _curves(table: SensitivityTable, row: int) -> Figure:
    """Draw a channel, and below what one per cent of each parameter adds to it over time."""
    drawn = new_figure(_HEIGHT)
    upper, lower = drawn.subplots(2, 1, sharex=True)
    channel = table.channels[row]
    effects = 0.01 * table.channel_slopes[row] * table.parameter_values
    upper.plot(table.time, table.channel_values[row], color=PALETTE[0])
    sizes = np.max(np.abs(effects), axis=0, initial=0.0)
    for number, k in enumerate(np.argsort(-sizes)[:_CURVES]):
        lower.plot(
            table.time,
            effects[:, k],
            color=PALETTE[number % len(PALETTE)],
            linestyle=LINE_STYLES[number % len(LINE_STYLES)],
            label=plain(table.parameters[k].name),
        )
    upper.set_ylabel(axis_label(plain(channel.name), channel.unit))
    lower.set_ylabel(axis_label("Change by 1 %", channel.unit))
    lower.set_xlabel(axis_label("Time", "s"))
    for axes in (upper, lower):
        axes.grid(visible=True)
    lower.legend(loc="upper left", bbox_to_anchor=(0.0, -0.2), ncols=2)
    return drawn


def _file_name(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
