"""All that is drawn of one result: shapes, poses, forces, cones, ground, and channels beside.

The page and the still picture are made from it, and nothing else.
"""

from __future__ import annotations

import fnmatch
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import PurePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.numbers.quaternions import continuous, rotated
from vehicledyn.results.plots.arrangement import arranged
from vehicledyn.results.plots.plot_description import TimePlot, read_plots
from vehicledyn.results.store.animation_section import Animation, Pictures, Span
from vehicledyn.results.store.reader import Result
from vehicledyn.results.store.values import Series

Array = NDArray[np.float64]
Plain = Mapping[str, Any]

MOST_VALUES = 900_000
"""Values of channels that a page holds at most."""

_NO_SHAPES = (
    "holds no shapes and poses to animate; they are kept by 'vehicledyn run' unless the scenario "
    "says 'output: {animation: false}'; run it again"
)


@dataclass(frozen=True)
class Arrow:
    """A force in the course of time: its name, foot (n, 3) [m] and components (n, 3) [N]."""

    name: str
    foot: Array
    force: Array


@dataclass(frozen=True)
class PlotPanel:
    """Channels of one unit that are shown in one picture; ``title`` says what they are."""

    title: str
    unit: str
    channels: tuple[str, ...]


@dataclass(frozen=True)
class AnimatedScene:
    """A result to be drawn; times are those of ``pictures``, shape (n,).

    ``channels`` are sampled at those times; ``cones`` are their feet (m, 2) [m] with one radius.
    """

    label: str
    title: str
    model: str
    state: str
    is_whole: bool
    created: str
    bodies: Sequence[Plain]
    shapes: Sequence[Plain]
    pictures: Pictures
    arrows: Sequence[Arrow]
    channels: Sequence[Series]
    panels: Sequence[PlotPanel]
    cones: Array
    cone_radius: float
    ground: Array | None
    track: Array | None
    levels: Mapping[str, Series] = field(default_factory=dict)
    """Channels that shapes are coloured by, each sampled at the times."""

    @property
    def highest_level(self) -> float:
        """Largest value of these channels; zero if there is none."""
        most = [float(np.nanmax(np.abs(s.values), initial=0.0)) for s in self.levels.values()]
        return max(most, default=0.0)

    @property
    def time(self) -> Array:
        """Times of the pictures [s]."""
        return self.pictures.time

    @property
    def usual_force(self) -> float:
        """Force that most samples of all arrows do not exceed [N]; the scale of the arrows."""
        sizes = [np.linalg.norm(arrow.force, axis=1) for arrow in self.arrows]
        known = np.concatenate(sizes) if sizes else np.empty(0)
        known = known[known > 0.0]
        return float(np.quantile(known, 0.9)) if len(known) else 0.0

    @property
    def bad_from(self) -> float | None:
        """First time at which a pose is not a number [s], None if all are."""
        whole = np.isfinite(self.pictures.position).all(axis=(1, 2))
        return None if whole.all() else float(self.time[int(np.argmin(whole))])


def scene_of(
    result: Result, span: Span, *, patterns: Sequence[str] = (), plots: bool = True
) -> AnimatedScene:
    """Return what is drawn of a result.

    Parameters
    ----------
    result
        An open result.
    span
        Which pictures.
    patterns
        Channels to plot beside, as shell patterns; the figures' and then all others if empty.
    plots
        Whether there are any channels beside.

    Raises
    ------
    InputError
        If the result holds no shapes, poses or channel that matches.
    """
    found = result.animation(span)
    if found is None:
        raise InputError(f"{result.path}: {_NO_SHAPES}")
    if not len(found.pictures.time):
        between = "" if span.begin == -np.inf and span.end == np.inf else " between these times"
        words = f"holds no pictures to animate{between} ({result.state_of_run})"
        raise InputError(f"{result.path}: {words}")
    pictures = replace(found.pictures, quaternion=continuous(found.pictures.quaternion))
    rows = np.clip(result.column("time").first_from(pictures.time), 0, result.samples - 1)
    panels = _panels(result, rows)
    cones = result.scene.get("cones")
    return AnimatedScene(
        label=result.path.name,
        title=result.title,
        model=PurePath(result.model).stem or result.model,
        state=result.state_of_run,
        is_whole=result.is_whole,
        created=result.created,
        bodies=found.stage.bodies,
        shapes=[shape for shape in found.stage.shapes if shape["kind"] != "force"],
        pictures=pictures,
        arrows=_arrows(result, found, pictures, rows),
        channels=_channels(result, panels, patterns, rows) if plots else [],
        panels=panels,
        cones=np.empty((0, 2)) if cones is None else np.asarray(cones.values, dtype=float),
        cone_radius=0.0 if cones is None else float(cones.attributes.get("radius", 0.15)),
        ground=found.ground,
        track=found.track,
        levels=_levels(result, found, rows),
    )


def _levels(result: Result, found: Animation, rows: NDArray[np.intp]) -> dict[str, Series]:
    """Return the channels that shapes are coloured by, as far as the result keeps them."""
    named = {shape["coloured_by"] for shape in found.stage.shapes if shape["coloured_by"]}
    return {name: result.channel(name, rows) for name in sorted(named & set(result.channels))}


def _panels(result: Result, rows: NDArray[np.intp]) -> list[PlotPanel]:
    """Return the panels of the result's figures along time, arranged as the figures are.

    Those with nothing but ways travelled and angles turned, which only rise or fall, come last.
    """
    panels = []
    for plot in read_plots(result.plots, result.path):
        if isinstance(plot, TimePlot):
            whole = set(result.channels).issuperset(c for p in plot.panels for c in p.channels)
            tidy = plot.arranged and whole
            for panel in (arranged(result, plot, rows) if tidy else plot).panels:
                title = f"{panel.label}: {', '.join(panel.channels)}" if tidy else panel.label
                panels.append(PlotPanel(title, panel.unit, tuple(panel.channels)))
    return sorted(panels, key=lambda panel: _only_rises_or_falls(result, panel, rows))


def _only_rises_or_falls(result: Result, panel: PlotPanel, rows: NDArray[np.intp]) -> bool:
    """Return whether each line of a panel moves one way all the time and none oscillates."""
    for name in set(panel.channels) & set(result.channels):
        steps = np.diff(result.channel(name, rows).values)
        if (steps > 0.0).any() and (steps < 0.0).any():
            return False
    return True


def _channels(
    result: Result, panels: Sequence[PlotPanel], patterns: Sequence[str], rows: NDArray[np.intp]
) -> list[Series]:
    """Return the channels to show, those of the figures first, as many as fit a page."""
    if patterns:
        for pattern in patterns:
            if not fnmatch.filter(result.channels, pattern):
                guess = nearest_name(pattern, result.channels)
                hint = f"; did you mean '{guess}'?" if guess else ""
                raise InputError(f"{result.path}: '{pattern}' matches no channel{hint}")
        names = [n for n in result.channels if any(fnmatch.fnmatchcase(n, p) for p in patterns)]
    else:
        known = set(result.channels)
        drawn = [name for panel in panels for name in panel.channels if name in known]
        names = list(dict.fromkeys([*drawn, *result.channels]))
    most = max(1, MOST_VALUES // max(1, len(rows)))
    return [result.channel(name, rows) for name in names[:most]]


def _arrows(
    result: Result, found: Animation, pictures: Pictures, rows: NDArray[np.intp]
) -> list[Arrow]:
    """Return the forces whose channels the result keeps."""
    place = {body["name"]: index for index, body in enumerate(found.stage.bodies)}
    arrows = []
    for shape in found.stage.shapes:
        if shape["kind"] != "force" or not set(_needed(shape)) <= set(result.channels):
            continue
        body = shape["body"] or (shape["at"]["body"] if isinstance(shape["at"], dict) else None)
        index = place.get(body) if body else None
        if body and index is None:
            continue
        foot = _foot(result, shape, pictures, index, rows)
        parts = [
            np.zeros(len(rows)) if name is None else factor * result.channel(name, rows).values
            for name, factor in zip(shape["components"], shape["factors"], strict=True)
        ]
        axes = _axes(result, shape, pictures, index, foot=foot, rows=rows)
        force = sum(part[:, None] * axis for part, axis in zip(parts, axes, strict=True))
        arrows.append(Arrow(shape["name"], foot, np.asarray(force)))
    return arrows


def _needed(shape: Plain) -> list[str]:
    places = [] if isinstance(shape["at"], dict) else shape["at"]
    return [name for name in (*places, *shape["components"], shape["camber"]) if name]


def _foot(
    result: Result, shape: Plain, pictures: Pictures, index: int | None, rows: NDArray[np.intp]
) -> Array:
    at = shape["at"]
    if not isinstance(at, dict):
        return np.column_stack([result.channel(name, rows).values for name in at])
    point = np.array(at["point"], dtype=float)
    if index is None:
        return np.tile(point, (len(rows), 1))
    return pictures.position[:, index] + rotated(pictures.quaternion[:, index], point)


def _axes(
    result: Result,
    shape: Plain,
    pictures: Pictures,
    index: int | None,
    *,
    foot: Array,
    rows: NDArray[np.intp],
) -> list[Array]:
    """Return the three directions of a force's components, each (n, 3) or (3,).

    On the ground the spoke e_s leads from the contact point to the wheel's centre; with the spin
    axis e_y the wheel's direction is e_x = e_y × e_s, the normal n = cos γ e_s + sin γ e_y for the
    camber γ, and n × e_x points to the left.
    """
    unit = np.eye(3)
    if shape["axes"] == "world" or index is None:
        return [unit[0], unit[1], unit[2]]
    turned = [rotated(pictures.quaternion[:, index], axis) for axis in unit]
    if shape["axes"] != "contact":
        return turned
    spoke = pictures.position[:, index] - foot
    spoke /= np.maximum(np.linalg.norm(spoke, axis=1, keepdims=True), 1e-12)
    camber = result.channel(shape["camber"], rows).values[:, None]
    along = np.cross(turned[1], spoke)
    normal = np.cos(camber) * spoke + np.sin(camber) * turned[1]
    return [along, np.cross(normal, along), normal]
