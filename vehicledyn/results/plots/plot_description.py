"""Descriptions of plots, as a run stores them in its result file.

A description is plain data. Values against time, one panel above the other::

    {"name": "yaw", "kind": "time", "title": "Yaw",
     "panels": [{"label": "Yaw rate", "unit": "deg/s",
                 "channels": ["chassis.yaw_rate"], "labels": ["chassis"]}]}

Values against another channel, which stand where "x" and its unit are named::

    {"name": "camber", "kind": "time", "x": "wheel.z", "x_unit": "mm", "panels": [...]}

A path seen from above, with the cones and the body's outline where the file's scene has them::

    {"name": "path", "kind": "path", "title": "Path", "x": "chassis.x", "y": "chassis.y",
     "heading": "chassis.yaw", "cones": true}

``labels`` (names of the lines), ``heading`` and ``cones`` may be left out.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError, errors_of, unknown_name
from vehicledyn.base.units import parse_unit

_LONGEST = 100
_MOST_PLOTS, _MOST_PANELS, _MOST_LINES = 1000, 30, 200
"""Panels and lines of a figure that is drawn as described, not arranged by its drawing."""
_FILE_NAME = re.compile(rf"[^./\\\x00-\x1f\x7f][^/\\\x00-\x1f\x7f]{{0,{_LONGEST - 1}}}")


@dataclass(frozen=True)
class Panel:
    """Channels that share one axis, shown in ``unit``."""

    label: str
    unit: str
    channels: tuple[str, ...]
    labels: tuple[str, ...]


@dataclass(frozen=True)
class TimePlot:
    """Values against time, or against the channel ``x`` where it is not empty.

    If ``arranged``, the lines of each panel are put into panels of like range when it is drawn.
    If ``named``, a legend names the line of a panel with a single one, too.
    """

    name: str
    title: str
    panels: tuple[Panel, ...]
    x: str = ""
    x_unit: str = ""
    arranged: bool = False
    named: bool = False


@dataclass(frozen=True)
class PathPlot:
    """A path seen from above; ``heading`` is empty where no outline is to be drawn."""

    name: str
    title: str
    x: str
    y: str
    heading: str
    cones: bool


Plot = TimePlot | PathPlot


def read_plots(descriptions: Iterable[Mapping[str, Any]], source: str | Path) -> tuple[Plot, ...]:
    """Return the plots that descriptions ask for.

    Raises
    ------
    InputError
        If a description lacks a part or is of an unknown kind; it names the file, ``source``.
    """
    with errors_of(source):
        return _read_plots(descriptions)


def _read_plots(descriptions: Iterable[Mapping[str, Any]]) -> tuple[Plot, ...]:
    given = list(descriptions)
    if len(given) > _MOST_PLOTS:
        raise InputError(f"describes {len(given)} plots; at most {_MOST_PLOTS} are drawn")
    plots = tuple(_read_plot(description) for description in given)
    names = [plot.name for plot in plots]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two plots are named '{name}'; rename one")
    return plots


def unit_factor(unit: str, shown: str) -> float:
    """Return what to multiply values in one unit with to show them in another.

    >>> round(unit_factor("rad/s", "deg/s"), 3)
    57.296

    Raises
    ------
    InputError
        If a unit is unknown or the two have different dimensions.
    """
    if unit == shown:
        return 1.0
    given, wanted = parse_unit(unit), parse_unit(shown)
    if given.dimension != wanted.dimension:
        raise InputError(f"values in {unit} cannot be shown in {shown}")
    return given.factor / wanted.factor


def _read_plot(description: Mapping[str, Any]) -> Plot:
    name = str(description.get("name", ""))
    if not _FILE_NAME.fullmatch(name):
        shown = name[:_LONGEST].encode("unicode_escape").decode()
        raise InputError(f"a plot is named '{shown}'; give it a name that a file can have")
    try:
        kind = description["kind"]
        title = str(description.get("title") or name)
        if kind == "time":
            panels = tuple(_read_panel(name, panel) for panel in _list(name, description["panels"]))
            if not panels:
                raise InputError(f"plot '{name}' has no panels")
            x, x_unit = (str(description.get(key) or "") for key in ("x", "x_unit"))
            is_arranged = bool(description.get("arranged"))
            if not is_arranged:
                _check_size(name, panels)
            return TimePlot(name, title, panels, x, x_unit, is_arranged)
        if kind == "path":
            return PathPlot(
                name,
                title,
                x=str(description["x"]),
                y=str(description["y"]),
                heading=str(description.get("heading") or ""),
                cones=bool(description.get("cones", False)),
            )
    except KeyError as error:
        raise InputError(f"plot '{name}' says nothing of its {error}") from None
    raise InputError(f"plot '{name}': {unknown_name('kind', str(kind), ('time', 'path'))}")


def _check_size(plot: str, panels: tuple[Panel, ...]) -> None:
    if len(panels) > _MOST_PANELS:
        raise InputError(f"plot '{plot}' has {len(panels)} panels, more than {_MOST_PANELS}")
    lines = max(len(panel.channels) for panel in panels)
    if lines > _MOST_LINES:
        raise InputError(f"plot '{plot}': a panel has {lines} lines, more than {_MOST_LINES}")


def _list(plot: str, value: Any) -> list[Any]:
    if not isinstance(value, list | tuple):
        raise InputError(f"plot '{plot}': a list is needed of panels, channels and labels")
    return list(value)


def _read_panel(plot: str, panel: Any) -> Panel:
    if not isinstance(panel, Mapping):
        raise InputError(f"plot '{plot}': a panel is no mapping")
    channels = tuple(str(channel) for channel in _list(plot, panel["channels"]))
    labels = tuple(str(label) for label in _list(plot, panel.get("labels") or channels))
    if len(labels) != len(channels):
        raise InputError(
            f"panel '{panel['label']}' has {len(labels)} labels for {len(channels)} channels"
        )
    return Panel(str(panel["label"]), str(panel["unit"]), channels, labels)
