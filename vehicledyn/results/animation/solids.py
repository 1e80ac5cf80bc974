"""Faces of the shapes of an animation at one moment, for pictures drawn without a browser."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.animation.frame_state import SceneState, roof
from vehicledyn.results.animation.levels import level_colour
from vehicledyn.results.animation.scene import AnimatedScene

Array = NDArray[np.float64]
Plain = Mapping[str, Any]

ARM, ROD, PIN, GUIDE, JOINT = "#4d5b68", "#7a8794", "#98a4af", "#a3aeb8", "#343f49"
STEEL = "#aab4bd"
COIL, TYRE, RIM, HULL, FORCE, CONE, RAIL, SLEEPER = (
    "#e2a11a", "#262b30", "#c9d1d8", "#2f74ad", "#d8322a", "#f06a12", "#8c7a6b", "#77706a",
)  # fmt: skip
BODIES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
STYLES = {"rod": ROD, "pin": PIN, "guide": GUIDE, "joint": JOINT, "steel": STEEL, "rubber": TYRE}
_LONGEST_TRACK, _MOST_SLEEPERS = 3e5, 3000
"""Length [m] of the longest track drawn, and sleepers that are drawn of it in one picture."""
ARROW_REACH, ARROW_LIMIT = 0.28, 0.7
"""Length of the arrow of a usual force and of the longest arrow, in sizes of the vehicle."""


@dataclass(frozen=True)
class Face:
    """A flat polygon with its corners (n, 3) [m], or a line of two points with a ``width`` [m].

    Those of a higher ``layer`` are drawn over all of the lower ones: the ground has -1, what is
    seen through all else 1.
    """

    corners: Array
    colour: str
    opacity: float = 1.0
    width: float = 0.0
    layer: int = 0


def faces_of(scene: AnimatedScene, time: float, extent: float) -> list[Face]:
    """Return the faces of everything that moves and stands in a scene, nothing of the ground."""
    moment = SceneState(scene, time)
    has_hull = any(shape["kind"] == "hull" for shape in scene.shapes)
    faces: list[Face] = []
    for shape in scene.shapes:
        make = _MAKERS.get(shape["kind"])
        if make is not None:
            faces += make(moment, shape, has_hull)
    faces += _arrows(scene, moment, extent)
    faces += _cones(scene)
    faces += _track(scene, np.nan_to_num(moment.position[0]), 12.0 * extent)
    return [face for face in faces if np.isfinite(face.corners).all()]


def _colour(moment: SceneState, body: str, has_hull: bool) -> str:
    return ARM if has_hull else BODIES[moment.index(body) % len(BODIES)]


def _tube(moment: SceneState, shape: Plain, has_hull: bool) -> list[Face]:
    a, b = (moment.places(shape[k]["body"], shape[k]["point"])[0] for k in ("a", "b"))
    own = STYLES.get(shape["style"], _colour(moment, shape["a"]["body"], has_hull))
    level = moment.level(shape["coloured_by"])
    if level is not None:
        own = level_colour(*level)
    is_flat = 4.0 * shape["radius"] > np.linalg.norm(b - a)
    return prism(a, b, shape["radius"], own, sides=32 if is_flat else 8)


def _coil(moment: SceneState, shape: Plain, _: bool) -> list[Face]:
    a, b = (moment.places(shape[k]["body"], shape[k]["point"])[0] for k in ("a", "b"))
    if shape["direction"]:
        ends = moment.places(shape["a"]["body"], [[0.0, 0.0, 0.0], shape["direction"]])
        direction = ends[1] - ends[0]
        a = b + direction * float(direction @ (a - b))
    along, left, up = _frame(b - a)
    part = np.linspace(0.0, 1.0, 85)
    angle = 14.0 * math.pi * part
    reach = shape["radius"] * np.minimum(1.0, 8.0 * np.minimum(part, 1.0 - part))
    line = (
        a
        + np.outer(part, along) * np.linalg.norm(b - a)
        + np.outer(reach * np.cos(angle), left)
        + np.outer(reach * np.sin(angle), up)
    )
    return [Face(line[k : k + 2], COIL, width=0.32 * shape["radius"]) for k in range(len(line) - 1)]


def _ball(moment: SceneState, shape: Plain, has_hull: bool) -> list[Face]:
    at = shape["at"]
    centre = moment.places(at["body"], at["point"])[0]
    own = STYLES.get(shape["style"], JOINT)
    if shape["style"] == "body":
        own = _colour(moment, at["body"], has_hull)
    rings = [(math.sin(t), math.cos(t)) for t in np.linspace(0.0, math.pi, 7)]
    profile = np.array([[max(s, 1e-6), c] for s, c in rings]) * shape["radius"]
    return _revolved(lambda p: centre + p, profile, np.eye(3), own, sides=12)


def _box(moment: SceneState, shape: Plain, has_hull: bool) -> list[Face]:
    at = shape["at"]
    corners = 0.5 * np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    local = corners * np.array(shape["size"])
    if shape["rotation"]:
        local = local @ np.array(shape["rotation"]).T
    points = moment.places(at["body"], local + np.array(at["point"]))
    opacity = 0.25 if shape["style"] == "glass" else 1.0
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    own = STEEL if shape["style"] == "steel" else _colour(moment, at["body"], has_hull)
    return [Face(points[list(s)], own, opacity) for s in sides]


def _extrusion(moment: SceneState, shape: Plain, has_hull: bool) -> list[Face]:
    at, half = shape["at"], 0.5 * shape["width"]
    corners = np.array(shape["profile"], dtype=float)
    sides = [
        moment.places(
            at["body"],
            np.insert(corners, 1, y, axis=1) + np.array(at["point"], dtype=float),
        )
        for y in (-half, half)
    ]
    own = STEEL if shape["style"] == "steel" else _colour(moment, at["body"], has_hull)
    opacity = 0.25 if shape["style"] == "glass" else 1.0
    near, far = sides
    count = len(corners)
    polygons = [near, far]
    for k in range(count):
        n = (k + 1) % count
        polygons.append(np.array([near[k], far[k], far[n], near[n]]))
    return [Face(polygon, own, opacity) for polygon in polygons]


def _wheel(moment: SceneState, shape: Plain, _: bool) -> list[Face]:
    r, h = shape["radius"], 0.5 * shape["width"]
    along, left, up = _frame(np.array(shape["axis"], dtype=float))
    axes = np.array([left, along, up])
    point = np.array(shape["at"]["point"], dtype=float)

    def place(p: Array) -> Array:
        return moment.places(shape["at"]["body"], point + p, spins=True)

    if shape["style"] == "rail":
        tread = [
            [0.6 * r, -h],
            [r + 0.03, -h],
            [r + 0.03, -0.7 * h],
            [r, -0.3 * h],
            [r, h],
            [0.6 * r, h],
        ]
        disc = [[0.001, 0.1 * h], [0.62 * r, 0.1 * h]]
        return [
            *_revolved(place, np.array(tread), axes, ROD, sides=32),
            *_revolved(place, np.array(disc), axes, PIN, sides=8),
        ]
    rubber = TYRE if shape["style"] == "tyre" else ARM
    inner = 0.62 if shape["style"] == "tyre" else 0.9
    tyre = [
        [inner * r, -0.9 * h],
        [0.9 * r, -h],
        [r, -0.6 * h],
        [r, 0.6 * h],
        [0.9 * r, h],
        [inner * r, 0.9 * h],
    ]
    faces = _revolved(place, np.array(tyre), axes, rubber, sides=28)
    if shape["style"] == "tyre":
        for side in (-1.0, 1.0):
            rim = [[0.001, 0.3 * side * h], [0.3 * r, 0.3 * side * h], [0.63 * r, 0.8 * side * h]]
            faces += _revolved(place, np.array(rim), axes, RIM, sides=20)
    for angle in np.arange(5) * 0.4 * math.pi:
        way = math.cos(angle) * left + math.sin(angle) * up
        spoke = place(np.array([0.1, inner])[:, None] * r * way)
        faces.append(Face(spoke, JOINT, width=0.06 * r))
    return faces


def _hull(moment: SceneState, shape: Plain, _: bool) -> list[Face]:
    outline = np.array(shape["outline"], dtype=float)
    front, rear = outline[:, 0].max(), outline[:, 0].min()
    left, right = outline[:, 1].max(), outline[:, 1].min()
    low, top, length = shape["bottom"], shape["top"], front - rear
    cabin = roof(shape)
    side = [
        (rear, low),
        (front, low),
        (front, top - 0.16 * (top - low)),
        (front - 0.3 * length, top),
    ]
    side += [(front - 0.4 * length, cabin), (rear + 0.05 * length, cabin), (rear, top)]
    walls = [[(x, y, z) for x, z in side] for y in (left, right)]
    polygons = [np.array(wall) for wall in walls]
    for k in range(len(side)):
        n = (k + 1) % len(side)
        polygons.append(np.array([walls[0][k], walls[1][k], walls[1][n], walls[0][n]]))
    return [Face(moment.places(shape["body"], p), HULL, 0.16) for p in polygons]


def _track(scene: AnimatedScene, place: Array, reach: float) -> list[Face]:
    """Return rails and sleepers near a place."""
    if scene.track is None:
        return []
    way = np.linalg.norm(np.diff(scene.track[:, 0], axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(way)])
    if not along[-1] < _LONGEST_TRACK:
        return []
    stations = np.arange(0.0, along[-1], 0.6)
    edges = np.stack(
        [
            np.column_stack([np.interp(stations, along, scene.track[:, k, i]) for i in range(3)])
            for k in (0, 1)
        ],
        axis=1,
    )
    edges = edges[np.linalg.norm(edges[:, 0] - place, axis=1) < reach][:_MOST_SLEEPERS]
    faces = []
    for (left, right), (left_next, right_next) in pairwise(edges):
        over, along = 0.35 * (left - right), 0.2 * (left_next - left)
        corners = [left + over - along, right - over - along, right - over + along]
        sleeper = np.array([*corners, left + over + along]) - [0.0, 0.0, 0.17]
        faces.append(Face(sleeper, SLEEPER, layer=-1))
        for a, b, out in ((left, left_next, 1.0), (right, right_next, -1.0)):
            across = out * 0.05 * (left - right)
            rail = np.array([a, b, b + across, a + across])
            faces.append(Face(rail, RAIL, layer=-1))
            faces.append(Face(np.array([a, b, b - [0, 0, 0.17], a - [0, 0, 0.17]]), RAIL, layer=-1))
    return faces


def _arrows(scene: AnimatedScene, moment: SceneState, extent: float) -> list[Face]:
    faces = []
    for arrow in scene.arrows if scene.usual_force > 0.0 else ():
        foot, force = moment.mixed(arrow.foot), moment.mixed(arrow.force)
        along = force * (ARROW_REACH * min(extent, 6.0) / scene.usual_force)
        length = float(np.linalg.norm(along))
        along = along * min(1.0, ARROW_LIMIT * min(extent, 6.0) / max(length, 1e-12))
        length = float(np.linalg.norm(along))
        thick = 0.0045 * min(extent, 6.0)
        if not length > 4.0 * thick:
            continue
        neck = foot + along * (1.0 - min(6.0 * thick / length, 0.5))
        shaft = prism(foot, neck, thick, FORCE, sides=8)
        head = prism(neck, foot + along, 2.4 * thick, FORCE, sides=10, end=0.02)
        faces += [replace(face, layer=1) for face in (*shaft, *head)]
    return faces


def _cones(scene: AnimatedScene) -> list[Face]:
    r = scene.cone_radius or 0.15
    faces = []
    for x, y in scene.cones:
        foot = np.array([x, y, 0.0])
        rise = np.array([0.0, 0.0, 3.6 * r])
        faces += prism(foot, foot + 0.45 * rise, 0.82 * r, CONE, sides=12, end=0.62)
        faces += prism(
            foot + 0.45 * rise, foot + 0.7 * rise, 0.51 * r, "#fafafa", sides=12, end=0.7
        )
        faces += prism(foot + 0.7 * rise, foot + rise, 0.36 * r, CONE, sides=12, end=0.35)
    return faces


def prism(
    a: Array, b: Array, radius: float, colour: str, *, sides: int, end: float = 1.0
) -> list[Face]:
    """Return a round bar from a to b whose radius at b is ``end`` times that at a."""
    if not np.linalg.norm(b - a) > 0.0:
        return []
    _, left, up = _frame(b - a)
    angle = np.arange(sides + 1) * (2.0 * math.pi / sides)
    ring = radius * (np.outer(np.cos(angle), left) + np.outer(np.sin(angle), up))
    first, last = a + ring, b + end * ring
    faces = [
        Face(np.array([first[k], first[k + 1], last[k + 1], last[k]]), colour) for k in range(sides)
    ]
    return [*faces, Face(first[:-1], colour), Face(last[:-1], colour)]


def _revolved(
    place: Callable[[Array], Array], profile: Array, axes: Array, colour: str, *, sides: int
) -> list[Face]:
    """Return the faces of a profile (radius, along) turned about the second of the axes (rows)."""
    angle = np.arange(sides + 1) * (2.0 * math.pi / sides)
    rings = [
        place(
            r * (np.outer(np.cos(angle), axes[0]) + np.outer(np.sin(angle), axes[2])) + z * axes[1]
        )
        for r, z in profile
    ]
    return [
        Face(np.array([low[k], low[k + 1], high[k + 1], high[k]]), colour)
        for low, high in pairwise(rings)
        for k in range(sides)
    ]


def _frame(along: Array) -> tuple[Array, Array, Array]:
    """Return a unit vector along and two across it."""
    length = float(np.linalg.norm(along))
    first = along / length if length > 0.0 else np.array([0.0, 0.0, 1.0])
    helper = np.eye(3)[int(np.argmin(np.abs(first)))]
    second = np.cross(helper, first)
    second /= np.linalg.norm(second)
    return first, second, np.cross(first, second)


_MAKERS: dict[str, Callable[[SceneState, Plain, bool], Sequence[Face]]] = {
    "tube": _tube,
    "coil": _coil,
    "ball": _ball,
    "box": _box,
    "extrusion": _extrusion,
    "wheel": _wheel,
    "hull": _hull,
}
