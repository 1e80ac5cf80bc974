"""Figures of contact geometry: profiles with lines between the points that touch; conicity."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from vehicledyn.results.plots.canvas import new_canvas
from vehicledyn.results.plots.measured_figure import draw_measured
from vehicledyn.results.plots.plot_style import BLUE, VERMILION, WIDTH, axis_label, plain
from vehicledyn.results.tables.contact_table import SIDES, ContactTable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LIFT = 0.015
"""By how much wheels are drawn above their rails [m]."""


def contact_figures(table: ContactTable) -> Iterator[tuple[str, Figure]]:
    """Give the figures of a table with their names, drawn on demand."""
    yield "contact", _draw_contact(table)
    yield "geometry", _draw_geometry(table)
    if table.measured:
        yield "measured", draw_measured(table.title, table.measured)


def _draw_contact(table: ContactTable) -> Figure:
    figure = new_canvas(WIDTH, 0.31 * WIDTH)
    left, right = figure.subplots(1, 2, sharey=True)
    for number, (axes, side) in enumerate(((left, SIDES[0]), (right, SIDES[1]))):
        lines = _draw_side(axes, table, number)
        axes.set_title(f"{side.capitalize()} side, seen from behind", fontsize=9.0)
        axes.set_xlabel(axis_label("Distance from the middle", "mm"))
        axes.set_aspect("equal")
    left.invert_xaxis()
    left.set_ylabel(axis_label("Height, wheel raised", "mm"))
    figure.colorbar(lines, ax=(left, right), label=axis_label("Lateral shift", "mm"), shrink=0.7)
    _entitle(figure, table)
    return figure


def _draw_side(axes: Axes, table: ContactTable, number: int) -> Any:
    """Draw wheel and rail at no shift, and lines that join the points in contact."""
    from matplotlib.collections import LineCollection

    side = SIDES[number]
    wheel, rail = table.outlines[f"{side}_wheel"], table.outlines[f"{side}_rail"]
    axes.plot(1e3 * wheel[:, 0], 1e3 * (wheel[:, 1] + LIFT), color=BLUE)
    axes.plot(1e3 * rail[:, 0], 1e3 * rail[:, 1], color=VERMILION)
    first = table.contacts
    places, y, z = (column[:, number, 0] for column in (first.place, first.y, first.z))
    on_wheel = np.column_stack(
        [
            wheel[0, 0] + places - table.outlines[f"{side}_wheel_begin"][0, 0],
            np.full_like(y, np.nan),
        ]
    )
    on_wheel[:, 1] = np.interp(on_wheel[:, 0], wheel[:, 0], wheel[:, 1]) + LIFT
    on_rail = np.column_stack([y, z])
    known = np.isfinite(places)
    segments = 1e3 * np.stack([on_wheel[known], on_rail[known]], axis=1)
    lines = LineCollection(list(segments), cmap="viridis", linewidths=0.9)
    lines.set_array(1e3 * table.shift[known])
    axes.add_collection(lines)
    axes.set_ylim(-25.0, 25.0)
    return lines


def _draw_geometry(table: ContactTable) -> Figure:
    figure = new_canvas(WIDTH, 0.75 * WIDTH)
    (places, angles), (difference, conicity) = figure.subplots(2, 2)
    curves = table.curves
    for number, (side, colour) in enumerate(zip(SIDES, (BLUE, VERMILION), strict=True)):
        shift, place, angle = _broken(
            table, side, curves.shift, curves.place[:, number], curves.angle[:, number]
        )
        places.plot(1e3 * shift, 1e3 * place, color=colour, label=side)
        angles.plot(1e3 * shift, np.degrees(angle), color=colour, label=side)
        asked = 1e3 * table.shift, 1e3 * table.contacts.place[:, number, 0]
        places.plot(*asked, ".", ms=4, color=colour)
    places.set_ylabel(axis_label("Contact on the wheel", "mm"))
    angles.set_ylabel(axis_label("Contact angle", "deg"))
    places.legend()
    shift, radii = _broken(table, None, curves.shift, curves.radius_difference)
    difference.plot(1e3 * shift, 1e3 * radii, color=BLUE)
    difference.set_ylabel(axis_label("Rolling radius difference", "mm"))
    for axes in (places, angles, difference):
        axes.set_xlabel(axis_label("Lateral shift", "mm"))
    amplitude = 1e3 * curves.amplitude
    conicity.plot(amplitude, curves.conicity, color=BLUE, label="EN 15302, no roll")
    conicity.plot(amplitude, curves.conicity_with_roll, "--", color=VERMILION, label="with roll")
    conicity.plot(1e3 * table.amplitude, table.conicity, ".", ms=4, color=BLUE)
    conicity.set_xlabel(axis_label("Amplitude", "mm"))
    conicity.set_ylabel(axis_label("Equivalent conicity", "1"))
    conicity.legend()
    _entitle(figure, table)
    return figure


def _broken(table: ContactTable, side: str | None, shift: Any, *columns: Any) -> tuple[Any, ...]:
    """Return shifts and columns with a gap wherever a side jumps; either side for None."""
    jumps = [jump[0] for jump in table.jumps if side in (None, jump[1])]
    where = np.unique(np.searchsorted(shift, jumps))
    where = where[(where > 0) & (where < len(shift))]
    return tuple(np.insert(column, where, np.nan) for column in (shift, *columns))


def _entitle(figure: Figure, table: ContactTable) -> None:
    figure.suptitle(plain(table.title), fontsize=10.5, fontweight="bold", x=0.01, ha="left")
