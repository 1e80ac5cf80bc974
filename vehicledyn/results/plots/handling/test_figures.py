"""Figures of the standards' open-loop tests and lane changes, one car or two over each other."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.results.plots.handling.steady_figures import new_figure, steady_figures
from vehicledyn.results.plots.plot_style import LINE_STYLES, PALETTE, axis_label
from vehicledyn.results.tables.handling_table import HandlingTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_DEGREES = 180.0 / math.pi
TESTS = {
    "slowly_increasing_steer": "Slowly increasing steer (FMVSS 126, UN R140)",
    "step_steer": "Step steer (ISO 7401)",
    "single_sine": "Single sine (ISO 7401)",
    "swept_sine": "Swept sine (ISO 7401)",
    "pulse_steer": "Pulse (ISO 7401)",
    "weave": "Weave (ISO 13674-1)",
    "sine_with_dwell": "Sine with dwell (FMVSS 126, UN R140), last amplitude",
    "fishhook": "Fishhook, last speed",
    "j_turn": "J-turn, last speed",
    "braking_in_turn": "Braking in a turn (ISO 7975)",
    "straight_braking": "Straight braking (ISO 21994)",
    "split_braking": "Braking on split friction (ISO 14512), steering wheel held",
    "split_braking_steered": "Braking on split friction (ISO 14512), steered",
    "crosswind": "Side wind (ISO 12021), 1 kN",
    "coast_down": "Coast-down (ISO 10521-1)",
    "trailer_sway": "Trailer sway (ISO 9815)",
    "double_lane_change": "Double lane change (ISO 3888-1)",
    "obstacle_avoidance": "Obstacle avoidance (ISO 3888-2), last speed passed",
}
"""Titles of the tests whose signals are drawn."""

_PANELS = (
    ("steering", "Steering wheel", "deg", _DEGREES),
    ("yaw_rate", "Yaw rate", "deg/s", _DEGREES),
    ("lateral_acceleration", "Lateral acceleration", "m/s^2", 1.0),
    ("sideslip", "Side-slip angle", "deg", _DEGREES),
)
_ASIDE = ("y", "Deviation from the path", "m", 1.0)
_BRAKED = ("forward_speed", "Speed", "m/s", 1.0)
_WAY = ("x", "Way", "m", 1.0)

_DIGITS = 9
"""Decimals that are drawn; what a symmetric car does aside is rounding."""


def handling_figures(tables: Sequence[HandlingTable]) -> Iterator[tuple[str, Figure]]:
    """Give all figures of one car or two with their names, drawn on demand."""
    yield from steady_figures(tables)
    for name, title in TESTS.items():
        if any(name in table.sheets for table in tables):
            yield name, _test(tables, name, title)
    if any("weave" in table.sheets for table in tables):
        yield "weave_loops", _loops(tables)
    if any("linear_response" in table.sheets for table in tables):
        yield "frequency_responses", _responses(tables)


def _test(tables: Sequence[HandlingTable], name: str, title: str) -> Figure:
    panels = _panels(name)
    figure = new_figure(tables, title, 0.62 if len(panels) > 2 else 0.4)
    rows = len(panels) // 2
    grid = figure.subplots(rows, 2, sharex=True, squeeze=False)
    for axes, (signal, label, unit, scale) in zip(grid.flat, panels, strict=True):
        for table, style, colour in zip(tables, LINE_STYLES, PALETTE, strict=False):
            if name in table.sheets:
                sheet = table.sheets[name]
                values = np.round(sheet[signal].values * scale, _DIGITS)
                axes.plot(sheet["time"].values, values, style, color=colour)
        axes.set_ylabel(axis_label(label, unit))
        if name == "coast_down":
            axes.set_ylim(bottom=0.0)
    for axes in figure.axes[-2:]:
        axes.set_xlabel(axis_label("Time", "s"))
    return figure


def _panels(name: str) -> list[tuple[str, str, str, float]]:
    """Return the signals of a test that tell most of it: an even number, two to a row."""
    if name == "coast_down":
        return [_BRAKED, _WAY]
    if "split" in name or name == "straight_braking":
        return [_BRAKED, *_PANELS[:2], _ASIDE]
    return [_BRAKED, *_PANELS[1:]] if "braking" in name else list(_PANELS)


def _loops(tables: Sequence[HandlingTable]) -> Figure:
    figure = new_figure(tables, "Weave: answers over the steering-wheel angle", 0.5)
    for axes, (signal, label, unit, scale) in zip(figure.subplots(1, 2), _PANELS[1:3], strict=True):
        for table, style, colour in zip(tables, LINE_STYLES, PALETTE, strict=False):
            if "weave" in table.sheets:
                sheet = table.sheets["weave"]
                time, moved = sheet["time"].values, np.round(sheet["steering"].values, _DIGITS)
                later = (time > 0.5 * time[-1]) & (time <= time[np.flatnonzero(moved)[-1]])
                across = sheet["steering"].values[later] * _DEGREES
                axes.plot(across, sheet[signal].values[later] * scale, style, color=colour)
        axes.set_xlabel(axis_label("Steering-wheel angle", "deg"))
        axes.set_ylabel(axis_label(label, unit))
    return figure


_RESPONSES = {"linear_response": "linearised", "swept_sine_response": "swept sine",
              "pulse_steer_response": "pulse"}  # fmt: skip
_SHOWN = (
    ("yaw_rate_gain", "Gain", "1/s", 1.0),
    ("lateral_acceleration_gain", "Gain", "m/s^2/rad", 1.0),
    ("yaw_rate_phase", "Phase", "deg", _DEGREES),
    ("lateral_acceleration_phase", "Phase", "deg", _DEGREES),
)


def _responses(tables: Sequence[HandlingTable]) -> Figure:
    figure = new_figure(tables, "Transfer functions from the steering wheel (ISO 7401)", 0.62)
    for axes, (name, label, unit, scale) in zip(
        figure.subplots(2, 2, sharex=True).flat, _SHOWN, strict=True
    ):
        for table, style in zip(tables, LINE_STYLES, strict=False):
            for (kind, words), colour in zip(_RESPONSES.items(), PALETTE, strict=False):
                if kind in table.sheets:
                    sheet = table.sheets[kind]
                    text = words if table is tables[0] else None
                    across, values = sheet["frequency"].values, sheet[name].values * scale
                    axes.plot(across, values, style, color=colour, label=text)
        axes.set_ylabel(axis_label(label, unit))
    for axes in figure.axes[2:]:
        axes.set_xlabel(axis_label("Frequency", "Hz"))
    for axes, title in zip(figure.axes, ("Yaw rate", "Lateral acceleration"), strict=False):
        axes.set_title(title, fontsize=9.0)
    figure.axes[0].legend(loc="lower left")
    return figure
