"""Poses for the animation while a run goes on, and the ground beneath its path."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.equations.system_shapes import appearance
from vehicledyn.multibody.recursion.numeric_kinematics import Skeleton, skeleton_from
from vehicledyn.rail.track.track import Track
from vehicledyn.results.store.animation_section import Pictures, Surroundings
from vehicledyn.results.store.animation_stage import Stage
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic import ops

if TYPE_CHECKING:
    from vehicledyn.analyses.preparation.prepared import Prepared

Matrix = NDArray[np.float64]

PICTURE_INTERVAL = 0.02
"""Least time between two pictures [s]."""

_WIDEST = 10**12
"""Most samples between two pictures, more than a run has; intervals may be as short as floats."""

_ARC = "track_position"
_STATION, _STATIONS, _BEYOND = 0.5, 6000, 30.0
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
    _arcs: Sequence[int]
    _path: list[Matrix] = field(default_factory=list)
    _seen: int = 0
    _reach: tuple[float, float] = (np.inf, -np.inf)

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
            int(np.clip(PICTURE_INTERVAL / interval * (1.0 + 1e-9), 1, _WIDEST)),
            interval,
            skeleton,
            {name: place[name] for name in skeleton.coordinates},
            [index for name, index in place.items() if name.rpartition(".")[2] == _ARC],
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
        arcs = outputs[rows][:, list(self._arcs)]
        arcs = arcs[np.isfinite(arcs)]
        if len(arcs):
            low, high = self._reach
            self._reach = min(low, float(arcs.min())), max(high, float(arcs.max()))
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

    @property
    def reach(self) -> tuple[float, float] | None:
        """Smallest and largest place along the track [m]; along x where no channel gives it."""
        if np.isfinite(self._reach).all():
            return self._reach
        x = self.path[:, 0]
        known = x[np.isfinite(x)]
        return (float(known.min()), float(known.max())) if len(known) else None


def surroundings_of(prepared: Prepared, recorder: Recorder | None) -> Surroundings | None:
    """Return what lies beneath the way of a run that has ended, None without pictures."""
    if recorder is None:
        return None
    return Surroundings(ground_of(prepared, recorder.path), track_of(prepared, recorder.reach))


def track_of(prepared: Prepared, reach: tuple[float, float] | None) -> Matrix | None:
    """Return the running edges of the rails along a way, shape (stations, 2, 3) [m].

    None where no part runs on rails.
    """
    found = [track for part in prepared.subject.system.parts if (track := _track(part))]
    if not found or reach is None:
        return None
    track, s = found[0], ops.symbol("s")
    begin, end = reach[0] - _BEYOND, reach[1] + _BEYOND
    is_plain = track.is_straight and track.is_perfect
    count = 2 if is_plain else int(np.clip((end - begin) / _STATION, 2, _STATIONS))
    frame = track.frame(s)
    edges = []
    for side, sign in (("left", 0.5), ("right", -0.5)):
        across, up = track.rail_shift(side, s)  # type: ignore[arg-type]
        place = ops.vector(0.0, sign * track.gauge + across, up)
        edges.append(frame.position + frame.rotation @ place)
    table = prepared.subject.system.table
    parameters = ops.column([entry.symbol for entry in table.entries])
    evaluate = ops.numeric([s, parameters], ops.stacked(*edges))
    stations = np.linspace(begin, end, count)
    values = evaluate(stations[None, :], prepared.kernel.parameters)
    return values.T.reshape(count, 2, 3)


def _track(part: Any) -> Track | None:
    """Return the track that a part runs on, if it does."""
    for owner in (part, getattr(part, "wheels", None)):
        track = getattr(owner, "track", None)
        if isinstance(track, Track):
            return track
    return None


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
