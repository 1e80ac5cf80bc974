"""Figures of steady cornering: handling diagram, side-slip and roll, modes, moments, limits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.plot_style import LINE_STYLES, PALETTE, WIDTH, axis_label, plain
from vehicledyn.results.tables.handling_table import HandlingTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DEGREES = 180.0 / math.pi
_ACCELERATION = "lateral_acceleration"
METHODS = ("constant_speed", "constant_radius", "constant_steering")


def steady_figures(tables: Sequence[HandlingTable]) -> Iterator[tuple[str, Figure]]:
    """Give the figures of one car or two with their names, drawn on demand."""
    if any(name in table.sheets for table in tables for name in METHODS):
        yield "handling_diagram", _handling(tables)
        yield "steady_state", _steady(tables)
    if any("modes" in table.sheets for table in tables):
        yield "modes_over_acceleration", _modes(tables)
    if any("yaw_moments" in table.sheets for table in tables):
        yield "yaw_moments", _moments(tables)
    if any("limits" in table.sheets for table in tables):
        yield "limits", _limits(tables)


def new_figure(tables: Sequence[HandlingTable], title: str, height: float) -> Figure:
    """Return an empty figure whose title names the cars."""
    figure = new_canvas(WIDTH, height * WIDTH)
    names = " (lines), ".join(table.model for table in tables)
    shown = f"{title}\n{names}{' (dashed)' if len(tables) > 1 else ''}"
    text = "\n".join(plain(line) for line in shown.splitlines())
    figure.suptitle(text, fontsize=9.5, x=0.01, ha="left")
    return figure


def _handling(tables: Sequence[HandlingTable]) -> Figure:
    figure = new_figure(tables, "Handling diagram", 0.5)
    left, right = figure.subplots(1, 2)
    _over_acceleration(left, tables, ("steering_angle", "Steering-wheel angle", "deg", _DEGREES))
    _over_acceleration(right, tables, ("understeer_angle", "Understeer angle", "deg", _DEGREES))
    left.legend(loc="best")
    return figure


def _steady(tables: Sequence[HandlingTable]) -> Figure:
    figure = new_figure(tables, "Steady state over lateral acceleration", 0.8)
    panels = figure.subplots(2, 2).flat
    quantities = (
        ("sideslip_angle", "Side-slip angle", "deg", _DEGREES),
        ("roll_angle", "Roll angle", "deg", _DEGREES),
        ("smallest_wheel_load", "Smallest wheel load", "kN", 1e-3),
        ("drive_torque", "Drive torque", "N m", 1.0),
    )
    for axes, quantity in zip(panels, quantities, strict=True):
        _over_acceleration(axes, tables, quantity)
    figure.axes[0].legend(loc="lower left")
    return figure


def _over_acceleration(
    axes: Axes, tables: Sequence[HandlingTable], quantity: tuple[str, str, str, float]
) -> None:
    name, label, unit, scale = quantity
    for table, style in zip(tables, LINE_STYLES, strict=False):
        for method, colour in zip(METHODS, PALETTE, strict=False):
            if method in table.sheets:
                sheet = table.sheets[method]
                text = method.replace("_", " ") if table is tables[0] else None
                across, values = sheet[_ACCELERATION].values, sheet[name].values * scale
                axes.plot(across, values, style, color=colour, label=text)
    axes.set_xlabel(axis_label("Lateral acceleration", "m/s^2"))
    axes.set_ylabel(axis_label(label, unit))


def _modes(tables: Sequence[HandlingTable]) -> Figure:
    figure = new_figure(tables, "Eigenvalues about steady cornering, below 15 rad/s", 0.5)
    left, right = figure.subplots(1, 2)
    for table, marker in zip(tables, ("o", "x"), strict=False):
        if "modes" not in table.sheets:
            continue
        sheet = table.sheets["modes"]
        real, imaginary = sheet["real"].values, sheet["imaginary"].values
        slow = np.hypot(real, imaginary) < 15.0
        across = sheet[_ACCELERATION].values
        shown = left.scatter(
            real[slow], imaginary[slow], c=across[slow], s=9, marker=marker, cmap="viridis"
        )
        right.scatter(across[slow], real[slow], c=PALETTE[0], s=9, marker=marker)
    figure.colorbar(shown, ax=left, label=axis_label("Lateral acceleration", "m/s^2"))
    left.set_xlabel(axis_label("Real part", "1/s"))
    left.set_ylabel(axis_label("Imaginary part", "rad/s"))
    right.set_xlabel(axis_label("Lateral acceleration", "m/s^2"))
    right.set_ylabel(axis_label("Real part", "1/s"))
    return figure


def _moments(tables: Sequence[HandlingTable]) -> Figure:
    figure = new_figure(tables, "Yaw-moment diagram", 0.7)
    axes = figure.subplots()
    for table, style in zip(tables, LINE_STYLES, strict=False):
        if "yaw_moments" not in table.sheets:
            continue
        columns = {name: column.values for name, column in table.sheets["yaw_moments"].items()}
        for number, (key, colour) in enumerate(
            (("sideslip_angle", PALETTE[0]), ("steering_angle", PALETTE[1]))
        ):
            for k, value in enumerate(np.unique(columns[key])):
                rows = columns[key] == value
                words = ("constant side-slip angle", "constant steering angle")[number]
                label = words if k == 0 and table is tables[0] else None
                axes.plot(
                    columns[_ACCELERATION][rows],
                    columns["yaw_acceleration"][rows],
                    style,
                    color=colour,
                    linewidth=0.9,
                    label=label,
                )
    axes.axhline(0.0, color="0.4", linewidth=0.6)
    axes.set_xlabel(axis_label("Lateral acceleration", "m/s^2"))
    axes.set_ylabel(axis_label("Yaw acceleration", "rad/s^2"))
    axes.legend(loc="lower right")
    return figure


_ENDS = {
    "power_slide": "a power slide with opposite lock begins",
    "full_throttle": "full throttle",
    "wheel_spin": "a driven wheel spins",
    "locked_wheels": "with locked wheels",
}
"""Columns that mark what ends the diagram, and their names."""


def _limits(tables: Sequence[HandlingTable]) -> Figure:
    figure = new_figure(tables, "Limits of acceleration (g-g diagram)", 0.8)
    axes = figure.subplots()
    for table, style in zip(tables, LINE_STYLES, strict=False):
        if "limits" in table.sheets:
            sheet = table.sheets["limits"]
            along, across = (sheet[n].values for n in ("longitudinal", "lateral"))
            closed = np.concatenate([across, -across[::-1], across[:1]])
            axes.plot(closed, np.concatenate([along, along[::-1], along[:1]]), style, marker=".",
                      color=PALETTE[0])  # fmt: skip
            for (name, label), marker in zip(_ENDS.items(), ("o", "s", "D", "x"), strict=True):
                marks = sheet[name].values if name in sheet else np.zeros(0)
                there = np.flatnonzero(marks)
                places = np.concatenate([across[there], -across[there]])
                axes.plot(places, np.tile(along[there], 2), marker, color=PALETTE[1],
                          fillstyle="none", label=label if len(there) else None)  # fmt: skip
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower right")
    axes.set_aspect("equal")
    axes.set_xlabel(axis_label("Lateral acceleration", "m/s^2"))
    axes.set_ylabel(axis_label("Acceleration along the path", "m/s^2"))
    return figure
