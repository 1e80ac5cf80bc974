"""Figures of several results, drawn alike, laid over each other in one with a legend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from vehicledyn.results.plots.plot_style import LINE_STYLES, PALETTE, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

SCENERY = "scenery"
"""Group of artists that belong to the place and not to a result, such as cones: drawn once."""

LONG_NAME = 24
"""Letters from which on names of results stand below each other."""


def overlaid(figures: Mapping[str, Figure]) -> Figure | None:
    """Return the first figure with the lines of the others in it and a legend of the results.

    Colours tell the results apart, and line styles where these have no meaning of their own; line
    styles alone where colours tell channels apart. The first figure is changed. Returns None where
    the figures cannot share their axes: other panels or labels, bars or images.

    Parameters
    ----------
    figures
        Figure of each result by the name of the result, the first as the base.
    """
    base, *others = figures.values()
    if not others:
        return base
    if not all(_fits(base, other) for other in others):
        return None
    by_style = any(_channels_have_colours(axes) for axes in base.axes)
    colours = [base.axes[0].lines[0].get_color()] if by_style else _free_colours(base)
    styles = LINE_STYLES if by_style or _is_solid(base) else ("",)
    if by_style:
        for axes in base.axes:
            _make_solid(axes)
    for number, other in enumerate(others, start=1):
        colour = None if by_style else colours[number % len(colours)]
        style = styles[number % len(styles)]
        for axes, source in zip(base.axes, other.axes, strict=True):
            _add_lines(axes, source, colour, style)
    for axes in base.axes:
        _span(axes, [other.axes[base.axes.index(axes)] for other in others])
    name_results(base, list(figures), ["0.25"] if by_style else colours, styles)
    return base


def _fits(base: Figure, other: Figure) -> bool:
    """Return whether two figures have the same panels, of lines alone."""
    if len(base.axes) != len(other.axes) or not base.axes:
        return False
    return all(
        _labels(axes) == _labels(partner) and _is_of_lines(axes) and _is_of_lines(partner)
        for axes, partner in zip(base.axes, other.axes, strict=True)
    )


def _labels(axes: Axes) -> tuple[str, str, str]:
    return axes.get_xlabel(), axes.get_ylabel(), str(axes.get_label())


def _is_of_lines(axes: Axes) -> bool:
    patches = [patch for patch in axes.patches if patch.get_gid() != SCENERY]
    return bool(_own_lines(axes)) and not (axes.images or patches)


def _own_lines(axes: Axes) -> list[Line2D]:
    """Return lines over values, neither zero lines nor scenery."""
    return [
        line
        for line in axes.lines
        if line.get_transform() == axes.transData and line.get_gid() != SCENERY
    ]


def _channels_have_colours(axes: Axes) -> bool:
    """Return whether colours tell lines apart and line styles say nothing more."""
    lines = _own_lines(axes)
    colours = [line.get_color() for line in lines]
    is_plain = all(line.get_linestyle() != "None" for line in lines)
    return is_plain and len(set(colours)) > 1 and len(set(colours)) == len(colours)


def _free_colours(base: Figure) -> list[str]:
    """Return the colour of the base and those of the palette that it does not use."""
    used = [str(line.get_color()) for axes in base.axes for line in _own_lines(axes)]
    return [used[0], *(colour for colour in PALETTE if colour not in used)]


def _make_solid(axes: Axes) -> None:
    for line in _own_lines(axes):
        line.set_linestyle(LINE_STYLES[0])
    legend = axes.get_legend()
    for handle in legend.get_lines() if legend else ():
        handle.set_linestyle(LINE_STYLES[0])


def _add_lines(axes: Axes, source: Axes, colour: str | None, style: str) -> None:
    for line in _own_lines(source):
        (added,) = axes.plot(line.get_xdata(), line.get_ydata())
        added.update_from(line)
        added.set_transform(axes.transData)
        added.set_clip_path(axes.patch)
        added.set_label("_beside")
        if colour is not None:
            added.set_color(colour)
        if style and line.get_linestyle() != "None":
            added.set_linestyle(style)


def _span(axes: Axes, partners: Sequence[Axes]) -> None:
    """Widen the axes to hold those of all; true scales follow by themselves."""
    if axes.get_aspect() != "auto":
        return
    for get, put in (("get_xlim", "set_xlim"), ("get_ylim", "set_ylim")):
        ends = [getattr(each, get)() for each in (axes, *partners)]
        low, high = min(min(pair) for pair in ends), max(max(pair) for pair in ends)
        getattr(axes, put)(*((low, high) if ends[0][0] <= ends[0][1] else (high, low)))


def name_results(
    figure: Figure, names: Sequence[str], colours: Sequence[str], styles: Sequence[str]
) -> None:
    """Add the legend that names results by their colours and line styles."""
    from matplotlib.lines import Line2D

    handles = [
        Line2D(
            [],
            [],
            color=colours[number % len(colours)],
            linestyle=styles[number % len(styles)] or "-",
            label=plain(name),
        )
        for number, name in enumerate(names)
    ]
    long = max(map(len, names)) > LONG_NAME
    figure.legend(handles=handles, loc="outside upper right", ncols=1 if long else 3)


def _is_solid(figure: Figure) -> bool:
    """Return whether line styles say nothing in a figure."""
    lines = [line for axes in figure.axes for line in _own_lines(axes)]
    return all(line.get_linestyle() == LINE_STYLES[0] for line in lines)
