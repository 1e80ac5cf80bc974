"""Figures of studies of parameters: fits of signals, scatter of figures, courses of searches."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from vehicledyn.results.plots.figures import new_figure
from vehicledyn.results.plots.plot_style import PALETTE, axis_label, plain
from vehicledyn.results.tables.identification_table import IdentificationTable
from vehicledyn.results.tables.optimum_table import OptimumCourse
from vehicledyn.results.tables.uncertainty_table import UncertaintyTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_HEIGHT, _BINS = 4.6, 24  # inch


def identification_figures(table: IdentificationTable) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of each signal: measured and fitted, residuals below."""
    for number, signal in enumerate(table.signals):
        chosen = np.flatnonzero(table.signal == number)
        drawn = new_figure(_HEIGHT)
        upper, lower = drawn.subplots(2, 1, sharex=True)
        time = table.time[chosen]
        upper.plot(time, table.measured[chosen], ".", color=PALETTE[1], label="measured")
        upper.plot(time, table.fitted[chosen], color=PALETTE[0], label="identified")
        lower.plot(time, table.residual[chosen], ".", color=PALETTE[0])
        upper.set_ylabel(axis_label(plain(signal.name), signal.unit))
        lower.set_ylabel(axis_label("Residual by noise", "1"))
        over = table.over[number] if number < len(table.over) else "time [s]"
        name, _, unit = over.rstrip("]").partition(" [")
        lower.set_xlabel(axis_label(plain(name.capitalize()), unit or "1"))
        upper.legend(loc="best")
        for axes in (upper, lower):
            axes.grid(visible=True)
        yield f"fit_{_file_name(signal.name)}", drawn


def uncertainty_figures(table: UncertaintyTable) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of the samples of each figure, and of its shares by parameter."""
    for row, figure in enumerate(table.figures):
        if len(table.samples):
            drawn = new_figure(_HEIGHT)
            axes = drawn.subplots()
            samples = table.samples[:, row]
            axes.hist(samples[np.isfinite(samples)], bins=_BINS, color=PALETTE[0])
            axes.set_xlabel(axis_label(plain(figure.name), figure.unit))
            axes.set_ylabel(axis_label("Runs", "1"))
            axes.grid(visible=True)
            yield f"scatter_{_file_name(figure.name)}", drawn
        if np.isfinite(table.shares[row]).all():
            yield f"shares_{_file_name(figure.name)}", _shares(table, row)


def optimum_figures(course: OptimumCourse) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure of a search's convergence, and of its front of compromises."""
    drawn = new_figure(_HEIGHT)
    upper, lower = drawn.subplots(2, 1, sharex=True)
    runs = np.arange(1, len(course.objective) + 1)
    upper.plot(runs, course.objective, ".-", color=PALETTE[0])
    lower.plot(runs, course.violation, ".-", color=PALETTE[1])
    upper.set_ylabel(axis_label("Objective", "1"))
    lower.set_ylabel(axis_label("Violation", "1"))
    lower.set_xlabel(axis_label("Run", "1"))
    for axes in (upper, lower):
        axes.grid(visible=True)
    yield "convergence", drawn
    if course.front_figure is None:
        return
    drawn = new_figure(_HEIGHT)
    axes = drawn.subplots()
    value, objective = np.array(course.front_value), np.array(course.front_objective)
    kept = np.array(course.front_kept, dtype=bool)
    axes.plot(value[kept], objective[kept], "o-", color=PALETTE[0])
    if not kept.all():
        words = "constraints not kept"
        axes.plot(value[~kept], objective[~kept], "x", color=PALETTE[1], label=words)
        axes.legend(loc="best")
    axes.set_xlabel(axis_label(plain(course.front_figure.name), course.front_figure.unit))
    axes.set_ylabel(axis_label("Objective", "1"))
    axes.grid(visible=True)
    yield "front", drawn


def _shares(table: UncertaintyTable, row: int) -> Figure:
    """Draw what part of a figure's variance each parameter brings, largest on top."""
    drawn = new_figure(_HEIGHT)
    axes = drawn.subplots()
    order = np.argsort(table.shares[row])
    places = np.arange(len(order))
    totals = table.totals[row][order]
    if np.isfinite(totals).all():
        errors = _errors(table.totals_error, row, order)
        axes.barh(
            places, totals, color=PALETTE[1], height=0.7, label="with interactions", xerr=errors
        )
    errors = _errors(table.shares_error, row, order)
    axes.barh(
        places, table.shares[row][order], color=PALETTE[0], height=0.4, label="alone", xerr=errors
    )
    axes.set_yticks(places, [plain(table.parameters[k].name) for k in order])
    name = plain(table.figures[row].name)
    axes.set_xlabel(axis_label(f"Part of the variance of {name}", "1"))
    axes.grid(visible=True, axis="x")
    axes.legend(loc="lower right")
    return drawn


def _errors(errors: Any, row: int, order: Any) -> Any:
    """Return standard errors in some order, None where there are none."""
    found = None if errors is None else errors[row][order]
    return found if found is not None and np.isfinite(found).all() else None


def _file_name(name: str) -> str:
    return re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")
