"""Figure of measured profiles: points, what was left out and bridged, distance from the curve."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.plot_style import BLUE, VERMILION, WIDTH, axis_label, plain
from vehicledyn.results.tables.contact_table import MeasuredProfile

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BRIDGE, _AVERAGED = "#e69f00", "#999999"
_TITLES = {
    "left_wheel": "Left wheel", "right_wheel": "Right wheel",
    "left_rail": "Left rail", "right_rail": "Right rail",
}  # fmt: skip


def draw_measured(title: str, profiles: dict[str, MeasuredProfile]) -> Figure:
    """Return the figure of what was read: a column of two panels for each profile.

    Above are the points used, those of the file that means stand for, outliers left out and the
    bridges of gaps; below is the distance of the points from the curve.
    """
    figure = new_canvas(WIDTH, 0.62 * WIDTH)
    panels = figure.subplots(2, len(profiles), squeeze=False, sharex="col")
    for column, (name, profile) in enumerate(profiles.items()):
        above, below = panels[:, column]
        _draw_points(above, profile)
        above.set_title(_TITLES.get(name, plain(name)), fontsize=9.0)
        below.plot(1e3 * profile.points[:, 0], 1e6 * profile.distance, ".", ms=2, color=BLUE)
        for begin, end in profile.bridges:
            below.axvspan(1e3 * begin, 1e3 * end, color=_BRIDGE, alpha=0.25, lw=0.0)
        below.set_xlabel(axis_label("Lateral coordinate, outwards", "mm"))
    panels[0, 0].set_ylabel(axis_label("Height", "mm"))
    panels[1, 0].set_ylabel(axis_label("Points beside the curve", "\u00b5m"))
    panels[0, 0].legend(loc="best", fontsize=7.0)
    figure.suptitle(plain(title), fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    return figure


def _draw_points(axes: Axes, profile: MeasuredProfile) -> None:
    """Draw the points used and left out, and the points of bridges."""
    y, z = 1e3 * profile.points.T
    bridged = np.zeros(len(y), dtype=bool)
    for ends in profile.bridges:
        bridged |= (y > 1e3 * min(ends)) & (y < 1e3 * max(ends))
    if len(profile.averaged):
        noisy = 1e3 * profile.averaged
        axes.plot(noisy[:, 0], noisy[:, 1], ".", ms=2, color=_AVERAGED, label="points averaged")
    axes.plot(y[~bridged], z[~bridged], ".", ms=2, color=BLUE, label="points used")
    if bridged.any():
        axes.plot(y[bridged], z[bridged], ".", ms=2, color=_BRIDGE, label="bridged gap")
    if len(profile.outliers):
        out = 1e3 * profile.outliers
        axes.plot(out[:, 0], out[:, 1], "x", ms=5, color=VERMILION, label="outliers left out")
