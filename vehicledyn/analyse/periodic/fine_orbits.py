"""Periodic orbits by collocation on finer and finer meshes, with points where equations bend."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import (
    Corrected,
    Direction,
    Scales,
    correct,
    tangent_of,
)
from vehicledyn.analyse.periodic.cycle_points import ahead, moved
from vehicledyn.analyse.periodic.nonsmooth_points import Kinks, aligned, misalignment
from vehicledyn.analyse.periodic.orbit import Orbit, adapted_mesh
from vehicledyn.base.errors import NumericalError

_ALIGNED, _ENOUGH, _MOVED = 1e-11, 1e-8, 12
"""Distances of a kink from a mesh point, part of the period: what is sought, and what is enough
where moving points brings them no nearer; and how often they are moved."""

_FIRST, _STEPS = 1e-4, 6
"""First way along a branch on which its fold is looked for, and how often it grows fourfold."""
_PLACE, _MOST = 1e-14, 60
"""Way to which the place of a fold is found, and iterations in which it is."""
_FOLD = 1e-7
"""Scaled slope of the parameter along the branch with which it turns."""


@dataclass(frozen=True)
class FineOrbit:
    """An orbit, the direction of the branch there if asked for, and the sizes it is scaled with."""

    found: Corrected
    scales: Scales
    along: Direction | None = None


@dataclass
class FineOrbits:
    """Finds the orbits of a model on meshes that suit them, and the means of some ``channels``."""

    model: AutonomousField
    channels: Sequence[int] = ()

    @cached_property
    def _kinks(self) -> Kinks:
        return Kinks(self.model, self.channels)

    def at(self, guess: Orbit, along: Direction | None = None) -> FineOrbit:
        """Return the orbit near a guess, on its mesh with points moved to its kinks.

        With a direction it lies on the plane across it; else the parameter stays.

        Raises
        ------
        NumericalError
            If it is not found.
        """
        scales = Scales(guess.scales(), guess.period, abs(guess.parameter) or 1.0)
        found = correct(self.model, guess, scales, along=along)
        before = math.inf
        for _ in range(_MOVED):
            orbit = found.orbit
            kinks = self._kinks.along(orbit)
            apart = misalignment(orbit.mesh, kinks)
            if apart <= _ALIGNED or 0.5 * before < apart <= _ENOUGH:
                break
            before = apart
            mesh = aligned(orbit.mesh, kinks)
            along = None if along is None else moved(orbit, along, mesh)
            found = correct(self.model, orbit.moved(mesh), scales, along=along)
        if along is not None:
            along = tangent_of(found, scales, along)
        return FineOrbit(found, scales, along)

    def finer(self, orbit: Orbit) -> Orbit:
        """Return an orbit on a mesh of twice as many intervals."""
        kinks = self._kinks.along(orbit)
        mesh = adapted_mesh(orbit, orbit.scales(), 2 * orbit.intervals, kinks)
        return orbit.moved(aligned(mesh, kinks))

    def fold(self, near: Orbit, along: Direction) -> FineOrbit:
        """Return the orbit near another at which the parameter turns along the branch.

        Raises
        ------
        NumericalError
            If there is none, as at a corner of the branch.
        """
        from scipy.optimize import brentq

        base = self.at(near, along)
        points = {0.0: base}

        def slope(way: float) -> float:
            if way not in points:
                point, line = points[0.0], points[0.0].along
                assert line is not None
                points[way] = self.at(ahead(point.found.orbit, line, way), line)
            found = points[way]
            assert found.along is not None
            return found.along.parameter / found.scales.parameter

        ways = (sign * _FIRST * 4.0**k for k in range(_STEPS) for sign in (1.0, -1.0))
        begin = slope(0.0)
        end = next((way for way in ways if slope(way) * begin <= 0.0), None)
        if end is not None:
            brentq(slope, 0.0, end, xtol=_PLACE, maxiter=_MOST, disp=False)
        best = min(points, key=lambda way: abs(slope(way)))
        if abs(slope(best)) < _FOLD:
            return points[best]
        raise NumericalError(
            f"the fold near {self.model.parameter} = {near.parameter:.6g} is a corner of the "
            "branch, as where a contact begins: it has no derivative of this kind"
        )
