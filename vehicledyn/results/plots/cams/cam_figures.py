"""Figures of cams: profile with pitch curve, motion, pressure angle and curvature, forces."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.plot_style import (
    BLACK,
    BLUE,
    GREEN,
    VERMILION,
    WIDTH,
    axis_label,
    plain,
)
from vehicledyn.results.tables.cam_table import CamTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DEGREES = 180.0 / math.pi
_SHOWN = {"m": ("mm", 1e3), "rad": ("deg", _DEGREES), "N": ("N", 1.0), "N*m": ("N m", 1.0)}
_FAR = 4.0
"""Radii of curvature are shown up to this many times the size of the cam."""


def cam_figures(table: CamTable) -> Iterator[tuple[str, Figure]]:
    """Give the figures of a cam with their names, drawn on demand."""
    yield "profile", _draw_profile(table)
    yield "motion", _draw_motion(table)
    yield "pressure_angle", _draw_pressure(table)
    if "normal_force" in table.columns:
        names = ("normal_force", "second_normal_force", "torque")
        yield "forces", _draw_columns(table, "Forces", [n for n in names if n in table.columns])


def _figure(table: CamTable, title: str, height: float) -> Figure:
    figure = new_canvas(WIDTH, height * WIDTH)
    figure.suptitle(f"{title}\n{plain(table.title)}", fontsize=9.5, x=0.01, ha="left")
    return figure


def _draw_profile(table: CamTable) -> Figure:
    figure = _figure(table, "Profile", 0.9)
    axes = figure.subplots()
    columns = {name: 1e3 * np.asarray(c.values) for name, c in table.columns.items()}
    axes.plot(columns["profile_x"], columns["profile_y"], color=BLUE, label="profile")
    if not np.allclose(columns["pitch_x"], columns["profile_x"]):
        axes.plot(
            columns["pitch_x"], columns["pitch_y"], "--", color=GREEN, lw=1.0, label="pitch curve"
        )
    if "second_profile_x" in columns:
        axes.plot(
            columns["second_profile_x"], columns["second_profile_y"], color=VERMILION,
            label="second profile",
        )  # fmt: skip
        axes.plot(columns["second_pitch_x"], columns["second_pitch_y"], "--", color=GREEN, lw=1.0)
    if table.follower != "axial roller":
        least = float(np.hypot(columns["profile_x"], columns["profile_y"]).min())
        turn = np.linspace(0.0, 2.0 * math.pi, 181)
        axes.plot(
            least * np.cos(turn),
            least * np.sin(turn),
            ":",
            color="0.5",
            lw=1.0,
            label="base circle",
        )
        axes.plot([0.0], [0.0], "+", color=BLACK)
    axes.set_aspect("equal")
    axes.set_xlabel(axis_label("x in axes of the cam", "mm"))
    axes.set_ylabel(axis_label("y in axes of the cam", "mm"))
    axes.legend(loc="upper right")
    return figure


def _draw_motion(table: CamTable) -> Figure:
    names = [n for n in ("lift", "velocity", "acceleration", "jerk") if n in table.columns]
    return _draw_columns(table, "Motion of the follower", names)


def _draw_columns(table: CamTable, title: str, names: Any) -> Figure:
    figure = _figure(table, title, 0.28 * len(names) + 0.1)
    panels = np.atleast_1d(figure.subplots(len(names), 1, sharex=True))
    for axes, name in zip(panels, names, strict=True):
        column = table.columns[name]
        unit, scale = _shown(column.unit)
        axes.plot(_DEGREES * table.angle, scale * np.asarray(column.values), color=BLUE)
        axes.set_ylabel(axis_label(name.replace("_", " ").capitalize(), unit))
    _angle_axis(panels[-1])
    return figure


def _draw_pressure(table: CamTable) -> Figure:
    figure = _figure(table, "Pressure angle and curvature", 0.75)
    upper, lower = figure.subplots(2, 1, sharex=True)
    x = _DEGREES * table.angle
    upper.plot(x, _DEGREES * np.asarray(table.columns["pressure_angle"].values), color=BLUE)
    upper.set_ylabel(axis_label("Pressure angle", "deg"))
    size = float(np.hypot(table.columns["pitch_x"].values, table.columns["pitch_y"].values).max())
    for name, colour in (("pitch_radius", GREEN), ("profile_radius", VERMILION)):
        values = np.array(table.columns[name].values, dtype=float)
        values[np.abs(values) > _FAR * size] = np.nan
        lower.plot(x, 1e3 * values, color=colour, label=name.replace("_radius", ""))
    lower.axhline(0.0, color=BLACK, lw=0.6)
    lower.set_ylabel(axis_label("Radius of curvature, convex positive", "mm"))
    lower.legend(loc="upper right")
    _angle_axis(lower)
    return figure


def _shown(unit: str) -> tuple[str, float]:
    head, _, rest = unit.partition("/")
    if unit in _SHOWN:
        return _SHOWN[unit]
    return (f"mm/{rest}", 1e3) if head == "m" else (unit, 1.0)


def _angle_axis(axes: Axes) -> None:
    axes.set_xlabel(axis_label("Angle of the cam", "deg"))
    axes.set_xticks(np.arange(0.0, 361.0, 45.0))
