"""Bode figures of frequency responses: magnitude and phase against frequency."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.results.plots.figures import new_figure
from vehicledyn.results.plots.plot_style import LINE_STYLES, PALETTE, axis_label, plain
from vehicledyn.results.plots.scales import decade_ticks, in_decades
from vehicledyn.results.tables.response_table import ResponseTable, ratio_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HEIGHT = 4.6  # inch


def bode_figures(table: ResponseTable) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure for each output; all inputs of one unit share a figure."""
    for k, output in enumerate(table.outputs):
        units = dict.fromkeys(item.unit for item in table.inputs)
        for number, unit in enumerate(units):
            chosen = [i for i, item in enumerate(table.inputs) if item.unit == unit]
            name = re.sub(r"[^A-Za-z0-9]+", "_", output.name).strip("_")
            suffix = f"_{number + 1}" if len(units) > 1 else ""
            yield f"bode_{name}{suffix}", _figure(table, k, chosen)


def _figure(table: ResponseTable, output: int, inputs: list[int]) -> Figure:
    figure = new_figure(HEIGHT)
    upper, lower = figure.subplots(2, 1, sharex=True)
    magnitudes, phases = table.magnitude, np.degrees(table.phase)
    for number, i in enumerate(inputs):
        style = {
            "color": PALETTE[number % len(PALETTE)],
            "linestyle": LINE_STYLES[number % len(LINE_STYLES)],
            "label": plain(table.inputs[i].name),
        }
        upper.plot(table.frequency, in_decades(magnitudes[:, i, output]), **style)
        lower.plot(table.frequency, phases[:, i, output], **style)
    target, unit = table.outputs[output], table.inputs[inputs[0]].unit
    if np.isfinite(magnitudes[:, inputs, output]).any() and magnitudes[:, inputs, output].any():
        upper.set_yscale("log")
        decade_ticks(upper.yaxis)
    first, last = (float(table.frequency[k]) if len(table.frequency) else 0.0 for k in (0, -1))
    if abs(last - first) > 1e-9 * max(abs(first), abs(last)):
        upper.set_xlim(first, last)
        steps = np.diff(table.frequency)
        if not np.allclose(steps, steps[0]):
            upper.set_xscale("log")
            decade_ticks(upper.xaxis)
    upper.set_ylabel(axis_label("Magnitude", ratio_unit(target.unit, unit)))
    lower.set_ylabel(axis_label("Phase", "deg"))
    lower.set_xlabel(axis_label("Frequency", "Hz"))
    for axes in (upper, lower):
        axes.grid(visible=True, which="both")
    if len(inputs) > 1:
        upper.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
    figure.align_ylabels((upper, lower))
    given = table.inputs[inputs[0]].name if len(inputs) == 1 else "the inputs"
    speed = f" at {table.speed:g} m/s" if table.speed else ""
    title = plain(f"{target.name} by {given}{speed}")
    figure.suptitle(title, fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    figure.supxlabel(plain(table.title), fontsize=6.5, color="0.45", x=0.99, ha="right")
    return figure
