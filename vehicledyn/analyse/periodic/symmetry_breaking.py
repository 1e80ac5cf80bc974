"""Where cycles branch off that are no longer mirror-symmetric: the first of them, and its way.

With the half map P = S φ_T/2 of an orbit that is its own image (:mod:`.mirror`), such cycles branch
off where P has the multiplier -1. Its eigenvector v is the way to them:

    x(t) + ε Φ(t) v,    v turned round after half a period:  P v = -v

The parameter changes with ε² only, and -ε leads to their mirror images.

References
----------
Kuznetsov (2004), Elements of Applied Bifurcation Theory, 3rd ed., section 7.4.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import Direction
from vehicledyn.analyse.periodic.cycle_points import CyclePoint, ahead
from vehicledyn.analyse.periodic.mirror_symmetry import Mirror, mirror_of, mirrored_mesh
from vehicledyn.analyse.periodic.monodromy import Passages, passages
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.kernel.engine import Vector

_OPPOSITE = 0.02
"""Distance from -1 of the multiplier of the half map up to which the branch point is its own."""

_LOOKS = 32
_RETURNED, _TURNED = 0.5, -0.5
"""Part of the first distance to the own image, and cosine of the last two, with which cycles have
come back to their own images, or have passed them."""

_FARTHEST = 3.0
"""Steps by which it is led on where that was at most."""


@dataclass(frozen=True)
class LeadingOff:
    """An orbit on a branch point and the way off it: the largest change is once the scale."""

    orbit: Orbit
    along: Direction
    mirror: Mirror

    def start(self, size: float) -> Orbit:
        """Return a guess of a cycle a way along the branch, part of the scales."""
        return ahead(self.orbit, self.along, size)


def leading_off(
    field: AutonomousField, point: CyclePoint, span: tuple[float, float]
) -> LeadingOff | None:
    """Return the way from a branch point to cycles that are not mirror-symmetric.

    None where the cycle is not its own image in a mirror that holds at the ends of the ``span`` of
    the parameter, or where the branch that is met does not break it.

    Raises
    ------
    NumericalError
        If the motion along the cycle cannot be integrated.
    """
    if field.n_unknowns:
        return None
    found = point.passages
    if found is None or found.mirror is None:
        orbit = point.orbit
        mirror = mirror_of(field, orbit, (orbit.parameter, *span))
        if mirror is None:
            return None
        orbit = orbit.moved(mirrored_mesh(orbit.mesh))
        found = passages(field, orbit)
    else:
        orbit, mirror = point.orbit, found.mirror
    changes = _turned_round(found, mirror)
    if changes is None:
        return None
    return LeadingOff(orbit, Direction(changes * found.scales, 0.0, 0.0), mirror)


def _turned_round(found: Passages, mirror: Mirror) -> Vector | None:
    """Return the scaled changes of all points by the eigenvector of -1; None without one."""
    image = mirror.scaled(found.scales)
    count, n = len(found.orbit.states) // 2, len(found.scales)
    carried = np.empty((count + 1, n, n))
    carried[0] = np.eye(n)
    for k, piece in enumerate(found.by_state[:count]):
        carried[k + 1] = piece @ carried[k]
    values, vectors = np.linalg.eig(image.rows(carried[-1]))
    nearest = int(np.argmin(np.abs(values + 1.0)))
    if abs(values[nearest] + 1.0) > _OPPOSITE or values[nearest].imag:
        return None
    half = carried[:-1] @ vectors[:, nearest].real
    changes = np.concatenate([half, -image.image(half)])
    return np.asarray(changes / np.abs(changes).max())


class OwnImages:
    """Tells where a branch comes back to cycles that are their own image, as it led off them."""

    def __init__(self, way: LeadingOff) -> None:
        self._mirror, self._scales = way.mirror, way.orbit.scales()

    def distances(self, orbit: Orbit) -> Vector:
        """Return by how much states half a period later miss their images, in the scales."""
        places = np.arange(_LOOKS) / _LOOKS
        states, _ = orbit.sample(places)
        missed = np.roll(states, -_LOOKS // 2, axis=0) - self._mirror.image(states)
        return np.asarray(missed / self._scales)

    def are_met(self, points: Sequence[CyclePoint]) -> bool:
        """Return whether the last cycle of a branch is one, or lies beyond: an image before."""
        if len(points) <= 2:
            return False
        first, before, last = (self.distances(points[k].orbit) for k in (0, -2, -1))
        sizes = [float(np.linalg.norm(own)) for own in (first, before, last)]
        if sizes[2] < _RETURNED * sizes[0]:
            return True
        return bool(np.vdot(before, last) < _TURNED * sizes[1] * sizes[2])

    def place(self, points: Sequence[CyclePoint]) -> tuple[float, float, float]:
        """Return about where a branch that has come back meets its own images, and how surely.

        Value and period [s] change with the square of the distance; they are led on from the two
        cycles before the last one, of which the difference of the values is reported too.
        """
        orbits = [point.orbit for point in points[-3:-1]]
        squares = [float((self.distances(orbit) ** 2).sum()) for orbit in orbits]
        ends = [np.array([orbit.parameter, orbit.period]) for orbit in orbits]
        change = ends[1] - ends[0]
        fallen = squares[0] - squares[1]
        part = squares[1] / fallen if fallen > 0.0 else 0.0
        value, period = ends[1] + min(part, _FARTHEST) * change
        return float(value), float(period), abs(float(change[0]))
