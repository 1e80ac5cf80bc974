"""Deformable bodies in numbers: how their coordinates move their points and their mass."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.model.deformation import Flexibility
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

Array = NDArray[np.float64]
_ROUNDING = 1e-13


@dataclass(frozen=True)
class Slices:
    """Slices of a body: masses (p,), places (p, 3) and their derivatives ``moved`` (p, 3, n).

    ``inertias`` (p, 3) are about their own axes, ``turns`` (p, 3, 3) lead from these to the body,
    ``turned`` (p, 3, n) are their angular velocities by the coordinates.
    """

    masses: Array
    places: Array
    moved: Array
    inertias: Array
    turns: Array
    turned: Array


@dataclass(frozen=True)
class DeformedNumbers:
    """Numbers of the links of deformable bodies at a configuration.

    ``stations`` gives the link of each point the columns (angular, linear) of the coordinates in
    its axes, shape (6, n); ``masses`` gives the link of each body its slices and the matrix of its
    turning inertia, shape (n + 3, n + 3).
    """

    stations: dict[int, Array]
    masses: dict[int, tuple[Slices, Array]]


class DeformableRows:
    """Evaluates the deformable bodies of a tree."""

    def __init__(self, kinematics: Kinematics, inputs: list[Any]) -> None:
        """Take the kinematics; ``inputs`` are the columns that its expressions depend on."""
        links = kinematics.tree.links
        self._stations = [k for k, item in enumerate(links) if item.station is not None]
        bodies = [(k, item.flexibility) for k, item in enumerate(links)]
        self._bodies: list[tuple[int, Flexibility]] = [(k, b) for k, b in bodies if b is not None]
        self._names = {k: kinematics.deforming(k) for k in self._stations}
        self._names |= {k: body.coordinates for k, body in self._bodies}
        expressions = [e for k in self._stations for e in self._at_station(kinematics, k)]
        self._points = [len(kinematics.slices(k)) for k, _ in self._bodies]
        for k, body in self._bodies:
            expressions += self._of_body(kinematics, k, body)
        self._evaluate = ops.numeric(inputs, ops.column(expressions))

    def names(self, link: int) -> tuple[str, ...]:
        """Return the coordinates of a station's or body's columns."""
        return self._names[link]

    def at(self, *values: Any) -> DeformedNumbers:
        """Return the numbers at values of the inputs."""
        if not self._names:
            return DeformedNumbers({}, {})
        numbers = self._evaluate(*values)[:, 0]
        stations, masses, start = {}, {}, 0
        for link in self._stations:
            n = len(self._names[link])
            stations[link] = numbers[start : start + 6 * n].reshape(n, 6).T
            start += 6 * n
        for (link, body), count in zip(self._bodies, self._points, strict=True):
            n = len(body.coordinates)
            width = 16 + 6 * n
            rows = numbers[start : start + count * width].reshape(count, width)
            start += count * width
            turning = numbers[start : start + (n + 3) ** 2].reshape(n + 3, n + 3)
            start += (n + 3) ** 2
            moved = rows[:, 16 : 16 + 3 * n].reshape(count, n, 3).transpose(0, 2, 1)
            turned = rows[:, 16 + 3 * n :].reshape(count, n, 3).transpose(0, 2, 1)
            own = Slices(
                rows[:, 0],
                rows[:, 1:4],
                moved,
                rows[:, 4:7],
                rows[:, 7:16].reshape(-1, 3, 3),
                turned,
            )
            masses[link] = own, turning
        return DeformedNumbers(stations, masses)

    def _at_station(self, kinematics: Kinematics, link: int) -> list[Scalar]:
        motions = dict(kinematics.link_motions(link))
        found: list[Scalar] = []
        for name in self._names[link]:
            axes = motions.get(name)
            vectors = (None, None) if axes is None else (axes.angular, axes.linear)
            for vector in vectors:
                found += [0.0 if vector is None else vector[i] for i in range(3)]
        return found

    @staticmethod
    def _of_body(kinematics: Kinematics, link: int, body: Flexibility) -> list[Scalar]:
        count = range(len(body.coordinates))
        found: list[Scalar] = []
        for item in kinematics.slices(link):
            found += [body.mass * item.share, *(item.position[i] for i in range(3))]
            turn = item.rotation
            found += [0.0 if turn is None else j for j in item.inertia]
            found += [0.0 if turn is None else turn[i, j] for i in range(3) for j in range(3)]
            for columns in (item.linear, item.angular):
                for k in count:
                    found += [columns[k][i] if k in columns else 0.0 for i in range(3)]
        size = range(3 + len(body.coordinates))
        found += [body.turning.entry(i, j) for i in size for j in size]
        return found


def roots(
    numbers: tuple[Slices, Array],
    frame: tuple[Array, Array],
    columns: tuple[Array, Array],
    own: list[int],
) -> Array:
    """Return the rows of A of a body, M = Aᵀ A, over all coordinates.

    Parameters
    ----------
    numbers
        Its mass, see :class:`DeformedNumbers`.
    frame
        Rotation and origin of its frame in the world.
    columns
        (ω, v of the point at the world's origin) of the frame by q̇, each (3, n_coordinates).
    own
        Columns of the coordinates of its deformation.
    """
    slices, inertia = numbers
    turning, sliding = columns
    rotation, origin = frame
    blocks = []
    for k, mass in enumerate(slices.masses):
        velocity = sliding + np.cross(turning.T, origin + rotation @ slices.places[k]).T
        velocity[:, own] += rotation @ slices.moved[k]
        blocks.append(np.sqrt(max(mass, 0.0)) * velocity)
        spin = slices.turns[k].T @ rotation.T @ turning
        spin[:, own] += slices.turned[k]
        blocks.append(np.sqrt(np.maximum(slices.inertias[k], 0.0))[:, None] * spin)
    sizes, axes = np.linalg.eigh(inertia)
    rates = np.zeros((len(inertia), turning.shape[1]))
    rates[:3] = rotation.T @ turning
    rates[range(3, len(inertia)), own] += 1.0
    moved = np.sqrt(np.abs(sizes))[:, None] * (axes.T @ rates)
    if sizes[0] >= -_ROUNDING * abs(sizes[-1]):
        return np.vstack([*blocks, moved[sizes > 0.0]])
    # A part of the inertia is negative, the whole is not: take its root.
    signs = np.concatenate([np.ones(sum(map(len, blocks))), np.sign(sizes)])
    whole = np.vstack([*blocks, moved])
    sizes, axes = np.linalg.eigh(whole.T @ (signs[:, None] * whole))
    return np.asarray(np.sqrt(np.maximum(sizes, 0.0))[:, None] * axes.T)
