"""Figures of any arrays of results: one panel a unit, several results in one picture."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import matplotlib
import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.results.labelled.labels import Labelled, LabelledSet
from vehicledyn.results.plots.figures import HEADING_HEIGHT, PANEL_HEIGHT, new_figure
from vehicledyn.results.plots.plot_description import unit_factor
from vehicledyn.results.plots.plot_style import LINE_STYLES, PALETTE, STYLE, axis_label, plain
from vehicledyn.results.plots.standard import standard_figures

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_LINES = 60
"""Lines that an array may have."""

_SHOWN_AS = {"rad": "deg", "rad/s": "deg/s", "rad/s^2": "deg/s^2"}


class Axis(NamedTuple):
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
    across: Axis
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
    lines = [
        line
        for source, one in several.items()
        for name in one.names(*patterns)
        for line in _lines(one[name], one[against] if against else None, source)
    ]
    return _drawn(lines, next(iter(data.values())).title)


def draw_standard(data: LabelledSet) -> Figure:
    """Return the first figure that results of this kind have.

    Raises
    ------
    InputError
        If there is none.
    """
    with matplotlib.rc_context(STYLE):
        for _, figure in standard_figures(data.path):
            return _for_notebooks(figure)
    raise InputError(f"{data.title}: has no standard figure; name arrays to draw")


def draw_array(array: Labelled) -> Figure:
    """Return a figure of an array over its time, or else its first dimension."""
    return _drawn(list(_lines(array, None, "")), array.name)


def _lines(array: Labelled, against: Labelled | None, source: str) -> Iterator[Line]:
    """Yield the lines of an array, one for each place along its further dimensions."""
    if not array.dims or array.values.dtype.kind not in "fiub":
        what = "complex" if array.values.dtype.kind == "c" else "no line of numbers"
        raise InputError(f"{array.name}: is {what} ({array.size_in_words}) and cannot be drawn")
    dim = "time" if "time" in array.dims else array.dims[0]
    place = array.dims.index(dim)
    across = _axis(array, dim, array.values.shape[place], against)
    columns = np.moveaxis(array.values, place, 0).reshape(len(across.values), -1)
    if columns.shape[1] > MOST_LINES:
        raise InputError(
            f"{array.name}: has {columns.shape[1]} lines ({array.size_in_words}); choose some"
        )
    for column in columns.T:
        yield Line(array.name, column, array.unit, array.description, across, source)


def _axis(array: Labelled, dim: str, length: int, against: Labelled | None) -> Axis:
    label = array.coords.get(dim) if against is None else against
    if label is None or label.values.dtype.kind not in "fiu":
        return Axis(np.arange(length), "1", dim.capitalize())
    if label.values.shape != (length,):
        raise InputError(f"{array.name}: cannot be drawn against {label.name}, sampled otherwise")
    return Axis(label.values, label.unit, label.description or label.name)


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
    figure = new_figure(HEADING_HEIGHT + PANEL_HEIGHT * max(len(units), 1.4))
    panels = figure.subplots(len(units), 1, sharex=True, squeeze=False)[:, 0]
    for axes, unit in zip(panels, units, strict=True):
        _draw_panel(axes, [line for line in lines if line.unit == unit])
    across = lines[0].across
    panels[-1].set_xlabel(axis_label(plain(across.words), _shown(across.unit)))
    figure.align_ylabels(panels)
    figure.suptitle(plain(title), fontsize=10.5, fontweight="bold", x=0.01, ha="left")
    return figure


def _draw_panel(axes: Any, lines: Sequence[Line]) -> None:
    """Draw lines of one unit: colours distinguish arrays and styles results, or colours both."""
    names = list(dict.fromkeys(line.name for line in lines))
    sources = list(dict.fromkeys(line.source for line in lines))
    labels: list[str] = []
    for line in lines:
        which = (names.index(line.name), sources.index(line.source))
        colour, style = (which[1], 0) if len(names) == 1 else which
        text = line.source if len(names) == 1 and line.source else line.name
        label = ", ".join(filter(None, (text, line.source))) if len(names) > 1 else text
        across = line.across
        axes.plot(
            across.values * unit_factor(across.unit, _shown(across.unit)),
            line.values * unit_factor(line.unit, _shown(line.unit)),
            color=PALETTE[colour % len(PALETTE)],
            linestyle=LINE_STYLES[style % len(LINE_STYLES)],
            label=None if label in labels else plain(label),
        )
        labels.append(label)
    words = lines[0].words or names[0]
    axes.set_ylabel(axis_label(plain(words) if len(names) == 1 else "", _shown(lines[0].unit)))
    if len(set(labels)) > 1:
        axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)


def _shown(unit: str) -> str:
    return _SHOWN_AS.get(unit, unit)
