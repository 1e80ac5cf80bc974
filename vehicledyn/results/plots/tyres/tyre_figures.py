"""Figures of tyres: pure slip, combined slip with its ellipses, and moment over side force."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.plot_style import LINE_STYLES, PALETTE, WIDTH, axis_label, plain
from vehicledyn.results.tables.tyre_table import TyreTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DEGREES = 180.0 / math.pi


def tyre_figures(tables: list[TyreTable]) -> Iterator[tuple[str, Figure]]:
    """Give the figures of one or two tyres with their names, drawn on demand."""
    yield "pure_slip", _draw_pure(tables)
    yield "combined_slip", _draw_combined(tables)
    yield "friction_ellipse", _draw_ellipse(tables)
    yield "moment_method", _draw_moments(tables)


def _figure(tables: list[TyreTable], title: str, height: float) -> Figure:
    figure = new_canvas(WIDTH, height * WIDTH)
    names = " (lines), ".join(table.title for table in tables)
    shown = f"{title}\n{names}{' (dashed)' if len(tables) > 1 else ''}"
    text = "\n".join(plain(line) for line in shown.splitlines())
    figure.suptitle(text, fontsize=9.5, x=0.01, ha="left")
    return figure


def _draw_pure(tables: list[TyreTable]) -> Figure:
    figure = _figure(tables, "Pure slip", 0.95)
    panels = (
        ("longitudinal", "longitudinal_slip", 1.0, "longitudinal_force", 1e-3),
        ("lateral", "slip_angle", _DEGREES, "lateral_force", 1e-3),
        ("lateral", "slip_angle", _DEGREES, "aligning_moment", 1.0),
        ("cambered", "camber", _DEGREES, "lateral_force", 1e-3),
    )
    labels = {
        "longitudinal_slip": ("Longitudinal slip", "1"),
        "slip_angle": ("Slip angle", "deg"),
        "camber": ("Camber", "deg"),
        "longitudinal_force": ("Longitudinal force", "kN"),
        "lateral_force": ("Lateral force", "kN"),
        "aligning_moment": ("Aligning moment", "N m"),
    }
    for axes, (sweep, x, x_scale, y, y_scale) in zip(
        figure.subplots(2, 2).flat, panels, strict=True
    ):
        for table, style in zip(tables, LINE_STYLES, strict=False):
            for load, colour in zip(table.loads, PALETTE, strict=False):
                rows = table.of_load(sweep, load)
                label = f"{load / 1e3:.3g} kN" if table is tables[0] else None
                axes.plot(rows[x] * x_scale, rows[y] * y_scale, style, color=colour, label=label)
        axes.set_xlabel(axis_label(*labels[x]))
        axes.set_ylabel(axis_label(*labels[y]))
    figure.axes[0].legend(loc="lower right")
    return figure


def _draw_combined(tables: list[TyreTable]) -> Figure:
    figure = _figure(tables, "Combined slip at the middle load", 0.5)
    left, right = figure.subplots(1, 2)
    for table, style in zip(tables, LINE_STYLES, strict=False):
        for angle, colour, rows in _angles(table):
            if angle < 0.0:
                continue
            label = f"{angle * _DEGREES:.3g}°" if table is tables[0] else None
            slip = rows["longitudinal_slip"]
            left.plot(slip, rows["longitudinal_force"] / 1e3, style, color=colour, label=label)
            right.plot(slip, rows["lateral_force"] / 1e3, style, color=colour)
    for axes, name in ((left, "Longitudinal force"), (right, "Lateral force")):
        axes.set_xlabel(axis_label("Longitudinal slip", "1"))
        axes.set_ylabel(axis_label(name, "kN"))
    left.legend(loc="lower right", title="Slip angle")
    return figure


def _angles(table: TyreTable) -> Iterator[tuple[float, str, dict[str, np.ndarray]]]:
    """Yield the slip angles of the combined sweep at the middle load, with colour and rows."""
    rows = table.of_load("combined", table.loads[len(table.loads) // 2])
    sizes = np.unique(np.abs(rows["slip_angle"])).tolist()
    for angle in np.unique(rows["slip_angle"]).tolist():
        chosen, k = rows["slip_angle"] == angle, sizes.index(abs(angle))
        part = {name: values[chosen] for name, values in rows.items()}
        yield angle, PALETTE[k % len(PALETTE)], part


def _draw_ellipse(tables: list[TyreTable]) -> Figure:
    figure = _figure(tables, "Lateral over longitudinal force at the middle load", 0.75)
    axes = figure.subplots()
    for table, style in zip(tables, LINE_STYLES, strict=False):
        for angle, colour, rows in _angles(table):
            named = table is tables[0] and angle >= 0.0
            label = f"±{angle * _DEGREES:.3g}°" if named else None
            x, y = rows["longitudinal_force"] / 1e3, rows["lateral_force"] / 1e3
            axes.plot(x, y, style, color=colour, label=label)
    axes.set_xlabel(axis_label("Longitudinal force", "kN"))
    axes.set_ylabel(axis_label("Lateral force", "kN"))
    axes.set_aspect("equal", adjustable="datalim")
    axes.legend(loc="lower right", title="Slip angle")
    return figure


def _draw_moments(tables: list[TyreTable]) -> Figure:
    figure = _figure(tables, "Aligning moment over side force, with lines of slip angle", 0.7)
    axes = figure.subplots()
    for table, style in zip(tables, LINE_STYLES, strict=False):
        for load, colour in zip(table.loads, PALETTE, strict=False):
            rows = table.of_load("lateral", load)
            label = f"{load / 1e3:.3g} kN" if table is tables[0] else None
            force, moment = rows["lateral_force"] / 1e3, rows["aligning_moment"]
            axes.plot(force, moment, style, color=colour, label=label)
    _angle_lines(axes, tables[0])
    axes.set_xlabel(axis_label("Lateral force", "kN"))
    axes.set_ylabel(axis_label("Aligning moment", "N m"))
    axes.legend(loc="upper right")
    return figure


def _angle_lines(axes: Axes, table: TyreTable) -> None:
    """Draw lines of equal slip angle through the curves of all loads."""
    for angle in (-6.0, -4.0, -2.0, 2.0, 4.0, 6.0):
        points = []
        for load in table.loads:
            rows = table.of_load("lateral", load)
            k = int(np.argmin(np.abs(rows["slip_angle"] * _DEGREES - angle)))
            points.append((rows["lateral_force"][k] / 1e3, rows["aligning_moment"][k]))
        x, y = zip(*points, strict=True)
        axes.plot(x, y, ".-", color="0.6", lw=0.8, ms=4.0)
        outward = -1.0 if points[-1][0] < 0.0 else 1.0
        axes.annotate(
            f"{angle:g}°",
            points[-1],
            (6.0 * outward, 0.0),
            textcoords="offset points",
            ha="right" if outward < 0.0 else "left",
            va="center",
            fontsize=7.0,
            color="0.35",
        )
