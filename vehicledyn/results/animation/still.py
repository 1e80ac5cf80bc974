"""Still pictures of an animation, drawn without a browser.

A pinhole camera projects the faces of all shapes, the farthest are drawn first, and each is as
bright as it faces the light.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from textwrap import fill, wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.results.animation.camera import FIELD, Camera
from vehicledyn.results.animation.frame_state import bounds_of
from vehicledyn.results.animation.levels import RAMP, level_words
from vehicledyn.results.animation.scene import AnimatedScene
from vehicledyn.results.animation.solids import faces_of
from vehicledyn.results.hdf5.output import write_failed
from vehicledyn.results.plots.picture_files import METADATA, check_formats
from vehicledyn.results.plots.plot_style import STYLE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

WIDTH, HEIGHT, RESOLUTION = 8.0, 4.5, 160
_SKY, _LINE, _INK = "#e9eff4", "#b9c5cf", "#1c2630"
_TITLE_WIDTH, _TEXT_WIDTH = 80, 115
"""Letters of a line of the title and of the text below it that a picture is wide."""


def draw_picture(scene: AnimatedScene, target: Path, *, time: float | None, view: str) -> Path:
    """Draw a scene at a time [s], the middle if None, into a png, svg or pdf file.

    Raises
    ------
    InputError
        If the time lies outside of the result, or the picture cannot be written.
    """
    import matplotlib as mpl

    kind = target.suffix[1:].lower()
    check_formats([kind])
    moment = time_in(scene, time)
    with mpl.rc_context(STYLE):
        figure = figure_of(scene, moment, view)
        try:
            with whole_file(target) as place:
                figure.savefig(place, format=kind, dpi=RESOLUTION, metadata=METADATA[kind])
        except OSError as error:
            raise write_failed(target, error) from error
    return target


def time_in(scene: AnimatedScene, time: float | None) -> float:
    """Return a time of a scene [s]; the middle if None, an InputError if it lies outside."""
    begin, end = float(scene.time[0]), float(scene.time[-1])
    if time is None:
        return 0.5 * (begin + end)
    if not begin <= time <= end:
        raise InputError(f"{scene.label}: t = {time:g} s lies outside of {begin:g} to {end:g} s")
    return time


def figure_of(scene: AnimatedScene, time: float, view: str) -> Figure:
    """Return a figure of a scene at a time [s]."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, HEIGHT), facecolor=_SKY)
    FigureCanvasAgg(figure)
    paint(figure, scene, time, view)
    return figure


def paint(figure: Figure, scene: AnimatedScene, time: float, view: str) -> None:
    """Draw a scene at a time [s] into a figure, in place of what it holds."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import to_rgba

    figure.clear()
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_facecolor(_SKY)
    half = math.tan(0.5 * FIELD)
    axes.set_xlim(-half * WIDTH / HEIGHT, half * WIDTH / HEIGHT)
    axes.set_ylim(-half, half)
    bounds = bounds_of(scene)
    extent = bounds.size
    camera = Camera.behind(scene, time, view, bounds, WIDTH / HEIGHT)
    lines = [line for line in map(camera.line, _ground(scene, camera.target, extent)) if len(line)]
    axes.add_collection(LineCollection(lines, colors=_LINE, linewidths=0.5, zorder=1.0))
    seen = []
    for face in faces_of(scene, time, extent):
        flat, depth = camera.face(face)
        if len(flat):
            seen.append((depth, flat, to_rgba(camera.shade(face), face.opacity), face))
    seen.sort(key=lambda item: (item[3].layer, -item[0]))
    axes.add_collection(
        PolyCollection(
            [flat for _, flat, _, _ in seen],
            facecolors=[colour for _, _, colour, _ in seen],
            edgecolors=[_INK if face.opacity < 1.0 else colour for _, _, colour, face in seen],
            zorder=2.0,
            linewidths=[0.4 if face.opacity < 1.0 else 0.2 for _, _, _, face in seen],
        )
    )
    text: dict[str, Any] = {"transform": axes.transAxes, "color": _INK, "va": "top"}
    title = wrap(scene.title, _TITLE_WIDTH)
    axes.text(0.02, 0.965, "\n".join(title), fontsize=11, weight="bold", **text)
    state = "" if scene.is_whole else f" · {scene.state}"
    described = fill(f"{scene.model} · t = {time:.2f} s{state}", _TEXT_WIDTH)
    axes.text(0.02, 0.965 - 0.06 * max(1, len(title)), described, fontsize=8.5, **text)
    if scene.levels:
        _draw_scale(figure, level_words(scene))


def _draw_scale(figure: Figure, words: str) -> None:
    """Draw the colours from nothing to the highest value, and what they mean."""
    from matplotlib.colors import LinearSegmentedColormap

    axes = figure.add_axes((0.74, 0.05, 0.24, 0.025))
    axes.imshow(
        np.linspace(0.0, 1.0, 256)[None],
        aspect="auto",
        cmap=LinearSegmentedColormap.from_list("levels", RAMP),
    )
    axes.set_axis_off()
    axes.set_title(words, fontsize=8.5, color=_INK)


def _ground(scene: AnimatedScene, target: Array, extent: float) -> Iterator[Array]:
    """Yield lines of the ground around a place, each of two points."""
    if scene.ground is not None:
        near = np.abs(scene.ground[:, :, :2] - target[:2]).max(axis=2) < 12.0 * extent
        for surface, kept in ((scene.ground, near), (scene.ground.swapaxes(0, 1), near.T)):
            for row in range(0, surface.shape[0], 2 if surface is scene.ground else 4):
                for k in range(surface.shape[1] - 1):
                    if kept[row, k] and kept[row, k + 1]:
                        yield surface[row, k : k + 2]
        return
    plane = next((shape for shape in scene.shapes if shape["kind"] == "plane"), None)
    point, normal = np.array([0.0, 0.0, target[2] - 0.6 * extent]), np.array([0.0, 0.0, 1.0])
    if scene.track is not None:
        point[2] = float(scene.track[:, :, 2].min()) - 0.45
    if plane is not None:
        point, normal = np.array(plane["point"], float), np.array(plane["normal"], float)
    power = 10.0 ** math.floor(math.log10(extent / 2.0))
    cell = next(n * power for n in (1, 2, 5, 10) if n * power >= extent / 2.5)
    centre = np.round(target[:2] / cell) * cell
    span = cell * np.arange(-24, 25)

    def lifted(x: float, y: float) -> list[float]:
        drop = normal[0] * (x - point[0]) + normal[1] * (y - point[1])
        return [x, y, float(point[2] - drop / normal[2])]

    for c in span:
        for k in range(0, 48, 4):
            low, high = span[k], span[k + 4]
            for a, b in (((c, low), (c, high)), ((low, c), (high, c))):
                yield np.array([lifted(*(centre + a)), lifted(*(centre + b))])
