"""The root locus of a hunting study: damping, frequency and growth of small motions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.plots.figures import new_figure
from vehicledyn.results.plots.plot_style import (
    BLACK,
    BLUE,
    VERMILION,
    axis_label,
    in_words,
    plain,
)
from vehicledyn.results.plots.scales import MOST_IN_DECADES, in_decades, plain_ticks
from vehicledyn.results.tables.hunt_table import HuntTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_DAMPING = 0.3
"""Damping ratio up to which oscillations are shown; those near stability's end are below it."""

HOPF = ("linear_critical", "oscillation_ceases")
"""Critical values at which a pair of eigenvalues crosses the imaginary axis."""

_HEIGHT = 6.2  # inch
_SLOWEST = 0.02  # Hz, below it eigenvalues count as no oscillation
_GROWS = 1e-6  # 1/s, rounding of a growth rate of zero
_LEAST_SPAN = 0.02
_LINEAR_UP_TO = 1.0  # 1/s


def locus_figure(table: HuntTable) -> Figure:
    """Return damping ratio, frequency and real part against the parameter.

    Growing motions are vermilion, Hopf bifurcations diamonds. Oscillations with more than
    ``MOST_DAMPING`` are left out of the first two panels; real parts are on a logarithmic scale
    but for a linear one about zero.
    """
    figure = new_figure(_HEIGHT)
    panels = figure.subplots(3, 1, sharex=True)
    roots = np.asarray(table.eigenvalues)
    beyond = np.maximum(np.abs(roots.real), np.abs(roots.imag)) > MOST_IN_DECADES
    roots = np.where(beyond, np.nan, roots)
    values = np.broadcast_to(np.asarray(table.locus_values)[:, None], roots.shape)
    hertz = np.abs(roots.imag) / (2.0 * np.pi)
    size = np.abs(roots)
    damping = -roots.real / np.where(size > 0.0, size, 1.0)
    seen = (hertz > _SLOWEST) & (damping < MOST_DAMPING)
    grows = roots.real > _GROWS
    _dots(panels[0], values, 100.0 * damping, seen, grows)
    _dots(panels[1], values, hertz, seen, grows)
    _dots(panels[2], values, roots.real, np.ones_like(seen), grows)
    _mark_bifurcations(panels, table)
    if seen.any():
        low = min(-_LEAST_SPAN, 1.15 * float(damping[seen].min()))
        panels[0].set_ylim(100.0 * low, 100.0 * MOST_DAMPING)
        panels[1].set_yscale("log")
        plain_ticks(panels[1].yaxis)
    panels[2].set_yscale("symlog", linthresh=_LINEAR_UP_TO)
    known = roots.real[~np.isnan(roots.real)]
    if known.size:
        low, high = (float(pick(known)) for pick in (np.min, np.max))
        panels[2].set_ylim(min(2.0 * low, -_LINEAR_UP_TO), max(2.0 * high, _LINEAR_UP_TO))
    plain_ticks(panels[2].yaxis)
    for axes, label, unit in zip(
        panels, ("Damping ratio", "Frequency", "Real part"), ("%", "Hz", "1/s"), strict=True
    ):
        axes.set_ylabel(axis_label(label, unit))
        if label != "Frequency":
            axes.axhline(0.0, color="0.4", linewidth=0.8)
    words = in_words(table.parameter.name, table.parameter.description)
    panels[-1].set_xlabel(axis_label(words, table.parameter.unit))
    figure.align_ylabels(panels)
    return figure


def _mark_bifurcations(panels: Sequence[Axes], table: HuntTable) -> None:
    """Mark where an oscillation begins or ceases to grow: damping and real part are zero."""
    first, last = (pick(table.locus_values, initial=0.0) for pick in (np.min, np.max))
    for name in HOPF:
        value, hertz = (table.figures.get(key) for key in (name, f"{name}_frequency"))
        if value is None or not first <= value <= last:
            continue
        heights = (0.0, float(in_decades(np.nan if hertz is None else hertz)), 0.0)
        text = f"Hopf bifurcation, {value:.5g} {table.parameter.unit}"
        text += "" if hertz is None else f", {hertz:.4g} Hz"
        for number, (axes, height) in enumerate(zip(panels, heights, strict=True)):
            axes.axvline(value, color="0.4", linewidth=0.8, linestyle="--")
            label = None if number else plain(text)
            axes.plot([value], [height], "D", color=BLACK, markersize=5.0, label=label)
    if panels[0].get_legend_handles_labels()[1]:
        panels[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)


def _dots(
    axes: Axes,
    values: NDArray[np.float64],
    heights: NDArray[np.float64],
    seen: NDArray[np.bool_],
    grows: NDArray[np.bool_],
) -> None:
    for chosen, colour in ((seen & ~grows, BLUE), (seen & grows, VERMILION)):
        axes.plot(values[chosen], heights[chosen], ".", color=colour, markersize=3.0)
