"""Figures to pictures within the page, each with a text alternative made from what it shows."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from vehicledyn.results.plots.picture_files import METADATA, settle, signs_may_be_missing
from vehicledyn.results.report.page import Picture
from vehicledyn.results.report.texts import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

LARGEST_DRAWING = 400_000
"""Bytes above which a picture is made of dots instead of lines."""
MOST_LINES = 8
PIXELS = 96
"""Pixels of a page to the inch."""


def picture(figure: Figure, *, caption: str = "", dots: bool = False) -> Picture:
    """Return a figure as a picture: a drawing, or dots where that is asked for or smaller."""
    settle(figure)
    kind, data = "png", b""
    if not dots:
        kind, data = "svg+xml", _drawn(figure, "svg")
    if dots or len(data) > LARGEST_DRAWING:
        kind, data = "png", _drawn(figure, "png")
    width, height = figure.get_size_inches()
    return Picture(
        address=f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}",
        width=round(width * PIXELS),
        height=round(height * PIXELS),
        alternative=": ".join(filter(None, (caption, described(figure)))),
        caption=caption,
    )


def described(figure: Figure) -> str:
    """Return what a figure shows, in words: its axes and the range of each line."""
    shown = [axes for axes in figure.axes if axes.get_visible()]
    parts = [text for axes in shown if (text := _described(axes, _across(axes, shown)))]
    return ". ".join([_title(figure), *parts]) + "."


def _drawn(figure: Figure, kind: str) -> bytes:
    stream = io.BytesIO()
    with signs_may_be_missing():
        figure.savefig(stream, format=kind, metadata=METADATA[kind])
    return stream.getvalue()


def _title(figure: Figure) -> str:
    return _clean(figure.get_suptitle() or "Figure")


def _clean(text: str) -> str:
    """Return the text of a picture on one line."""
    return " ".join(text.split())


def _across(axes: Axes, shown: Iterable[Axes]) -> str:
    """Return the label along the horizontal axis, of the lowest panel where it is shared."""
    own = axes.get_xlabel()
    partners = axes.get_shared_x_axes().get_siblings(axes)
    labels = [other.get_xlabel() for other in shown if other in partners and other.get_xlabel()]
    return _clean(own or (labels[-1] if labels else ""))


def _described(axes: Axes, across: str) -> str:
    if axes.get_label() == "<colorbar>":
        return ""
    upright = _clean(axes.get_ylabel())
    what = " against ".join(filter(None, (upright or _clean(axes.get_title()), across)))
    lines = [text for line in axes.get_lines() if (text := _line(line))]
    more = len(lines) - MOST_LINES
    listed = "; ".join(lines[:MOST_LINES]) + (f"; and {more} more lines" if more > 0 else "")
    if not lines and axes.patches:
        listed = f"{len(axes.patches)} bars"
    if not lines and axes.images:
        listed = "values as colours"
    return f"{what}: {listed}" if listed else what


def _line(line: Line2D) -> str:
    values = np.ma.masked_invalid(np.asarray(line.get_ydata(), dtype=float)).compressed()
    if not values.size:
        return ""
    name = _clean(str(line.get_label()))
    head = "" if name.startswith("_") else f"{name} "
    low, high = number(float(values.min())), number(float(values.max()))
    return f"{head}at {low}" if low == high else f"{head}from {low} to {high}"
