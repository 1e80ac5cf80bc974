"""A pinhole camera that looks at an animated scene."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.results.animation.frame_state import Bounds, SceneState
from vehicledyn.results.animation.scene import AnimatedScene
from vehicledyn.results.animation.solids import Face

Array = NDArray[np.float64]

VIEWS = {
    "angle": (-1.25, -1.36, 0.78),
    "side": (0.0, -1.9, 0.25),
    "front": (1.9, 0.0, 0.35),
    "top": (-0.001, 0.0, 2.1),
}
"""Where the camera looks from: along and left of the heading of the first body, and up."""

FIELD = math.radians(38.0)
"""Angle of the picture's height [rad]."""

_NEAR = 0.02
_LIGHT = np.array([-0.3, -0.5, 0.81])


class Camera:
    """A pinhole camera: eye, target [m] and its axes right, up and back."""

    def __init__(self, eye: Array, target: Array, near: float) -> None:
        back = (eye - target) / np.linalg.norm(eye - target)
        right = np.cross([0.0, 0.0, 1.0], back)
        right /= np.linalg.norm(right)
        self.eye, self.target, self._near = eye, target, near
        self._axes = np.array([right, np.cross(back, right), back])

    @classmethod
    def behind(
        cls, scene: AnimatedScene, time: float, view: str, bounds: Bounds, aspect: float
    ) -> Camera:
        """Return the camera of a view onto the vehicle, as near as the box around it allows."""
        if view not in VIEWS:
            raise InputError(f"view '{view}' is unknown; take one of {', '.join(VIEWS)}")
        target = np.nan_to_num(SceneState(scene, time).position[0]) + bounds.middle
        x, y, z = np.array(VIEWS[view]) / np.linalg.norm(VIEWS[view])
        heading = _heading(scene)
        c, s = math.cos(heading), math.sin(heading)
        back = np.array([c * x - s * y, s * x + c * y, z])
        probe = cls(back, np.zeros(3), 1.0)
        signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
        right, up, near = ((signs * bounds.half) @ axis for axis in probe._axes)
        tall = math.tan(0.5 * FIELD)
        wanted = near + np.maximum(1.15 * np.abs(right) / (tall * aspect), 1.35 * np.abs(up) / tall)
        distance = max(0.6 * bounds.size, float(wanted.max()))
        return cls(target + distance * back, target, _NEAR * bounds.size)

    def flat(self, points: Array) -> tuple[Array, Array]:
        """Return places in the picture, shape (n, 2), and depths (n,) [m]."""
        local = (points - self.eye) @ self._axes.T
        depth = -local[:, 2]
        return local[:, :2] / np.maximum(depth, self._near)[:, None], depth

    def line(self, points: Array) -> Array:
        """Return a line of two points in the picture, cut off in front of the eye."""
        local = (points - self.eye) @ self._axes.T
        depth = -local[:, 2]
        if depth.max() <= self._near:
            return np.empty((0, 2))
        if depth.min() < self._near:
            near, far = int(np.argmin(depth)), int(np.argmax(depth))
            part = (self._near - depth[near]) / (depth[far] - depth[near])
            local[near] += part * (local[far] - local[near])
        flat: Array = local[:, :2] / -local[:, 2:3]
        return flat

    def face(self, face: Face) -> tuple[Array, float]:
        """Return a face in the picture and its depth; nothing if it is behind the eye."""
        flat, depth = self.flat(face.corners)
        if depth.min() <= self._near:
            return np.empty((0, 2)), 0.0
        if face.width:
            along = flat[1] - flat[0]
            across = np.array([-along[1], along[0]]) / max(float(np.linalg.norm(along)), 1e-12)
            across = across * 0.5 * face.width / depth.mean()
            flat = np.array(
                [flat[0] - across, flat[1] - across, flat[1] + across, flat[0] + across]
            )
        return flat, float(depth.mean())

    def shade(self, face: Face) -> tuple[float, float, float]:
        """Return the colour of a face in the light."""
        from matplotlib.colors import to_rgb

        bright = 0.85
        if not face.width:
            a, b = face.corners[1] - face.corners[0], face.corners[2] - face.corners[1]
            normal = np.cross(a, b)
            length = float(np.linalg.norm(normal))
            if length > 0.0:
                normal = normal / length
                towards = self.eye - face.corners[0]
                normal = normal if normal @ towards > 0.0 else -normal
                bright = 0.68 + 0.4 * max(0.0, float(normal @ _LIGHT))
        red, green, blue = (min(1.0, bright * part) for part in to_rgb(face.colour))
        return red, green, blue


def _heading(scene: AnimatedScene) -> float:
    """Return the angle of the first body's x axis about the vertical at the start [rad]."""
    start = SceneState(scene, float(scene.time[0]))
    feet = start.places(scene.bodies[0]["name"], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    x, y = (feet[1] - feet[0])[:2]
    return math.atan2(y, x) if math.isfinite(x + y) else 0.0
