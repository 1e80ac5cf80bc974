"""Figures of an optimal manoeuvre: controls, states against their simulation, the path."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from vehicledyn.results.plots.figures import new_figure
from vehicledyn.results.plots.plot_style import PALETTE, axis_label, plain
from vehicledyn.results.plots.scales import decade_ticks
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.manoeuvre_table import ManoeuvreTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_HEIGHT = 4.0
_MOST = 6


def manoeuvre_figures(table: ManoeuvreTable) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of controls, of the states that move most, of path and convergence."""
    yield (
        "controls",
        _rows(table, [(q, [v]) for q, v in _pairs(table.controls, table.control_values)]),
    )
    moving = np.argsort(-np.ptp(table.state_values, axis=0), kind="stable")[:_MOST]
    found = [table.state_values, table.simulated] if table.is_checked else [table.state_values]
    rows = [(table.states[k], [values[:, k] for values in found]) for k in sorted(moving)]
    if rows:
        yield "states", _rows(table, rows)
    if np.shape(table.path)[1]:
        yield "path", _corridor(table)
    if len(table.history):
        yield "convergence", _convergence(table)


def _pairs(quantities: Sequence[Quantity], values: Any) -> Iterator[tuple[Quantity, Any]]:
    return zip(quantities, np.asarray(values).T, strict=True)


def _rows(table: ManoeuvreTable, rows: Sequence[tuple[Quantity, list[Any]]]) -> Figure:
    """Draw quantities over time below each other; the second curve is dashed."""
    drawn = new_figure(max(_HEIGHT, 1.5 * len(rows)))
    axes = np.atleast_1d(drawn.subplots(len(rows), 1, sharex=True))
    for place, (quantity, curves) in zip(axes, rows, strict=True):
        for k, values in enumerate(curves):
            words = ("optimal", "simulated")[k]
            style = ("-", "--")[k]
            place.plot(table.time, values, style, color=PALETTE[k], label=words)
        place.set_ylabel(axis_label(plain(quantity.name), quantity.unit), fontsize="x-small")
        place.grid(visible=True)
    if len(rows[0][1]) > 1:
        axes[0].legend(loc="best", fontsize="x-small")
    axes[-1].set_xlabel(axis_label("Time", "s"))
    return drawn


def _corridor(table: ManoeuvreTable) -> Figure:
    drawn = new_figure(_HEIGHT)
    axes = drawn.subplots()
    distance, offset, right, left = np.asarray(table.path).T
    axes.fill_between(distance, right, left, color=PALETTE[1], alpha=0.2, label="corridor")
    axes.plot(distance, offset, color=PALETTE[0], label="motion")
    axes.set_xlabel(axis_label("Distance along the path", "m"))
    axes.set_ylabel(axis_label("Offset to the left", "m"))
    reach = max(np.ptp(offset), 0.1)
    low, high = offset.min() - reach, offset.max() + reach
    axes.set_ylim(max(low, right.min() - 0.1 * reach), min(high, left.max() + 0.1 * reach))
    axes.grid(visible=True)
    axes.legend(loc="best", fontsize="x-small")
    return drawn


def _convergence(table: ManoeuvreTable) -> Figure:
    drawn = new_figure(_HEIGHT)
    upper, lower = drawn.subplots(2, 1, sharex=True)
    steps = np.arange(1, len(table.history) + 1)
    upper.plot(steps, table.history[:, 0], color=PALETTE[0])
    lower.semilogy(steps, np.maximum(table.history[:, 1], 1e-16), color=PALETTE[1])
    decade_ticks(lower.yaxis)
    upper.set_ylabel(axis_label("Objective", "1"))
    lower.set_ylabel(axis_label("Violation", "1"))
    lower.set_xlabel(axis_label("Iteration", "1"))
    for axes in (upper, lower):
        axes.grid(visible=True)
    return drawn
