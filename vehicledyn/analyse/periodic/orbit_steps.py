"""Find the orbits of a branch a step from one another.

Motions that compiled code follows are closed by simple shooting (:mod:`.returning`); others by
collocation, on a mesh that gets finer until the motion itself closes the orbit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeVar

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import (
    Corrected,
    Direction,
    Scales,
    correct,
    dot,
    tangent_of,
)
from vehicledyn.analyse.periodic.corners import behind_corner, corner_between
from vehicledyn.analyse.periodic.cycle_points import (
    CyclePoint,
    Limits,
    ahead,
    between,
    moved,
    point_of,
)
from vehicledyn.analyse.periodic.floquet import multipliers_of
from vehicledyn.analyse.periodic.mirror_symmetry import (
    BrokenMirrorError,
    Mirror,
    mirror_of,
    mirrored_mesh,
)
from vehicledyn.analyse.periodic.monodromy import Passages
from vehicledyn.analyse.periodic.multiple_shooting import Closed, closed, direction_of
from vehicledyn.analyse.periodic.nonsmooth_points import Kinks, aligned, misalignment
from vehicledyn.analyse.periodic.orbit import Orbit, adapted_mesh
from vehicledyn.analyse.periodic.single_shooting import returning
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector

T = TypeVar("T")

_REMESHED, _ALIGNED = 10, 1e-7
_REMESHED_AFTER = 10
"""Steps after which the mesh of orbits that integration finds follows them."""

_GONE_ON = 0.5
"""Least part of a step that an orbit must be ahead; errors are as large as the smallest steps."""

_NEAR_ONE = 0.2
"""Distance of a multiplier from 1 beside a branch point: farther off the step is too large."""

_CORNERED = 2e-4
"""Step below which a corner of the branch is looked for where no orbit is found ahead."""


@dataclass
class BranchSteps:
    """Steps along a branch of a model; ``intervals`` are those of the mesh of collocation.

    Orbits that integration finds are their own images in the ``mirror``, if there is one.
    """

    model: AutonomousField
    limits: Limits
    intervals: int
    age: int = 0
    mirror: Mirror | None = None

    @cached_property
    def kinks(self) -> Kinks:
        """What looks for kinks."""
        return Kinks(self.model)

    @property
    def parameter_scale(self) -> float:
        """Size with which changes of the parameter are measured."""
        return self.limits.scale

    def scales(self, orbit: Orbit) -> Scales:
        """Return the sizes with which changes of an orbit are measured."""
        return Scales(orbit.scales(), orbit.period, self.parameter_scale)

    def first(self, start: Orbit, direction: Direction) -> CyclePoint:
        """Return the orbit on the plane through a guess across a direction."""
        return self._recalled(self._first, start, direction)

    def first_at(self, start: Orbit, side: float) -> CyclePoint:
        """Return the orbit at the parameter of a guess; the branch goes on to a side of it.

        A simulated one, with contacts that begin and end, is closed by shooting; what is less
        near by collocation.
        """
        return self._recalled(self._first_at, start, side)

    def ahead_of(self, base: CyclePoint, size: float) -> CyclePoint:
        """Return the point at a distance along the branch."""
        return self._recalled(self._ahead_of, base, size)

    def behind_corner_of(self, base: CyclePoint, size: float) -> tuple[CyclePoint, float] | None:
        """Return a point behind a corner within a step and the way there; None without corner."""
        return self._recalled(self._behind_corner_of, base, size)

    def between(self, points: Mapping[float, CyclePoint], place: float) -> CyclePoint:
        """Return a point on a step that has been made, from those known at some places on it.

        Among these are the begin of the step, at zero, and its end. The point lies on the plane at
        its place across the chord of the whole step, and is looked for between its neighbours.
        """
        return self._recalled(self._between, points, place)

    def _recalled(self, step: Callable[..., T], *given: Any) -> T:
        """Return the result of a step, from the memory of the model if it has one.

        The mesh and the mirror that the step leaves behind are recalled with it.
        """

        def compute() -> tuple[Any, ...]:
            result, error = None, ""
            try:
                result = step(*given)
            except NumericalError as failed:
                error = str(failed)
            return result, error, self.age, self.intervals, self.mirror

        before = self.limits, self.age, self.intervals, self.mirror
        result, error, self.age, self.intervals, self.mirror = self.model.memory.recall(
            step.__name__, (before, given), compute
        )
        if error:
            raise NumericalError(error)
        return result  # type: ignore[no-any-return]

    def _first(self, start: Orbit, direction: Direction) -> CyclePoint:
        scales = self.scales(start)
        along = direction.times(1.0 / np.sqrt(dot(start, direction, direction, scales)))
        if self.model.is_carried:
            with suppress(NumericalError):
                return self._shot_first(start, along)
        found = correct(self.model, start, scales, along=along)
        exact = closed(self.model, found.orbit, parameter_scale=scales.parameter)
        return self._point(found, exact, scales, along)

    def _first_at(self, start: Orbit, side: float) -> CyclePoint:
        scales = self.scales(start)
        if self.model.is_carried:
            with suppress(NumericalError):
                return self._shot_first_at(start, side)
        found, exact, _ = self._corrected(start, scales, None)
        along = Direction(np.zeros_like(found.orbit.states), 0.0, side)
        return self._point(found, exact, scales, along)

    def _ahead_of(self, base: CyclePoint, size: float) -> CyclePoint:
        scales = self.scales(base.orbit)
        if self.model.is_carried:
            try:
                return self._shot_from(base, size, scales)
            except BrokenMirrorError:
                self.mirror = None
                return self._shot_from(self._whole(base, scales), size, scales)
        mesh = self._mesh(base.orbit, scales, self.kinks.along(base.orbit))
        tangent = moved(base.orbit, base.tangent, mesh)
        guess = ahead(base.orbit.moved(mesh), tangent, size)
        found, exact, along = self._corrected(guess, scales, tangent)
        return self._point(found, exact, self.scales(found.orbit), along or tangent)

    def _behind_corner_of(self, base: CyclePoint, size: float) -> tuple[CyclePoint, float] | None:
        if size > _CORNERED or not base.sense:
            return None
        scales = self.scales(base.orbit)
        try:
            point, way = behind_corner(self.model, base, size, scales, self.mirror)
        except NumericalError:
            return None
        corner = min(size, corner_between(base, point, scales))
        return replace(point, corner=corner), way

    def _between(self, points: Mapping[float, CyclePoint], place: float) -> CyclePoint:
        last = max(points)
        base, after = points[0.0], points[last]
        if base.passages is None and after.passages is None:
            return self._ahead_of(base, place)
        mesh, scale = base.orbit.mesh, self.parameter_scale
        chord = between(base.orbit, after.orbit.moved(mesh))
        low = max(own for own in points if own < place)
        high = min(own for own in points if own > place)
        ends = points[low].orbit.moved(mesh), points[high].orbit.moved(mesh)
        part = (place - low) / (high - low)
        guess = ahead(ends[0], between(*ends), part)
        near = points[high if part > 0.5 and high < last else low].passages
        try:
            exact = self._returning(guess, near, chord)
        except NumericalError:
            exact = self._returning(guess, None, chord)
        return point_of(exact, base.tangent, scale, base.sense)

    def _whole(self, base: CyclePoint, scales: Scales) -> CyclePoint:
        """Return a point whose orbit is followed as a whole, no more as its own image."""
        exact = self._returning(base.orbit, None, base.tangent)
        return point_of(exact, base.tangent, scales.parameter)

    def _returning(self, guess: Orbit, near: Passages | None, along: Direction) -> Closed:
        size = self.parameter_scale
        return returning(
            self.model, guess, near, parameter_scale=size, along=along, mirror=self.mirror
        )

    def _shot_first(self, start: Orbit, along: Direction) -> CyclePoint:
        """Return the orbit on the plane through a guess across a direction, by integration."""
        guess, across = self._mirrored(start), along
        if self.mirror is not None:
            across = moved(start, along, guess.mesh)
        try:
            exact = self._returning(guess, None, across)
        except BrokenMirrorError:
            self.mirror = None
            exact = self._returning(guess, None, across)
        return point_of(exact, across, self.parameter_scale)

    def _shot_first_at(self, start: Orbit, side: float) -> CyclePoint:
        """Return the orbit at the parameter of a guess, by integration."""
        exact = closed(self.model, start)
        guess = self._mirrored(exact.orbit)
        if self.mirror is not None:
            exact = returning(self.model, guess, None, mirror=self.mirror)
        along = Direction(np.zeros_like(exact.orbit.states), 0.0, side)
        return point_of(exact, along, self.parameter_scale)

    def _mirrored(self, orbit: Orbit) -> Orbit:
        """Look for a mirror, and return an orbit on a mesh that is its own image too."""
        limits = self.limits
        values = orbit.parameter, limits.low, limits.high
        self.mirror = mirror_of(self.model, orbit, values)
        return orbit if self.mirror is None else self._its_own_image(orbit, orbit.mesh)

    def _its_own_image(self, orbit: Orbit, mesh: Vector) -> Orbit:
        """Return an orbit on a mesh near another, the second half the image of the first."""
        assert self.mirror is not None
        found = orbit.moved(mirrored_mesh(mesh))
        half = found.states[: len(found.states) // 2]
        return replace(found, states=self.mirror.completed(half))

    def _shot_from(self, base: CyclePoint, size: float, scales: Scales) -> CyclePoint:
        """Return the point at a distance along the branch, found by integration alone.

        Where it is quick, as with compiled code, it needs no collocation, whose mesh would have to
        be fine where contacts begin and end.
        """
        mesh, near = base.orbit.mesh, base.passages
        self.age += 1
        if self.age > _REMESHED_AFTER or near is None:
            mesh, near = adapted_mesh(base.orbit, scales.states, base.orbit.intervals), None
            mesh = mesh if self.mirror is None else mirrored_mesh(mesh)
            self.age = 0
        tangent = moved(base.orbit, base.tangent, mesh)
        guess = ahead(base.orbit.moved(mesh), tangent, size)
        exact = self._returning(guess, near, tangent)
        way = between(base.orbit.moved(mesh), exact.orbit)
        if not dot(exact.orbit, way, tangent, scales) > _GONE_ON * size:
            raise NumericalError("no other orbit is found")
        point = point_of(exact, tangent, scales.parameter, base.sense)
        if point.sense * base.sense < 0.0 and not _passes_one(base, point):
            raise NumericalError("an orbit of another leg of the branch is found")
        return point

    def _corrected(
        self, guess: Orbit, scales: Scales, along: Direction | None
    ) -> tuple[Corrected, Closed, Direction | None]:
        """Return the orbit near a guess, closed by the motion itself, and the direction.

        The mesh of the collocation gets finer until the motion closes the orbit that it finds.
        """
        found = correct(self.model, guess, scales, along=along)
        iterations = found.iterations
        for _ in range(_REMESHED):
            orbit = found.orbit
            kinks = self.kinks.along(orbit)
            if misalignment(orbit.mesh, kinks) > _ALIGNED:
                mesh = aligned(orbit.mesh, kinks)
            else:
                try:
                    exact = closed(self.model, orbit, parameter_scale=_free(scales, along))
                    return replace(found, iterations=iterations), exact, along
                except NumericalError:
                    if self.intervals >= self.limits.intervals:
                        raise
                finer = self.intervals + max(4, self.intervals // 3)
                self.intervals = min(self.limits.intervals, finer)
                mesh = self._mesh(orbit, scales, kinks)
            along = None if along is None else moved(orbit, along, mesh)
            found = correct(self.model, orbit.moved(mesh), scales, along=along)
        exact = closed(self.model, found.orbit, parameter_scale=_free(scales, along))
        return replace(found, iterations=iterations), exact, along

    def _mesh(self, orbit: Orbit, scales: Scales, kinks: Vector) -> Vector:
        """Return a mesh that spreads the error of an orbit, with points on its kinks."""
        return aligned(adapted_mesh(orbit, scales.states, self.intervals, kinks), kinks)

    def _point(
        self, found: Corrected, exact: Closed, scales: Scales, before: Direction
    ) -> CyclePoint:
        tangent = tangent_of(found, found.system.scales, before)
        length = np.sqrt(dot(found.orbit, tangent, tangent, scales))
        _, sense = direction_of(exact, scales.parameter, tangent)
        return CyclePoint(
            exact.orbit,
            multipliers_of(exact.passages),
            tangent.times(1.0 / length),
            found.iterations,
            sense=sense,
        )


def _free(scales: Scales, along: Direction | None) -> float | None:
    """Return the size of changes of the parameter, None where it is held."""
    return None if along is None else scales.parameter


def _passes_one(before: CyclePoint, after: CyclePoint) -> bool:
    """Return whether a multiplier may pass 1 between two points, as at a branch point."""
    return bool(min(np.abs(p.multipliers.others - 1.0).min() for p in (before, after)) < _NEAR_ONE)
