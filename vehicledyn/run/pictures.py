"""Poses for the animation while a run goes on, and the ground beneath its path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.appearance import appearance
from vehicledyn.multibody.skeleton import Skeleton, skeleton_from
from vehicledyn.results.animation import Pictures
from vehicledyn.results.animation_stage import Stage
from vehicledyn.road.wheel import RoadWheel
from vehicledyn.symbolic import ops

if TYPE_CHECKING:
    from vehicledyn.run.prepare import Prepared

Matrix = NDArray[np.float64]

PICTURE_INTERVAL = 0.02
"""Least time between two pictures [s]."""

_MARGIN, _ROWS, _COLUMNS, _FINEST = 4.0, 1500, 21, 0.1


def look_of(prepared: Prepared) -> dict[str, Any]:
    """Return what pictures of a prepared run show, as plain data."""
    subject = prepared.subject
    return appearance(subject.system, prepared.kernel.parameters.tolist(), subject.shapes())


@dataclass
class Recorder:
    """Picks samples for pictures and finds the poses of all bodies there.

    ``stride`` samples make one picture; ``columns`` are the coordinates' channels.
    """

    stage: Stage
    stride: int
    interval: float
    _skeleton: Skeleton
    _columns: Mapping[str, int]
    _seen: int = 0
    _path: list[Matrix] = field(default_factory=list)

    @classmethod
    def of(
        cls, look: Mapping[str, Any], channels: Sequence[str], interval: float
    ) -> Recorder | None:
        """Return a recorder for the samples of a run; None for a system without bodies."""
        skeleton = skeleton_from(look)
        if not skeleton.bodies:
            return None
        place = {name: index for index, name in enumerate(channels)}
        return cls(
            Stage(skeleton.bodies, look["shapes"]),
            max(1, int(PICTURE_INTERVAL / interval * (1.0 + 1e-9))),
            interval,
            skeleton,
            {name: place[name] for name in skeleton.coordinates},
        )

    def expected(self, duration: float) -> int:
        """Return how many pictures a run of a duration [s] will have."""
        return round(duration / self.interval / self.stride) + 1

    def take(self, times: Matrix, outputs: Matrix) -> Pictures:
        """Return the pictures among the next samples, outputs of shape (n, n_channels)."""
        rows = np.arange(-self._seen % self.stride, len(times), self.stride)
        self._seen += len(times)
        values = {name: outputs[rows, column] for name, column in self._columns.items()}
        poses = self._skeleton.poses(values)
        count = len(rows) if values else 0
        self._path.append(poses.position[:count, 0])
        return Pictures(
            times[rows][:count],
            poses.position[:count],
            poses.quaternion[:count],
            poses.turn[:count],
        )

    @property
    def path(self) -> Matrix:
        """Positions of the first body at the pictures so far, shape (n, 3) [m]."""
        return np.concatenate(self._path) if self._path else np.empty((0, 3))


def ground_of(prepared: Prepared, path: Matrix) -> Matrix | None:
    """Return the surface of uneven ground along a path, shape (rows, columns, 3) [m].

    None where the ground is flat, or there are no road wheels.
    """
    wheels = [part for part in prepared.subject.system.parts if isinstance(part, RoadWheel)]
    path = path[np.all(np.isfinite(path), axis=1)]
    if not wheels or wheels[0].surface.is_flat or not len(path):
        return None
    centre, left = _stations(path[:, :2])
    offsets = np.linspace(-_MARGIN, _MARGIN, _COLUMNS)
    places = centre[:, None, :] + left[:, None, :] * offsets[None, :, None]
    x, y = ops.symbol("x"), ops.symbol("y")
    table = prepared.subject.system.table
    parameters = ops.column([entry.symbol for entry in table.entries])
    height = ops.numeric(
        [ops.column([x, y]), parameters], ops.column([wheels[0].surface.height(x, y)])
    )
    heights = height(places.reshape(-1, 2).T, prepared.kernel.parameters)
    return np.concatenate([places, heights.reshape(*places.shape[:2], 1)], axis=2)


def _stations(path: Matrix) -> tuple[Matrix, Matrix]:
    """Return evenly spaced points along a path and beyond, and unit vectors to its left."""
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    keep = np.concatenate([[True], steps > 1e-6])
    path = path[keep]
    if len(path) < 2:
        path = np.array([path[0] - [_MARGIN, 0.0], path[0] + [_MARGIN, 0.0]])
    first, last = path[1] - path[0], path[-1] - path[-2]
    before = path[0] - 2.0 * _MARGIN * first / np.linalg.norm(first)
    behind = path[-1] + 2.0 * _MARGIN * last / np.linalg.norm(last)
    path = np.concatenate([[before], path, [behind]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    count = int(np.clip(along[-1] / _FINEST, 2, _ROWS))
    stations = np.linspace(0.0, along[-1], count)
    centre = np.column_stack([np.interp(stations, along, path[:, k]) for k in (0, 1)])
    ahead = np.gradient(centre, stations, axis=0)
    ahead /= np.maximum(np.linalg.norm(ahead, axis=1, keepdims=True), 1e-12)
    return centre, np.column_stack([-ahead[:, 1], ahead[:, 0]])
