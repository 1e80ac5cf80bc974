"""A path seen from above: the whole course, and true to scale with cones and body outlines."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.results.plots.canvas import drawable
from vehicledyn.results.plots.overlay import SCENERY
from vehicledyn.results.plots.plot_description import PathPlot, unit_factor
from vehicledyn.results.plots.plot_style import BLUE, ORANGE, WIDTH, axis_label
from vehicledyn.results.store.reader import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

SLENDER = 6.0  # a course longer than this many widths is cut into rows
ROW_LENGTH = 58.0  # m, the longest row that shows a body of 4 m clearly
MARGIN = 1.0  # m round the drawing
OUTLINE_SPACING = 6.0  # m between two outlines along the path
ROW_OVERLAP = 4.0  # m that a row repeats of its neighbour, so that no cone is cut in two
MOST_ROWS = 12  # of a longer course the overview is drawn alone
MOST_OUTLINES = 1000
OVERVIEW_HEIGHT = 1.5  # inch


@dataclass(frozen=True)
class _Course:
    """What the picture shows, all in metres: path, heading, cones and outline.

    ``length`` and ``width`` are the lowest and highest x and y with a margin for the body.
    """

    x: Floats
    y: Floats
    heading: Floats | None
    cones: Floats
    radius: float
    outline: Floats | None
    length: tuple[float, float]
    width: tuple[float, float]


def draw_path(
    result: Result,
    plot: PathPlot,
    new_figure: Callable[[float], Figure],
    beside: Sequence[Result] = (),
) -> Figure:
    """Return the figure of a path, with room for the paths of results to be laid over it.

    A slender course is shown twice: whole, with the lateral scale stretched, and cut into
    rows true to scale, unless these were more than ``MOST_ROWS``. Any other course is shown
    once, true to scale.
    """
    course = _course(result, plot)
    if beside:
        courses = [course, *(_course(other, plot) for other in beside)]
        along, across = (_union([c.length for c in courses]), _union([c.width for c in courses]))
        course = replace(course, length=along, width=across)
    length, width = np.diff(course.length)[0], np.diff(course.width)[0]
    if length <= SLENDER * width:
        figure = new_figure(min(WIDTH * width / length, 8.0) + 1.2)
        axes = figure.subplots()
        _draw_true(axes, course, course.length)
        return figure
    rows = math.ceil(length / ROW_LENGTH)
    row_height = 0.9 * WIDTH * width * rows / length + 0.5
    if rows > MOST_ROWS:
        figure = new_figure(OVERVIEW_HEIGHT + 1.2)
        _draw_overview(figure.subplots(), course)
        return figure
    figure = new_figure(OVERVIEW_HEIGHT + rows * row_height + 1.2)
    axes = figure.subplots(rows + 1, 1, height_ratios=[OVERVIEW_HEIGHT, *[row_height] * rows])
    _draw_overview(axes[0], course)
    edges = np.linspace(*course.length, rows + 1)
    for place, start, end in zip(axes[1:], edges[:-1], edges[1:], strict=True):
        _draw_true(place, course, (start - ROW_OVERLAP / 2.0, end + ROW_OVERLAP / 2.0))
    axes[1].set_title("true to scale, in rows", fontsize=8, loc="left", color="0.35")
    return figure


def _course(result: Result, plot: PathPlot) -> _Course:
    scene = result.scene
    cones, radius = np.empty((0, 2)), 0.0
    if plot.cones and "cones" in scene:
        cones = np.asarray(scene["cones"].values, dtype=float)
        radius = float(scene["cones"].attributes.get("radius", 0.0))
    outline = scene["outline"].values if plot.heading and "outline" in scene else None
    columns = [_values(result, plot.x, "m"), _values(result, plot.y, "m")]
    columns += [_values(result, plot.heading, "rad")] if plot.heading else []
    table = drawable(np.stack(columns, axis=1))
    table = table[np.all(np.isfinite(table), axis=1)]
    if not len(table):
        raise InputError(f"{result.path}: plot '{plot.name}' has no finite positions to show")
    shape = None if outline is None else np.asarray(outline, dtype=float)
    return _Course(
        x=table[:, 0],
        y=table[:, 1],
        heading=table[:, 2] if plot.heading else None,
        cones=cones,
        radius=radius,
        outline=shape,
        length=_reach(table[:, 0], shape, 0),
        width=_reach(np.concatenate([table[:, 1], cones[:, 1]]), shape, 1),
    )


def _reach(values: Floats, outline: Floats | None, axis: int) -> tuple[float, float]:
    margin = MARGIN if outline is None else MARGIN + float(np.max(outline[:, axis]))
    return float(np.min(values)) - margin, float(np.max(values)) + margin


def _union(spans: Sequence[tuple[float, float]]) -> tuple[float, float]:
    return min(low for low, _ in spans), max(high for _, high in spans)


def _values(result: Result, name: str, unit: str) -> Floats:
    series = result.channel(name)
    values: Floats = series.values * unit_factor(series.unit, unit)
    return values


def _draw_overview(axes: Axes, course: _Course) -> None:
    axes.plot(course.x, course.y, color=BLUE)
    axes.plot(
        course.cones[:, 0],
        course.cones[:, 1],
        "^",
        color=ORANGE,
        markeredgecolor="0.2",
        gid=SCENERY,
    )
    for number, (x, y) in enumerate(course.cones, start=1):
        axes.annotate(
            str(number),
            (x, y),
            xytext=(0, 5),
            textcoords="offset points",
            ha="center",
            fontsize=7.5,
        )
    axes.set_xlim(*course.length)
    axes.set_xlabel(axis_label("x", "m"), labelpad=1.0)
    axes.set_ylabel(axis_label("y", "m"))
    axes.set_title("lateral scale stretched", fontsize=8, loc="left", color="0.35")


def _draw_true(axes: Axes, course: _Course, span: tuple[float, float]) -> None:
    from matplotlib.patches import Circle

    _draw_outlines(axes, course)
    axes.plot(course.x, course.y, color=BLUE)
    for number, (x, y) in enumerate(course.cones, start=1):
        if span[0] + 1.0 <= x <= span[1] - 1.0:
            cone = Circle((x, y), course.radius, facecolor=ORANGE, edgecolor="0.2", zorder=3)
            cone.set_gid(SCENERY)
            axes.add_patch(cone)
            axes.annotate(
                str(number),
                (x, y),
                xytext=(4, 3),
                textcoords="offset points",
                fontsize=7,
                annotation_clip=True,
            )
    axes.set_aspect("equal")
    axes.set_xlim(*span)
    axes.set_ylim(*course.width)
    axes.set_xlabel(axis_label("x", "m"), labelpad=1.0)
    axes.set_ylabel(axis_label("y", "m"))


def _draw_outlines(axes: Axes, course: _Course) -> None:
    from matplotlib.collections import PolyCollection

    if course.outline is None or course.heading is None:
        return
    travelled = np.cumsum(
        np.hypot(np.diff(course.x, prepend=course.x[0]), np.diff(course.y, prepend=course.y[0]))
    )
    spacing = max(OUTLINE_SPACING, travelled[-1] / MOST_OUTLINES)
    samples = np.searchsorted(travelled, np.arange(0.0, travelled[-1] + 1e-9, spacing))
    cosine, sine = np.cos(course.heading[samples]), np.sin(course.heading[samples])
    forward, left = course.outline[:, 0], course.outline[:, 1]
    corners = np.stack(
        [
            course.x[samples, None] + np.outer(cosine, forward) - np.outer(sine, left),
            course.y[samples, None] + np.outer(sine, forward) + np.outer(cosine, left),
        ],
        axis=2,
    )
    axes.add_collection(
        PolyCollection(
            list(corners), facecolors="0.85", edgecolors="0.45", linewidths=0.6, zorder=1
        )
    )
