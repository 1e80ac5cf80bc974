"""The section /animation of a result: shapes, and poses of the bodies they are on.

::

    /animation/description   JSON: bodies and shapes
    /animation/picture_time  (n,) times of the pictures [s]
    /animation/body          names of the bodies
    /animation/origin        (n, 3) place that positions are counted from [m]
    /animation/position      (n, bodies, 3) origins of the bodies less that place, world axes [m]
    /animation/quaternion    (n, bodies, 4) w, x, y, z of the axes of the bodies
    /animation/turn          (n, bodies) further turn about the body's axis [rad]
    /animation/ground        (rows, columns, 3) points of uneven ground [m]
    /animation/track         (stations, 2, 3) running edges of the left and right rail [m]
"""

from __future__ import annotations

import json
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.animation_stage import Stage, read_stage
from vehicledyn.results.store.consistency import require_stored
from vehicledyn.results.store.layout import clean_text

Array = NDArray[np.float64]

PICTURE_TIME = "picture_time"
GROUP = "animation"
MOST_IN_CHUNK = 512
ROWS_AT_ONCE = 1 << 16
MOST_POINTS = 200_000
_COMPONENTS = {
    "origin": ("m", "Place that positions are counted from", "f8"),
    "position": ("m", "Origin of the body from that place, world axes", "f4"),
    "quaternion": ("1", "Axes of the body as a unit quaternion w, x, y, z", "f4"),
    "turn": ("rad", "Further turn about the axis of the body", "f8"),
}


@dataclass(frozen=True)
class Pictures:
    """Poses at n times, see :class:`Stage`.

    ``position`` (n, bodies, 3) [m], ``quaternion`` (n, bodies, 4), ``turn`` (n, bodies) [rad].
    """

    time: Array
    position: Array
    quaternion: Array
    turn: Array


@dataclass(frozen=True)
class Animation:
    """What a result holds for an animation.

    ``ground`` are points of uneven ground (rows, columns, 3), ``track`` the running edges of the
    left and right rail at stations along it (stations, 2, 3), world axes [m].
    """

    stage: Stage
    pictures: Pictures
    ground: Array | None = None
    track: Array | None = None


class PictureDatasets:
    """The growing datasets of the section while a result is written."""

    def __init__(self, file: h5py.File, stage: Stage, expected: int) -> None:
        group = file.create_group(GROUP, track_order=True)
        text = clean_text(stage.as_json())
        group.create_dataset("description", data=text, dtype=h5py.string_dtype())
        chunk, count = min(max(expected, 1), MOST_IN_CHUNK), len(stage.bodies)
        self._time = group.create_dataset(
            PICTURE_TIME, (0,), "f8", maxshape=(None,), chunks=(chunk,), fillvalue=np.nan
        )
        self._time.attrs.update({"units": "s", "long_name": "Time of the picture"})
        self._time.make_scale(PICTURE_TIME)
        names = [clean_text(str(body["name"])) for body in stage.bodies]
        body = group.create_dataset("body", data=names, dtype=h5py.string_dtype())
        body.make_scale("body")
        shapes = {
            "origin": (3,),
            "position": (count, 3),
            "quaternion": (count, 4),
            "turn": (count,),
        }
        axes = {3: _scale(group, "component", 3), 4: _scale(group, "quaternion_component", 4)}
        self._parts = {}
        for name, shape in shapes.items():
            unit, text, kind = _COMPONENTS[name]
            dataset = group.create_dataset(
                name, (0, *shape), kind, maxshape=(None, *shape), chunks=(chunk, *shape),
                fillvalue=np.nan,
            )  # fmt: skip
            dataset.attrs.update({"units": unit, "long_name": text})
            dataset.dims[0].attach_scale(self._time)
            if name != "origin":
                dataset.dims[1].attach_scale(body)
            if name != "turn":
                dataset.dims[len(shape)].attach_scale(axes[shape[-1]])
            self._parts[name] = dataset

    def extend(self, pictures: Pictures) -> None:
        """Append pictures; the times come last, so that they never promise missing poses."""
        origin = pictures.position[:, 0, :]
        values = {
            "origin": origin,
            "position": pictures.position - origin[:, None, :],
            "quaternion": pictures.quaternion,
            "turn": pictures.turn,
        }
        start, stop = len(self._time), len(self._time) + len(pictures.time)
        for name, dataset in self._parts.items():
            dataset.resize(stop, axis=0)
            dataset[start:stop] = values[name]
        self._time.resize(stop, axis=0)
        self._time[start:stop] = pictures.time


@dataclass(frozen=True)
class Surroundings:
    """What lies beneath the way of a run, known at its end; see :class:`Animation`."""

    ground: Array | None = None
    track: Array | None = None


def write_surroundings(group: h5py.Group, found: Surroundings) -> None:
    """Write what lies beneath the way."""
    for name, points, text in (
        ("ground", found.ground, "Surface of the ground, world axes"),
        ("track", found.track, "Running edges of the left and right rail, world axes"),
    ):
        if points is None:
            continue
        dataset = group.create_dataset(name, data=points)
        dataset.attrs.update({"units": "m", "long_name": text})
        for axis, what in enumerate((f"{name}_row", f"{name}_column")):
            dataset.dims[axis].attach_scale(_scale(group, what, points.shape[axis]))
        dataset.dims[2].attach_scale(group["component"])


@dataclass(frozen=True)
class Span:
    """Which pictures to read: at most so many between two times [s], evenly thinned.

    The first and the last between the times are included, and those beside the ``instant``.
    """

    most: int
    begin: float = -np.inf
    end: float = np.inf
    instant: float | None = None

    def rows(self, time: Array) -> NDArray[np.intp]:
        """Return the indices of the pictures, of those at some times that do not fall."""
        first = int(np.searchsorted(time, self.begin, side="left"))
        last = int(np.searchsorted(time, self.end, side="right"))
        rows = first + thinned(max(0, last - first), self.most)
        if self.instant is None or not len(rows):
            return rows
        near = int(np.searchsorted(time, self.instant)) + np.arange(-1, 2)
        return np.union1d(rows, near[(near >= first) & (near < last)])


def picture_times(group: h5py.Group) -> h5py.Dataset:
    """Return the times of the pictures; in older files they have the name of the samples' times."""
    return group[PICTURE_TIME if PICTURE_TIME in group else "time"]


def read_animation(group: h5py.Group, span: Span) -> Animation:
    """Return the section with some of its pictures."""
    require_stored(group)
    stage = read_stage(json.loads(group["description"].asstr()[()]))
    time = np.asarray(picture_times(group)[()], dtype=float)
    _check_sizes(group, len(time), len(stage.bodies))
    _check_times(time)
    rows = span.rows(time)
    origin = read_rows(group["origin"], rows)
    return Animation(
        stage,
        Pictures(
            time[rows],
            origin[:, None, :] + read_rows(group["position"], rows),
            read_rows(group["quaternion"], rows),
            read_rows(group["turn"], rows),
        ),
        _points(group, "ground", MOST_POINTS, (None, None, 3)),
        _points(group, "track", MOST_POINTS, (None, 2, 3)),
    )


def _points(
    group: h5py.Group, name: str, most: int, expected: tuple[int | None, ...]
) -> Array | None:
    if name not in group:
        return None
    shape = group[name].shape
    fits = len(shape) == 3 and all(e in (None, s) for e, s in zip(expected, shape, strict=True))
    if not fits or min(shape) < 2 or shape[0] * shape[1] > most:
        raise ValueError(f"animation/{name} of shape {shape}")
    return np.asarray(group[name][()], dtype=float)


def _check_sizes(group: h5py.Group, count: int, bodies: int) -> None:
    sizes = {"origin": (3,), "position": (bodies, 3), "quaternion": (bodies, 4), "turn": (bodies,)}
    for name, size in sizes.items():
        shape = group[name].shape
        if shape[0] < count or shape[1:] != size:
            raise ValueError(f"animation/{name} of shape {shape}, expected {(count, *size)}")


def _check_times(time: Array) -> None:
    """Raise if times are no numbers or fall, but for an end that was not written any more."""
    known = time[: int(np.isfinite(time).sum())]
    if not np.isfinite(known).all() or (np.diff(known) < 0.0).any():
        raise ValueError("the times of animation/ hold values that are no numbers or fall")


def thinned(count: int, most: int) -> NDArray[np.intp]:
    """Return at most so many of the first ``count`` indices, with the first and the last."""
    if count <= most:
        return np.arange(count)
    return np.unique(np.linspace(0, count - 1, most).round().astype(np.intp))


def read_rows(dataset: h5py.Dataset, rows: NDArray[np.intp]) -> Array:
    """Return some rising rows of a dataset, read block by block so that memory stays bounded."""
    block = ROWS_AT_ONCE
    parts = [
        np.asarray(dataset[start : start + block], dtype=float)[
            rows[(rows >= start) & (rows < start + block)] - start
        ]
        for start in range(0, int(rows[-1]) + 1 if len(rows) else 0, block)
    ]
    return np.concatenate(parts) if parts else np.empty((0, *dataset.shape[1:]))


def _scale(group: h5py.Group, name: str, length: int) -> h5py.Dataset:
    dataset = group.create_dataset(name, data=np.arange(length))
    dataset.make_scale(name)
    return dataset
