"""What the recursions ask of a body that deforms: its points, its mass and how both move.

The body has a frame, that of its link, and coordinates q of its deformation. A point stands at
p(q) in the axes of that frame, turned by R(q); with q̇ it moves by Σ ∂p/∂q_k q̇_k.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from vehicledyn.symbolic.ops import Mat, Scalar, Vec

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

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
class TurningInertia:
    """Inertia beyond that of the slices, which does not depend on the deformation.

    With the angular velocity ω of the body in its axes and the rates q̇ the kinetic energy has the
    part ½ (ω, q̇)ᵀ T (ω, q̇). ``entries`` are those of T that are not zero, both triangles [kg m²];
    places 0 to 2 are those of ω, 3 + k that of q̇_k.
    """

    entries: Mapping[tuple[int, int], Scalar] = field(default_factory=dict)

    def entry(self, row: int, column: int) -> Scalar:
        """Return an entry of T."""
        return self.entries.get((row, column), 0.0)

    @cached_property
    def rows(self) -> dict[int, list[tuple[int, Scalar]]]:
        """Columns and entries of each row that has some."""
        found: dict[int, list[tuple[int, Scalar]]] = {}
        for (row, column), value in self.entries.items():
            found.setdefault(row, []).append((column, value))
        return found

    def product(self, row: int, values: Sequence[Scalar]) -> Scalar:
        """Return a row of T (ω, q̇), or of T times the derivatives of these."""
        total: Scalar = 0.0
        for column, value in self.rows.get(row, ()):
            total = total + value * values[column]
        return total


def about_first_axis(
    whole: Scalar, coupling: Mapping[int, Scalar], own: Mapping[tuple[int, int], Scalar]
) -> TurningInertia:
    """Return the inertia of sections about the first axis of the body.

    Parameters
    ----------
    whole
        That of a turn of the body [kg m²].
    coupling, own
        Of a turn with the rate of a coordinate, and of the rates of two, by the indices of these;
        pairs in both orders.
    """
    entries: dict[tuple[int, int], Scalar] = {(0, 0): whole}
    for k, value in coupling.items():
        entries[0, 3 + k] = entries[3 + k, 0] = value
    return TurningInertia(entries | {(3 + k, 3 + j): value for (k, j), value in own.items()})


@dataclass(frozen=True)
class TiedAmplitude:
    """An amplitude that follows the coordinates: the ``value`` g(q) [m].

    Its derivatives by the coordinates are the sum of ``factors`` times a row each of the numbers
    ``shares``, shape (factors, coordinates); ``rate`` is ġ and ``growth`` g̈ at zero q̈.
    """

    value: Scalar
    factors: Sequence[Scalar]
    shares: NDArray[np.float64]
    rate: Scalar
    growth: Scalar


@dataclass(frozen=True)
class Integrals:
    """Inertia integrals of a body whose displacements are linear in some amplitudes a.

    The amplitudes are the coordinates and what follows them. With points at p = l x + Σ φ_k a_k
    ``products`` times ``scale`` are ∫ f g dm of the functions 1, x, y, z, φ_1x, φ_1y, φ_1z,
    φ_2x, ..., shape (4 + 3 n, 4 + 3 n) [kg, kg m, kg m²]; ``length`` is l.
    """

    products: NDArray[np.float64]
    scale: Scalar = 1.0
    length: Scalar = 1.0


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
    def turning(self) -> TurningInertia:
        """Inertia beyond that of the slices, such as that of sections about the first axis."""

    @abstractmethod
    def deflection(self, place: float, q: Sequence[Scalar]) -> Deflection:
        """Return where a point stands; ``place`` is its own coordinate in the body [1]."""

    @property
    def has_points(self) -> bool:
        """Whether its slices have all of its inertia; one that has not gives its ``products``."""
        return True

    @abstractmethod
    def slices(self, q: Sequence[Scalar]) -> list[Slice]:
        """Return the mass of the body as points."""

    def growths(self, q: Sequence[Scalar], rates: Sequence[Scalar]) -> list[Vec] | None:
        """Return p̈ of the slices at zero q̈ where that is known by a short formula [m/s²]."""
        return None

    @property
    def products(self) -> Integrals | None:
        """Inertia integrals, None for a body whose displacements have no such form."""
        return None

    def followers(self, q: Sequence[Scalar], rates: Sequence[Scalar]) -> list[TiedAmplitude]:
        """Return the amplitudes beyond the coordinates that the integrals know."""
        return []

    @property
    def recast(self) -> tuple[Flexibility, NDArray[np.float64]] | None:
        """The same body in coordinates T q whose mass matrix takes fewer operations, and T."""
        return None

    @property
    def second_order(self) -> NDArray[np.float64] | None:
        """Integrals ∫ f Ψ_kl dm of 1, x, y and z, shape (n, n, 4, 3) [kg/m, kg]; None without.

        With them points are at p = x + Σ φ_k q_k + ½ Σ Ψ_kl q_k q_l. What is of third order in the
        amplitudes and their rates is left out of the kinetic energy, all else follows from it.
        """
        return None

    @abstractmethod
    def drawn(self, place: float) -> dict[str, Any]:
        """Return a point as plain data, whose numbers may be symbols.

        ``position`` (3), ``linear`` (3, n) and ``quadratic`` (3, n, n) give it at amplitudes q as
        position + linear q + qᵀ quadratic q, ``slopes`` (3, n) its rotation vector, and, if any,
        ``steep`` (planes, places, n) slopes whose squares e draw it on by ``drawn_back`` (places)
        times e²/8 + e³/16 along the first axis; or without
        ``quadratic`` and with ``turns`` (3, n) the vector whose half are its Gibbs parameters, and
        with ``curved`` (3, n, n), if any, at position + linear q + ½ qᵀ curved q.
        """


@dataclass(frozen=True)
class Station:
    """A point of a deformable body that a link stands at."""

    flexibility: Flexibility
    place: float
