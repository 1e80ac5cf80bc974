"""Tangents along a path that is known: how changes at the begin of a duration change its end.

A step of the path takes the Jacobians at its nodes, between which the elements go straight; where
that does not do, another in its middle; and where rates have a kink in the step, smaller ones. For
the flow and its tangent Φ

    Φ f(x(0)) = f(x(h)),

also across a kink of the rates f: by how much a step misses that is its error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.path_code import StepTrace
from vehicledyn.kernel.point_slopes import CarriedMotions, PointCode

_PARTS, _FINER, _FINEST, _ROUNDS = 4, 1 / 40, 1e-13, 9
"""Parts into which steps that miss the rates are divided, by how much their error gets smaller, the
least one, part of the scales, and how often this is done."""

_STRAIGHT = 0.1
"""Part of the tolerance up to which Jacobians go straight: what they miss then adds up."""

_MOST_KEPT = 64 * 1024**2
"""Elements of Jacobians that are kept at most, half a gigabyte."""

_AT_POINTS = "points", "rates", "entries"

Followed = Callable[[Vector, Vector, float], StepTrace | None]
"""The path from a state through durations [s] by steps of some error."""


class PathTangents:
    """Tangents along a path, found as exactly as is asked; what is found once is kept.

    Parameters
    ----------
    code
        The rates and their derivatives.
    path
        The motion.
    parameters
        All parameters.
    scales
        Sizes of the states, shape (n,).
    followed
        Follows the motion again where steps miss too much.

    Raises
    ------
    NumericalError
        If the path has more steps than derivatives can be kept of.
    """

    def __init__(
        self,
        code: PointCode,
        path: StepTrace,
        parameters: Vector,
        *,
        scales: Vector,
        followed: Followed,
    ) -> None:
        self._path, self._followed = path, followed
        self._steps = _Steps.of(_Code(code, parameters, scales), path)

    def carried(self, tolerance: float) -> CarriedMotions:
        """Return where the durations of the path lead, and the derivatives of their ends.

        Parameters
        ----------
        tolerance
            Part of the rates that those carried by the tangent of a step may miss at its end.
        """
        steps, path, error = self._steps, self._path, self._path.error
        which = np.arange(len(steps.sizes))
        for _ in range(_ROUNDS):
            steps.bend(which[steps.errors[which] > _STRAIGHT * tolerance])
            missing = which[steps.errors[which] > tolerance]
            error = max(_FINER * error, _FINEST)
            which = steps.replaced(missing, error, self._followed)
        steps.bend(which[steps.errors[which] > _STRAIGHT * tolerance])
        maps, errors = steps.carried()
        begins, ends = path.begins, np.cumsum(path.steps)
        return CarriedMotions(path.nodes[ends], maps, path.rates[begins], path.rates[ends], errors)


@dataclass(frozen=True)
class _Code:
    """The code with what it is given each time."""

    code: PointCode
    parameters: Vector
    scales: Vector

    @property
    def most_points(self) -> int:
        return _MOST_KEPT // self.code.n_entries

    def entries(self, points: Vector, room: int = 0) -> tuple[Vector, Vector]:
        return self.code.entries(points, self.parameters, room)

    def missed(self, steps: _Steps, which: NDArray[np.intp]) -> Vector:
        sizes, rows = steps.sizes[which], steps.rows[which]
        return self.code.missed(sizes, rows, steps.rates, steps.entries, self.scales)

    def tangents(self, steps: _Steps, order: NDArray[np.intp]) -> Vector:
        sizes, rows = steps.sizes[order], steps.rows[order]
        counts = np.bincount(steps.durations).astype(np.int64)
        return self.code.tangents(counts, sizes, rows, steps.entries)


@dataclass
class _Steps:
    """Steps and the points where their Jacobians are.

    ``times`` (n_steps,) at which they begin [s], their ``sizes`` [s], the ``durations`` that they
    lie in, their ``errors``; ``rows`` (n_steps, 3) give the points at the begin, in the middle and
    at the end, -1 for none. ``points``, ``rates`` (n_points, n) and ``entries`` (n_points,
    n_entries) of the Jacobian are those of the points, ``n_points`` of them; behind these is room.
    """

    code: _Code
    times: Vector
    sizes: Vector
    durations: NDArray[np.intp]
    rows: NDArray[np.int64]
    points: Vector
    rates: Vector
    entries: Vector
    errors: Vector
    n_points: int

    @staticmethod
    def of(code: _Code, path: StepTrace) -> _Steps:
        """Return the steps of a path, with the Jacobians at its nodes."""
        count = len(path.sizes)
        if count >= code.most_points:
            raise NumericalError(f"the motion takes {count} steps, too many for its tangents")
        number = np.arange(count)
        steps = _Steps(
            code,
            path.times,
            path.sizes,
            np.repeat(np.arange(len(path.steps)), path.steps),
            np.stack([number, np.full(count, -1), number + 1], axis=1),
            path.nodes,
            *code.entries(path.nodes, min(len(path.nodes), code.most_points - len(path.nodes))),
            np.empty(count),
            len(path.nodes),
        )
        steps.errors[:] = code.missed(steps, number)
        return steps

    def bend(self, which: NDArray[np.intp]) -> None:
        """Let the Jacobian of some steps follow a parabola."""
        which = which[self.rows[which, 1] < 0]
        if not which.size:
            return
        begin, end, size = self.rows[which, 0], self.rows[which, 2], self.sizes[which][:, None]
        middle = 0.5 * (self.points[begin] + self.points[end])
        middle += 0.125 * size * (self.rates[begin] - self.rates[end])
        self.rows[which, 1] = self._entered(middle)
        self.errors[which] = self.code.missed(self, which)

    def replaced(
        self, which: NDArray[np.intp], error: float, followed: Followed
    ) -> NDArray[np.intp]:
        """Put steps of a smaller error in the place of some, and return their numbers.

        None where there is no motion through them, or where all would be too many to be kept.
        """
        durations = np.repeat(self.sizes[which, None] / _PARTS, _PARTS, axis=1)
        paths = [
            (k, path)
            for k, own in zip(which, durations, strict=True)
            if (path := followed(self.points[self.rows[k, 0]], own, error)) is not None
        ]
        count = sum(len(path.sizes) for _, path in paths)
        if not paths or self.n_points + count > self.code.most_points:
            return np.zeros(0, dtype=np.intp)
        ends = self._entered(np.concatenate([path.nodes[1:] for _, path in paths]))
        parts = np.split(ends, np.cumsum([len(path.sizes) for _, path in paths])[:-1])
        begins = [
            np.append(self.rows[k, 0], own[:-1]) for (k, _), own in zip(paths, parts, strict=True)
        ]
        rows = np.stack([np.concatenate(begins), np.full(count, -1), ends], axis=1)
        replaced = np.array([k for k, _ in paths])
        kept = np.setdiff1d(np.arange(len(self.sizes)), replaced)
        new = np.arange(len(kept), len(kept) + count)
        lengths = [len(path.sizes) for _, path in paths]
        times = [self.times[k] + path.times for k, path in paths]
        self.durations = np.append(
            self.durations[kept], np.repeat(self.durations[replaced], lengths)
        )
        self.times = np.concatenate([self.times[kept], *times])
        self.sizes = np.concatenate([self.sizes[kept], *(path.sizes for _, path in paths)])
        self.rows = np.concatenate([self.rows[kept], rows])
        self.errors = np.append(self.errors[kept], np.empty(count))
        self.errors[new] = self.code.missed(self, new)
        return new

    def carried(self) -> tuple[Vector, Vector]:
        """Return the maps of the durations (n_durations, n, n + 1), and their largest errors."""
        order = np.argsort(self.times, kind="stable")
        errors = np.zeros(self.durations.max() + 1)
        np.maximum.at(errors, self.durations, self.errors)
        return self.code.tangents(self, order), errors

    def _entered(self, points: Vector) -> NDArray[np.int64]:
        """Enter points and return their numbers."""
        first, last = self.n_points, self.n_points + len(points)
        for name, own in zip(_AT_POINTS, (points, *self.code.entries(points)), strict=True):
            room = getattr(self, name)
            if last > len(room):
                most = max(last, min(2 * last, self.code.most_points))
                more = np.empty((most - first, *room.shape[1:]))
                room = np.concatenate([room[:first], more])
                setattr(self, name, room)
            room[first:last] = own
        self.n_points = last
        return np.arange(first, last)
