"""What the recursions ask of a body that deforms: its points, its mass and how both move.

The body has a frame, that of its link, and coordinates q of its deformation. A point stands at
p(q) in the axes of that frame, turned by R(q); with q̇ it moves by Σ ∂p/∂q_k q̇_k.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from vehicledyn.symbolic.ops import Mat, Scalar, Vec

Columns = Mapping[int, Vec]
"""Derivatives of a vector by the coordinates, those that are not zero, by their index."""


@dataclass(frozen=True)
class Deflection:
    """Where a material point stands and how the coordinates move it.

    ``position`` [m] and ``linear``, its derivatives, are in the axes of the body; ``rotation`` is
    R with v_body = R v_point, and ``angular`` the angular velocities a unit rate of each
    coordinate gives, in the axes of the point.
    """

    position: Vec
    rotation: Mat
    linear: Columns
    angular: Columns


@dataclass(frozen=True)
class Slice:
    """A part of the mass: ``share`` of the whole, its place [m] and that place's derivatives.

    Where its own inertia counts it has a ``rotation``, v_body = R v_slice, and, in its axes,
    moments of ``inertia`` [kg m²] and ``angular``, the angular velocities a unit rate of each
    coordinate gives.
    """

    share: Scalar
    position: Vec
    linear: Columns
    rotation: Mat | None = None
    angular: Columns = field(default_factory=dict)
    inertia: Sequence[Scalar] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class AxialInertia:
    """Inertia of the sections about the first axis of the body.

    With the rates q̇ of a twist its kinetic energy is ½ whole ω² + ω Σ coupling q̇ + ½ Σ own q̇ q̇,
    ω the angular velocity of the body about that axis [kg m²]. ``own`` has pairs of coordinates
    in both orders.
    """

    whole: Scalar
    coupling: Mapping[int, Scalar]
    own: Mapping[tuple[int, int], Scalar]

    def held(self, k: int, rates: Sequence[Scalar]) -> Scalar:
        """Return what a coordinate feels of the rates of all, Σ own_kj rate_j."""
        total: Scalar = 0.0
        for (first, other), share in self.own.items():
            if first == k:
                total = total + share * rates[other]
        return total


class Flexibility(ABC):
    """A deformable body as the recursions know it.

    It gives its points and its mass as functions of the coordinates; velocities, accelerations,
    inertial forces and the mass matrix follow from these. Elastic forces are loads on the
    coordinates and come from the part that brings the body.
    """

    @property
    @abstractmethod
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates."""

    @property
    @abstractmethod
    def mass(self) -> Scalar:
        """Mass [kg]."""

    @property
    @abstractmethod
    def axial(self) -> AxialInertia:
        """Inertia of the sections about the first axis."""

    @abstractmethod
    def deflection(self, place: float, q: Sequence[Scalar]) -> Deflection:
        """Return where a point stands; ``place`` is its own coordinate in the body [1]."""

    @abstractmethod
    def slices(self, q: Sequence[Scalar]) -> list[Slice]:
        """Return the mass of the body as points."""

    def growths(self, q: Sequence[Scalar], rates: Sequence[Scalar]) -> list[Vec] | None:
        """Return p̈ of the slices at zero q̈ where that is known by a short formula [m/s²]."""
        return None

    @abstractmethod
    def drawn(self, place: float) -> dict[str, Any]:
        """Return a point as plain data, whose numbers may be symbols.

        ``position`` (3), ``linear`` (3, n) and ``quadratic`` (3, n, n) give it at amplitudes q as
        position + linear q + qᵀ quadratic q, ``slopes`` (3, n) its rotation vector.
        """


@dataclass(frozen=True)
class Station:
    """A point of a deformable body that a link stands at."""

    flexibility: Flexibility
    place: float
