"""A body of the tree whose deformation are component modes of finite elements.

Points are displaced to first order in the amplitudes, or to second order where geometric stiffness
is known, so that axial forces stiffen bending; a frame turns by the rotation whose Gibbs parameters
are half the rotation vector of its node.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.finite_elements.integrals import InertiaIntegrals
from vehicledyn.multibody.bodies.finite_elements.reduced_modes import ReducedModes
from vehicledyn.multibody.model.deformation import (
    Columns,
    Deflection,
    Flexibility,
    Integrals,
    Slice,
    TurningInertia,
)
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

Array = NDArray[np.float64]
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class ReducedBody(Flexibility):
    """Component modes as a deformable body; its places are those of the frames, 0, 1, 2, ..."""

    name: str
    modes: ReducedModes

    @property
    def integrals(self) -> InertiaIntegrals:
        """Inertia integrals about the frame of the body."""
        return self.modes.integrals

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the amplitudes, the slowest mode first."""
        return tuple(f"{self.name}.mode_{k + 1}" for k in range(len(self.modes.frequencies)))

    @cached_property
    def places(self) -> dict[str, float]:
        """Place of each frame by its name."""
        return {name: float(k) for k, name in enumerate(self.modes.frames)}

    @property
    def mass(self) -> Scalar:
        """Mass [kg]."""
        return self.modes.mass

    @cached_property
    def turning(self) -> TurningInertia:
        """Rotary inertia, and what the mass matrix holds beyond that of points."""
        matrix = self.integrals.turning
        places = zip(*np.nonzero(matrix), strict=True)
        return TurningInertia({(int(i), int(j)): float(matrix[i, j]) for i, j in places})

    @property
    def centre(self) -> Array:
        """Centre of mass of the undeformed body in its frame, shape (3,) [m]."""
        return np.asarray(self.integrals.products[0, 1:4] / self.integrals.mass)

    @property
    def inertia(self) -> Array:
        """Inertia of the undeformed body about its centre of mass, shape (3, 3) [kg m²]."""
        found, centre = self.integrals, self.centre
        second = found.products[1:4, 1:4] - found.mass * np.outer(centre, centre)
        return np.asarray(np.trace(second) * np.eye(3) - second + found.turning[:3, :3])

    @property
    def products(self) -> Integrals | None:
        """Inertia integrals; None where few points that have them take fewer operations."""
        products, modes = self.integrals.products, len(self.coordinates)
        if not self.has_points:
            return Integrals(products)
        entries = np.count_nonzero(_cleaned(products))
        by_points = len(self.integrals.points) * (15 * modes + 40)
        return Integrals(products) if by_points > 1.4 * entries + 60 * modes + 150 else None

    @cached_property
    def has_points(self) -> bool:
        """Whether its slices have all of its inertia, which axial forces do not stiffen then."""
        return self.integrals.second is None and self.integrals.are_of_points

    @property
    def second_order(self) -> Array | None:
        """Integrals of the displacements of second order."""
        return self.integrals.second

    def slices(self, q: Sequence[Scalar]) -> list[Slice]:
        """Return points of equal mass that have the inertia integrals of the body."""
        values = self.integrals.points
        share = 1.0 / len(values)
        return [
            Slice(share, *_moved(row[1:4], row[4:].reshape(-1, 3).T, q)) for row in _cleaned(values)
        ]

    def growths(self, q: Sequence[Scalar], rates: Sequence[Scalar]) -> list[Vec]:
        """Return p̈ of the points at zero q̈, which is zero."""
        return [ops.vector(0.0, 0.0, 0.0)] * len(self.integrals.points)

    def deflection(self, place: float, q: Sequence[Scalar]) -> Deflection:
        """Return where a frame stands; one whose node has no rotations keeps those of the body."""
        at, linear, angular = self._frame(place)
        position, columns = _moved(at, linear, q)
        if (curved := self._curved(place)) is not None:
            grown = [_sum(curved[:, k], q) for k in range(len(q))]
            for k, column in enumerate(grown):
                position = position + 0.5 * q[k] * column
                columns = {**columns, k: columns[k] + column if k in columns else column}
        if angular is None or not angular.any():
            return Deflection(position, rotations.identity(), columns, {})
        rotation, spin = _turned(_sum(angular, q))
        own = {k: spin @ ops.vector(*angular[:, k]) for k in range(len(q)) if angular[:, k].any()}
        return Deflection(position, rotation, columns, own)

    def _frame(self, place: float) -> tuple[Array, Array, Array | None]:
        at, linear, angular = list(self.modes.frames.values())[int(place)]
        return at, _cleaned(linear), None if angular is None else _cleaned(angular)

    def _curved(self, place: float) -> Array | None:
        found = self.modes.curved.get(list(self.modes.frames)[int(place)])
        return None if found is None or not found.any() else _cleaned(found)

    @cached_property
    def stiffness(self) -> Array:
        """Modal stiffness, shape (n,) [N/m]."""
        return np.asarray(self.modes.mass * self.modes.frequencies**2)

    def elastic_forces(
        self, q: Sequence[Scalar], rates: Sequence[Scalar], ratios: Sequence[Scalar]
    ) -> list[Scalar]:
        """Return elastic and damping forces on the amplitudes [N].

        Parameters
        ----------
        q, rates
            Amplitudes and their rates.
        ratios
            Damping ratio of each mode, added to the damping matrix [1].
        """
        found = []
        for k, stiff in enumerate(self.stiffness):
            speed = float(self.modes.frequencies[k])
            resistance = 2.0 * ratios[k] * (self.modes.mass * speed)
            force = -float(stiff) * q[k] - resistance * rates[k]
            for other, share in enumerate(self.modes.damping[k]):
                if share:
                    force = force - float(share) * rates[other]
            found.append(force)
        return found

    def energy(self, q: Sequence[Scalar]) -> Scalar:
        """Return the strain energy [J]."""
        terms = (0.5 * float(k) * a * a for k, a in zip(self.stiffness, q, strict=True))
        return sum(terms, start=ops.scalar(0.0))

    def drawn(self, place: float) -> dict[str, Any]:
        """Return a frame as plain data."""
        at, linear, angular = self._frame(place)
        turns = np.zeros_like(linear) if angular is None else angular
        found = {"position": at.tolist(), "linear": linear.tolist(), "turns": turns.tolist()}
        curved = self._curved(place)
        return found if curved is None else {**found, "curved": curved.tolist()}

    def place_of(self, name: str) -> float:
        """Return the place of a frame.

        Raises
        ------
        InputError
            If the body has no such frame.
        """
        if name not in self.places:
            words = f"'{name}' is neither interface nor kept node of '{self.name}'"
            raise InputError(f"{words}; it has {', '.join(self.places)}")
        return self.places[name]


def _moved(at: Array, linear: Array, q: Sequence[Scalar]) -> tuple[Vec, Columns]:
    """Return position at + linear q and its columns that are not zero."""
    columns: Mapping[int, Vec] = {
        k: ops.vector(*linear[:, k]) for k in range(len(q)) if linear[:, k].any()
    }
    return ops.vector(*at) + _sum(linear, q), columns


def _sum(linear: Array, q: Sequence[Scalar]) -> Vec:
    rows = []
    for row in linear:
        total = ops.scalar(0.0)
        for factor, amplitude in zip(row, q, strict=True):
            if factor:
                total = total + float(factor) * amplitude
        rows.append(total)
    return ops.vector(*rows)


def _cleaned(values: Array) -> Array:
    """Return values without what is rounding of the largest."""
    floor = _ROUNDING * np.abs(values).max(initial=0.0)
    return np.where(np.abs(values) > floor, values, 0.0)


def _turned(angle: Vec) -> tuple[Mat, Mat]:
    """Return the rotation of Gibbs parameters θ/2, and B of its ω = B θ̇ in its own axes.

    R = 1 + s (tilde(θ) + ½ tilde(θ)²) and B = s (1 - ½ tilde(θ)) with s = 4/(4 + θ²).
    """
    tilde = ops.tilde(angle)
    scale = 4.0 / (4.0 + ops.dot(angle, angle))
    spin = scale * (rotations.identity() - 0.5 * tilde)
    return rotations.identity() + scale * (tilde + 0.5 * (tilde @ tilde)), spin
