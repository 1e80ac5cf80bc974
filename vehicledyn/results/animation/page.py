"""The page of an animation: one HTML file that needs nothing else, made from scenes.

Everything that comes from a file goes into the page as JSON in a script element that is not
executed, with ``<`` escaped, and is shown as text only.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from importlib import resources
from typing import Any

import numpy as np

from vehicledyn.base.units import parse_unit
from vehicledyn.results.animation.levels import level_words
from vehicledyn.results.animation.packed_columns import PackedColumns
from vehicledyn.results.animation.scene import AnimatedScene
from vehicledyn.results.plots.plot_style import axis_label

PROGRAM = ("columns", "looks", "shapes", "actor", "ground", "plots", "clock", "start")
"""Parts of the page's program, which share their names, in the order in which they run."""

FINEST = 1e-4
"""Resolution of positions [m]."""

_PRECISE = 1e-9
_SHOWN_IN = {"rad": "deg", "rad/s": "deg/s", "rad/s^2": "deg/s^2"}
_MOST_LINES = 6


def page_of(scenes: Sequence[AnimatedScene]) -> str:
    """Return the HTML page that shows scenes, the second and further ones laid over the first."""
    columns = PackedColumns()
    content: dict[str, Any] = {"scenes": [_scene(scene, columns) for scene in scenes]}
    content["columns"] = columns.describe
    text = json.dumps(content, ensure_ascii=False, default=float, separators=(",", ":"))
    parts = {
        "TITLE": _escaped(scenes[0].title),
        "STYLE": _resource("animation.css"),
        "LIBRARY": _resource("three.bundle.js"),
        "PROGRAM": "\n".join(_resource(f"animation/{part}.js") for part in PROGRAM),
        "DATA": text.replace("<", "\\u003c").replace("\u2028", "\\u2028"),
        "PACKED": columns.packed,
    }
    # Split once: what is put in is never searched for places itself.
    pieces = re.split(r"@([A-Z]+)@", _resource("animation.html"))
    return "".join(parts[piece] if k % 2 else piece for k, piece in enumerate(pieces))


def _scene(scene: AnimatedScene, columns: PackedColumns) -> dict[str, Any]:
    p = scene.pictures
    origin = p.position[:, 0]
    bodies = []
    for k, body in enumerate(scene.bodies):
        place, turned = p.position[:, k] - origin, p.quaternion[:, k]
        entry = dict(body)
        entry["position"] = [columns.add(place[:, i], finest=FINEST) for i in range(3)]
        entry["quaternion"] = [columns.add(turned[:, i]) for i in range(4)]
        entry["turn"] = columns.add(p.turn[:, k], finest=_PRECISE) if body["axis"] else None
        bodies.append(entry)
    return {
        "label": scene.label,
        "title": scene.title,
        "model": scene.model,
        "state": scene.state,
        "whole": scene.is_whole,
        "created": scene.created,
        "bad": scene.bad_from,
        "time": columns.add(p.time, finest=_PRECISE),
        "origin": [columns.add(origin[:, i], finest=_PRECISE) for i in range(3)],
        "bodies": bodies,
        "shapes": [_rounded(shape) for shape in scene.shapes],
        "levels": _levels(scene, columns),
        "arrows": [
            {
                "name": arrow.name,
                "foot": [
                    columns.add(arrow.foot[:, i] - origin[:, i], finest=FINEST) for i in range(3)
                ],
                "force": [columns.add(arrow.force[:, i]) for i in range(3)],
            }
            for arrow in scene.arrows
        ],
        "usual_force": scene.usual_force,
        **_channels(scene, columns),
        "cones": {"feet": scene.cones.tolist(), "radius": scene.cone_radius},
        "ground": _ground(scene, columns),
        "track": _track(scene, columns),
    }


def _channels(scene: AnimatedScene, columns: PackedColumns) -> dict[str, Any]:
    known = {series.name for series in scene.channels}
    shown = {name: panel.unit for panel in scene.panels for name in panel.channels}
    channels = []
    for series in scene.channels:
        unit = shown.get(series.name, _SHOWN_IN.get(series.unit, series.unit))
        channels.append(
            {
                "name": series.name,
                "text": series.description,
                "unit": axis_label("", unit).strip()[1:-1],
                "factor": _factor(series.unit, unit),
                "column": columns.add(series.values),
            }
        )
    panels = []
    for panel in scene.panels:
        names = [name for name in panel.channels if name in known][:_MOST_LINES]
        if names:
            panels.append({"title": panel.title, "channels": names})
    return {"channels": channels, "panels": panels}


def _levels(scene: AnimatedScene, columns: PackedColumns) -> dict[str, Any] | None:
    """Return the columns that shapes are coloured by, with the end of the scale."""
    if not scene.levels:
        return None
    known = {name: columns.add(series.values) for name, series in scene.levels.items()}
    return {"columns": known, "most": scene.highest_level, "text": level_words(scene)}


def _factor(unit: str, shown: str) -> float:
    return 1.0 if unit == shown else parse_unit(unit).factor / parse_unit(shown).factor


def _ground(scene: AnimatedScene, columns: PackedColumns) -> dict[str, Any] | None:
    if scene.ground is None:
        return None
    rows, count, _ = scene.ground.shape
    flat = scene.ground.reshape(-1, 3)
    return {
        "rows": rows,
        "columns": count,
        "points": [columns.add(flat[:, i], finest=FINEST) for i in range(3)],
    }


def _track(scene: AnimatedScene, columns: PackedColumns) -> list[list[int]] | None:
    if scene.track is None:
        return None
    return [
        [columns.add(scene.track[:, side, i], finest=FINEST) for i in range(3)] for side in (0, 1)
    ]


def _rounded(item: Any) -> Any:
    """Return plain data with numbers of six digits."""
    if isinstance(item, Mapping):
        return {key: _rounded(value) for key, value in item.items() if value is not None}
    if isinstance(item, list | tuple):
        return [_rounded(value) for value in item]
    return float(f"{item:.7g}") if isinstance(item, float | np.floating) else item


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def _resource(name: str) -> str:
    folder = resources.files("vehicledyn.results.animation.web")
    return folder.joinpath(name).read_text(encoding="utf-8")
