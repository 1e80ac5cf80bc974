"""Figures of any arrays of results: one panel a unit, several results in one picture."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from textwrap import fill
from typing import TYPE_CHECKING, Any, NamedTuple

import matplotlib
import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.results.labelled.labels import Labelled, LabelledSet
from vehicledyn.results.plots.absent_contacts import load_of
from vehicledyn.results.plots.figures import HEADING_HEIGHT, PANEL_HEIGHT, new_figure
from vehicledyn.results.plots.overlay import name_results
from vehicledyn.results.plots.plot_description import unit_factor
from vehicledyn.results.plots.plot_style import LINE_STYLES, PALETTE, STYLE, axis_label, plain
from vehicledyn.results.plots.scales import leave_room, suitable_unit
from vehicledyn.results.plots.standard import overlaid_figures
from vehicledyn.results.store.near_names import unknown_array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_LINES = 60
"""Lines that an array may have."""

SHORT_NAME = 22
"""Letters up to which three names of a legend stand side by side."""
LABEL_WIDTH = 34
"""Letters of an axis label in one line."""


class HorizontalAxis(NamedTuple):
    """Values along the horizontal axis, in SI."""

    values: NDArray[Any]
    unit: str
    words: str


class Line(NamedTuple):
    """Values of an array to draw; ``source`` says which result they are from, if there are more."""

    name: str
    values: NDArray[Any]
    unit: str
    words: str
    across: HorizontalAxis
    source: str


def draw_data(
    data: Mapping[str, LabelledSet], patterns: Sequence[str], against: str | None
) -> Figure:
    """Return a figure of arrays that match patterns, of one result or of several by label.

    Raises
    ------
    InputError
        If nothing matches, something cannot be drawn as lines, or ``against`` is not sampled
        like it.
    """
    several = data if len(data) > 1 else {"": next(iter(data.values()))}
    first = next(iter(data.values()))
    if against is not None and against not in first:
        raise InputError(f"{first.path}: {unknown_array(against, first)}")
    lines = [
        line
        for source, one in several.items()
        for name in _drawable(one, patterns)
        for line in _lines(one[name], one[against] if against else None, source, _shown(one, name))
    ]
    return _drawn(lines, ", ".join(patterns) if len(data) > 1 else first.title)


def _drawable(data: LabelledSet, patterns: Sequence[str]) -> list[str]:
    """Return the names that patterns match, the axes of others only where they are named."""
    return [n for n in data.names(*patterns) if n in patterns or tuple(data[n].dims) != (n,)]


def _shown(data: LabelledSet, name: str) -> NDArray[Any]:
    """Return values, not numbers where they tell of a contact of wheel and rail without load."""
    load = load_of(name, set(data))
    values = data[name].values
    return values if load is None else np.where(data[load].values > 0.0, values, np.nan)


def draw_standard(data: Mapping[str, LabelledSet], name: str | None = None) -> Figure:
    """Return the first standard figure, or one by its name, of one result or of several by label.

    Raises
    ------
    InputError
        If there is none, or the results are of different kinds.
    """
    paths = {label: one.path for label, one in data.items()}
    with matplotlib.rc_context(STYLE):
        for _, figure in overlaid_figures(paths, None if name is None else [name]):
            return _for_notebooks(figure)
    title = next(iter(data.values())).title
    raise InputError(f"{title}: has no standard figure; name arrays to draw")


def draw_array(array: Labelled) -> Figure:
    """Return a figure of an array over its time, or else its first dimension."""
    return _drawn(list(_lines(array, None, "")), array.name)


def _lines(
    array: Labelled, against: Labelled | None, source: str, shown: NDArray[Any] | None = None
) -> Iterator[Line]:
    """Yield the lines of an array, one for each place along its further dimensions.

    ``shown`` are its values where some of them are not to be drawn.
    """
    values = array.values if shown is None else shown
    if not array.dims or array.values.dtype.kind not in "fiub":
        what = "complex" if array.values.dtype.kind == "c" else "no line of numbers"
        raise InputError(f"{array.name}: is {what} ({array.size_in_words}) and cannot be drawn")
    dim = "time" if "time" in array.dims else array.dims[0]
    place = array.dims.index(dim)
    across = _axis(array, dim, array.values.shape[place], against)
    columns = np.moveaxis(values, place, 0).reshape(len(across.values), -1)
    if columns.shape[1] > MOST_LINES:
        raise InputError(
            f"{array.name}: has {columns.shape[1]} lines ({array.size_in_words}); choose some"
        )
    for column in columns.T:
        yield Line(array.name, column, array.unit, array.description, across, source)


def _axis(array: Labelled, dim: str, length: int, against: Labelled | None) -> HorizontalAxis:
    label = array.coords.get(dim) if against is None else against
    if label is None or label.values.dtype.kind not in "fiu":
        return HorizontalAxis(np.arange(length), "1", dim.capitalize())
    if label.values.shape != (length,):
        raise InputError(f"{array.name}: cannot be drawn against {label.name}, sampled otherwise")
    return HorizontalAxis(label.values, label.unit, label.description or label.name)


def _drawn(lines: Sequence[Line], title: str) -> Figure:
    with matplotlib.rc_context(STYLE):
        return _for_notebooks(_panels(lines, title))


def _for_notebooks(figure: Figure) -> Figure:
    """Return a figure that a notebook shows as a picture, whatever its backend."""
    vars(figure)["_repr_png_"] = lambda: _as_png(figure)
    return figure


def _as_png(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png")
    return buffer.getvalue()


def _panels(lines: Sequence[Line], title: str) -> Figure:
    units = list(dict.fromkeys(line.unit for line in lines))
    sources = list(dict.fromkeys(line.source for line in lines))
    colours_are_names = any(len(_names(lines, unit)) > 1 for unit in units)
    figure = new_figure(HEADING_HEIGHT + PANEL_HEIGHT * max(len(units), 1.4))
    panels = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
    across_unit = suitable_unit(lines[0].across.unit, *(line.across.values for line in lines))
    for axes, unit in zip(panels, units, strict=True):
        own = [line for line in lines if line.unit == unit]
        _draw_panel(axes, own, sources, across_unit, by_name=colours_are_names)
    panels[-1].set_xlabel(axis_label(plain(lines[0].across.words), across_unit))
    figure.align_ylabels(panels)
    figure.suptitle(plain(title), fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    if len(sources) > 1:
        name_results(figure, sources, ["0.25"] if colours_are_names else PALETTE, LINE_STYLES)
    return figure


def _names(lines: Sequence[Line], unit: str) -> list[str]:
    return list(dict.fromkeys(line.name for line in lines if line.unit == unit))


def _draw_panel(
    axes: Axes, lines: Sequence[Line], sources: Sequence[str], across_unit: str, *, by_name: bool
) -> None:
    """Draw lines of one unit: styles tell results apart, colours channels or else results, too."""
    names = _names(lines, lines[0].unit)
    unit = suitable_unit(lines[0].unit, *(line.values for line in lines))
    labelled: set[str] = set()
    for line in lines:
        source, name = sources.index(line.source), names.index(line.name)
        axes.plot(
            line.across.values * unit_factor(line.across.unit, across_unit),
            line.values * unit_factor(line.unit, unit),
            color=PALETTE[(name if by_name else source) % len(PALETTE)],
            linestyle=LINE_STYLES[source % len(LINE_STYLES)],
            label=None if line.name in labelled or source else plain(line.name),
        )
        labelled.add(line.name)
    leave_room(axes)
    words = {line.words for line in lines}
    shared = words.pop() if len(words) == 1 else ""
    label = axis_label(plain(shared or (names[0] if len(names) == 1 else "")), unit)
    axes.set_ylabel(fill(label, LABEL_WIDTH))
    if len(names) > 1:
        columns = 3 if max(map(len, names)) <= SHORT_NAME else 2
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns)
