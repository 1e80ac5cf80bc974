"""Where everything of a scene is at one time, and how large it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.numbers.quaternions import about, multiplied, rotated
from vehicledyn.results.animation.scene import AnimatedScene

Array = NDArray[np.float64]
Plain = Mapping[str, Any]


class SceneState:
    """The poses of a scene at one time, between two pictures if need be."""

    def __init__(self, scene: AnimatedScene, time: float) -> None:
        p = scene.pictures
        low = int(np.clip(np.searchsorted(p.time, time, side="right") - 1, 0, len(p.time) - 1))
        high = min(low + 1, len(p.time) - 1)
        step = p.time[high] - p.time[low]
        self.part = float(np.clip((time - p.time[low]) / step, 0.0, 1.0)) if step > 0.0 else 0.0
        self._rows = low, high
        self.position = self.mixed(p.position)
        turned = self.mixed(p.quaternion)
        self.quaternion = turned / np.maximum(np.linalg.norm(turned, axis=-1, keepdims=True), 1e-9)
        self.turn = self.mixed(p.turn)
        self._levels, self._highest = scene.levels, scene.highest_level
        self._bodies = {body["name"]: (k, body) for k, body in enumerate(scene.bodies)}

    def mixed(self, values: Array) -> Array:
        """Return values along the first axis at this time."""
        low, high = self._rows
        mixed: Array = (1.0 - self.part) * values[low] + self.part * values[high]
        return mixed

    def places(self, body: str, points: Any, *, spins: bool = False) -> Array:
        """Return points of a body in world axes, shape (n, 3); those of its wheel if it spins."""
        local: Array = np.atleast_2d(np.asarray(points, dtype=float))
        if body not in self._bodies:
            return local
        k, facts = self._bodies[body]
        turned = self.quaternion[k][None]
        if facts["axes_spin"] or spins:
            turned = whole_turn(facts, turned, self.turn[k : k + 1])
        placed: Array = self.position[k] + rotated(turned, local)
        return placed

    def level(self, name: str) -> tuple[float, float] | None:
        """Return the value of a channel that shapes are coloured by and the highest, or None."""
        if name not in self._levels:
            return None
        return float(self.mixed(self._levels[name].values)), self._highest

    def index(self, body: str) -> int:
        """Return the number of a body, zero for the ground."""
        return self._bodies[body][0] if body in self._bodies else 0


@dataclass(frozen=True)
class Bounds:
    """The box around all that moves: its ``middle`` from the first body and half its edges [m]."""

    middle: Array
    half: Array

    @property
    def size(self) -> float:
        """Its diagonal [m]."""
        return 2.0 * float(np.linalg.norm(self.half))


def bounds_of(scene: AnimatedScene) -> Bounds:
    """Return the box around the vehicle.

    At the start, or over many pictures where the first body stays in its place.
    """
    origin = scene.pictures.position[:, 0]
    known = origin[np.isfinite(origin).all(axis=1)]
    first = known[0] if len(known) else np.zeros(3)
    middle, half = _span(scene, scene.time[:1])
    if len(known) and np.linalg.norm(np.ptp(known, axis=0)) < 2.0 * np.linalg.norm(half):
        rows = np.linspace(0, len(scene.time) - 1, 24).round().astype(int)
        middle, half = _span(scene, scene.time[rows])
    return Bounds(middle - first, half)


def _span(scene: AnimatedScene, times: Array) -> tuple[Array, Array]:
    """Return the middle of all that moves at some times, and half the edges of its box [m]."""
    points = []
    for time in times:
        moment = SceneState(scene, float(time))
        points.append(moment.position)
        points += [_reach(moment, shape) for shape in scene.shapes]
    found = np.concatenate(points)
    found = found[np.isfinite(found).all(axis=1)]
    if not len(found) or not np.ptp(found, axis=0).max() > 1e-6:
        return (found[0] if len(found) else np.zeros(3)), np.full(3, 0.3)
    low, high = found.min(axis=0), found.max(axis=0)
    return 0.5 * (low + high), 0.5 * (high - low)


def _reach(moment: SceneState, shape: Plain) -> Array:
    """Return the outermost points of a shape on bodies that move, shape (n, 3) [m]."""
    if shape["kind"] == "hull":
        heights = shape["bottom"], roof(shape)
        corners = [[*corner[:2], z] for corner in shape["outline"] for z in heights]
        return moment.places(shape["body"], corners)
    points = [np.empty((0, 3))]
    for key in ("a", "b", "at"):
        anchor = shape.get(key)
        if isinstance(anchor, Mapping) and anchor["body"] != "ground":
            reach = np.zeros((1, 3))
            if shape["kind"] == "wheel":
                reach = np.array([[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]) * shape["radius"]
            elif shape["kind"] == "box":
                reach = np.array([[-0.5], [0.5]]) * np.array(shape["size"])
            elif shape["kind"] == "extrusion":
                reach = np.insert(np.array(shape["profile"], dtype=float), 1, 0.0, axis=1)
            points.append(moment.places(anchor["body"], np.array(anchor["point"]) + reach))
    return np.concatenate(points)


def whole_turn(body: Plain, quaternion: Array, turn: Array) -> Array:
    """Return the quaternions of a body's axes with its further turn, shape (n, 4)."""
    if not body["axis"]:
        return quaternion
    return multiplied(quaternion, about(np.eye(3)[body["axis"] - 1], turn))


def roof(hull: Plain) -> float:
    """Return the height of a hull's cabin, as tall as cars of that length have it [m]."""
    xs = [corner[0] for corner in hull["outline"]]
    return float(hull["top"] + 0.24 * min(max(xs) - min(xs), 4.5))
