"""Figures of a hunting study: bifurcation diagram, period, root locus, and the motion."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from vehicledyn.results.plots.branch_curve import POINTS, branch_curve
from vehicledyn.results.plots.figures import new_figure
from vehicledyn.results.plots.linear.root_locus import HOPF, locus_figure
from vehicledyn.results.plots.plot_description import unit_factor
from vehicledyn.results.plots.plot_style import (
    BLACK,
    BLUE,
    GREEN,
    PALETTE,
    VERMILION,
    axis_label,
    in_words,
    plain,
)
from vehicledyn.results.plots.scales import leave_room
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.hunt_table import SETTLED, CycleRow, HuntTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_PANELS = 4
KINDS = {
    "fold": ("o", "fold"),
    "period_doubling": ("s", "period doubling"),
    "torus": ("D", "torus"),
    "branch_point": ("^", "branch point"),
}
_HEADING, _PANEL = 1.0, 2.2  # inch
_THOUSANDTHS, _SMALL = {"m": "mm", "rad": "mrad"}, 0.1
_GROWS = 1e-6  # 1/s, rounding of a growth rate of zero


def hunt_figures(table: HuntTable) -> Iterator[tuple[str, Figure]]:
    """Yield name and figure: diagram, root locus, and where there are cycles their motion."""
    yield "bifurcation", _diagram(table)
    yield "root_locus", _entitled(locus_figure(table), "Eigenvalues of the equilibrium", table)
    if table.cycles:
        yield "motion", _motion(table)


def _diagram(table: HuntTable) -> Figure:
    """Amplitudes and period against the parameter: stable solid, unstable dashed."""
    watched = table.channels[:MOST_PANELS]
    units, scales = _shown(table)
    figure = new_figure(_HEADING + _PANEL * (len(watched) + 1))
    panels = figure.subplots(len(watched) + 1, 1, sharex=True, squeeze=False)[:, 0]
    for k, (axes, channel) in enumerate(zip(panels, watched, strict=False)):
        _equilibria(axes, table)
        for number in table.branches:
            _branch(
                axes,
                table.branch(number),
                lambda row, k=k: scales[k] * float(row.amplitude[k]),
                lambda way, k=k: scales[k] * float(way[2 + k]),
            )
        if not k:
            _simulated(axes, table, "amplitude", scales[0])
        axes.set_ylabel(axis_label(f"Amplitude:\n{_named(channel)}", units[k]))
        _hopf(axes, table)
        leave_room(axes)
    for number in table.branches:
        _branch(panels[-1], table.branch(number), lambda row: row.period, lambda way: float(way[1]))
    _simulated(panels[-1], table, "period", 1.0)
    panels[-1].set_ylabel(axis_label("Period", "s"))
    words = in_words(table.parameter.name, table.parameter.description)
    panels[-1].set_xlabel(axis_label(words, table.parameter.unit))
    if len(table.locus_values):
        panels[-1].set_xlim(float(table.locus_values.min()), float(table.locus_values.max()))
    handles, labels = panels[0].get_legend_handles_labels()
    unique = dict(zip(labels, handles, strict=True))
    panels[0].legend(
        unique.values(), unique.keys(), loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4
    )
    figure.align_ylabels(panels)
    return _entitled(figure, "Limit cycles", table)


def _named(channel: Quantity) -> str:
    """Return part and meaning of a channel, in two lines where both are known."""
    if channel.description in ("", channel.name):
        return plain(channel.name)
    part, _, last = channel.name.rpartition(".")
    words = in_words(last, channel.description)
    return f"{words},\n{part}" if part else words


def _hopf(axes: Axes, table: HuntTable) -> None:
    """Mark the Hopf bifurcations of the equilibrium."""
    known = [table.figures[name] for name in HOPF if name in table.figures]
    if known:
        zeros = [0.0] * len(known)
        axes.plot(known, zeros, "D", color=BLACK, markersize=5, label="Hopf bifurcation")


def _simulated(axes: Axes, table: HuntTable, measure: str, scale: float) -> None:
    """Draw simulated motions: crosses, upright ones where they do not repeat or are cut short."""
    for marker, label, settled in (("x", "simulated", True), ("+", "simulated, varies", False)):
        rows = [row for row in table.simulated if (row.ending == SETTLED) is settled]
        if rows:
            heights = [scale * getattr(row, measure) for row in rows]
            axes.plot([row.value for row in rows], heights, marker, color=GREEN, label=label)


def _equilibria(axes: Axes, table: HuntTable) -> None:
    """Draw the equilibria along zero."""
    if not len(table.locus_values):
        return
    growth = table.eigenvalues.real.max(axis=1) - _GROWS
    values, stable = np.asarray(table.locus_values), growth <= 0.0
    edges = np.flatnonzero(np.diff(stable.astype(int)))
    crossings = [
        _crossing(values[k : k + 2], growth[k : k + 2], table.figures.get("linear_critical"))
        for k in edges
    ]
    values = np.insert(values, edges + 1, crossings)
    stable = np.insert(stable, edges + 1, stable[edges])
    _runs(axes, values, np.zeros(len(stable)), stable, "0.3")


def _crossing(values: Any, growth: Any, critical: float | None) -> float:
    """Return where an equilibrium loses or gains stability between two values.

    That is the critical value if it lies there, else where the growth rate is linearly zero.
    """
    if critical is not None and values[0] < critical < values[1]:
        return critical
    return float(values[0] - growth[0] * (values[1] - values[0]) / (growth[1] - growth[0]))


def _branch(axes: Axes, rows: list[CycleRow], measure: Any, change: Any) -> None:
    """Draw a branch as the curve that continuation knows, and mark its special points."""
    points = np.array([(row.value, measure(row)) for row in rows])
    unknown = (np.nan, np.nan)
    ways = [unknown if (d := row.direction) is None else (d[0], change(d)) for row in rows]
    pieces = branch_curve(points, np.array(ways))
    heights = points[:, 1]
    curve = np.concatenate([points[:1], *(piece[1:] for piece in pieces)])
    stable = np.repeat([row.stable for row in rows[1:]], POINTS)
    _runs(axes, curve[:, 0], curve[:, 1], np.insert(stable, 0, rows[0].stable), BLUE)
    for row, height in zip(rows, heights, strict=True):
        if row.kind:
            marker, label = KINDS[row.kind]
            axes.plot(row.value, height, marker, color=VERMILION, label=label, markersize=5)


def _runs(axes: Axes, values: Any, heights: Any, stable: Any, colour: str) -> None:
    """Draw a line that is solid where it is stable and dashed elsewhere."""
    edges = np.flatnonzero(np.diff(stable.astype(int))) + 1
    for begin, end in zip([0, *edges], [*edges, len(values)], strict=True):
        solid = bool(stable[begin])
        axes.plot(
            values[max(0, begin - 1) : end],
            heights[max(0, begin - 1) : end],
            "-" if solid else "--",
            color=colour,
            label="stable" if solid else "unstable",
        )


def _motion(table: HuntTable) -> Figure:
    """Draw one period of up to seven cycles, spread over the stable ones."""
    rows = [row for row in table.cycles if row.stable] or list(table.cycles)
    places = np.unique(np.linspace(0, len(rows) - 1, min(len(rows), len(PALETTE))).astype(int))
    watched = table.channels[:MOST_PANELS]
    units, scales = _shown(table)
    figure = new_figure(_HEADING + _PANEL * len(watched))
    panels = figure.subplots(len(watched), 1, sharex=True, squeeze=False)[:, 0]
    for k, (axes, channel) in enumerate(zip(panels, watched, strict=True)):
        for colour, place in zip(PALETTE, places, strict=False):
            row = rows[place]
            time = np.linspace(0.0, row.period, len(row.motion))
            label = f"{row.value:.4g} {table.parameter.unit}"
            axes.plot(time, scales[k] * row.motion[:, k], color=colour, label=label)
        axes.set_ylabel(axis_label(_named(channel), units[k]))
    panels[-1].set_xlabel(axis_label("Time", "s"))
    panels[0].legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=4)
    figure.align_ylabels(panels)
    return _entitled(figure, "One period of the cycles", table)


def _shown(table: HuntTable) -> tuple[list[str], list[float]]:
    """Return unit and factor in which each channel is shown: small ones in thousandths."""
    units, scales = [], []
    for k, channel in enumerate(table.channels):
        small = _THOUSANDTHS.get(channel.unit)
        largest = max((abs(float(row.amplitude[k])) for row in table.cycles), default=np.inf)
        shown = small if small and largest < _SMALL else channel.unit
        units.append(shown)
        scales.append(unit_factor(channel.unit, shown))
    return units, scales


def _entitled(figure: Figure, title: str, table: HuntTable) -> Figure:
    state = "" if table.status == "ok" else f" ({plain(table.status)})"
    figure.suptitle(title + state, fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    figure.supxlabel(plain(table.title), fontsize=6.5, color="0.45", x=0.99, ha="right")
    return figure
