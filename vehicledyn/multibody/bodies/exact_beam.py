"""A beam that bends, twists, stretches and shears by any amount (Simo, Reissner).

Its sections turn by R(ξ) and the axis follows r' = R (1 + ε, γ_y, γ_z), ξ = x/L. The angles and
strains are sums of shapes, so that the strains are exact whatever the deflection is: for each
bending shape φ_k of small deflections the angle takes φ_k'/L, for stretch and shear the strain
φ_k'/L. Small amplitudes are those of :class:`~vehicledyn.multibody.bodies.modal_beam.ModalBeam`.
The axis is summed over the points of a Gauss quadrature, which integrates polynomials exactly. In a
plane R is the turn by the angle; in space it has the modified Rodrigues parameters
σ = (0, -b, a)/4, which are regular below a whole turn (Schaub, Junkins 1996, J. Astronaut. Sci.
44(1), 1-19), and then the twist. The axis of an unloaded curved beam has the rotation R₀ and the
curvature K; its sections turn by R₀ R, and Rᵀ K - K adds to the strains of bending and twist.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.beam_properties import TAPER_POINTS, Properties, Stiffness
from vehicledyn.multibody.bodies.beam_shapes import Shapes, points_of_a_part, quadrature
from vehicledyn.multibody.bodies.curved_axis import CurvedAxis
from vehicledyn.multibody.bodies.section_loads import SectionLoads
from vehicledyn.multibody.model.deformation import Deflection, Flexibility, Slice, TurningInertia
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

Array = NDArray[np.float64]
DIRECTIONS = ("y", "z", "twist", "stretch", "shear_y", "shear_z")
_AXES = {"stretch": 0, "shear_y": 1, "shear_z": 2}
_SPARE = 3
_CURVED_POINTS = 6
"""More points of the quadrature where the axis is curved, enough for a full circle."""


@dataclass(frozen=True)
class _Section:
    """A section: its rotation, strain (1 + ε, γ_y, γ_z) and ω by each angle, in its axes."""

    rotation: Mat
    strain: Vec
    spins: Mapping[str, Vec]

    def columns(self) -> dict[str, Vec]:
        """Return ∂(R Γ) by each angle and strain, in the axes of the beam."""
        found = {
            name: self.rotation @ ops.cross(spin, self.strain) for name, spin in self.spins.items()
        }
        return found | {name: self.rotation[:, axis] for name, axis in _AXES.items()}


@dataclass(frozen=True, eq=False)
class ExactBeam(Flexibility):
    """A beam that begins along the first axis of its frame, clamped to it at x = 0.

    ``by_direction`` are the shapes of each of :data:`DIRECTIONS`; ``axis`` is that of the unloaded
    beam, None of a straight one.
    """

    name: str
    length: Scalar
    properties: Properties
    by_direction: Mapping[str, Shapes]
    axis: CurvedAxis | None = None

    @cached_property
    def ranges(self) -> dict[str, range]:
        """Indices of the coordinates of each direction."""
        found, start = {}, 0
        for direction in DIRECTIONS:
            count = self.by_direction[direction].count
            found[direction] = range(start, start + count)
            start += count
        return found

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates, direction by direction."""
        return tuple(
            f"{self.name}.{direction}_{j + 1}"
            for direction in DIRECTIONS
            for j, _ in enumerate(self.ranges[direction])
        )

    @property
    def mass(self) -> Scalar:
        """Mass [kg]."""
        return self.properties.mean("mass_per_length") * self.length

    @property
    def turning(self) -> TurningInertia:
        """Nothing: the slices have an inertia of their own."""
        return TurningInertia()

    @property
    def _has_inertia(self) -> bool:
        own = _turning(self.properties.start)
        return any(not ops.is_structurally_zero(item) for item in own)

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Places at which shapes have kinks, ascending."""
        return tuple(sorted({a for item in self.by_direction.values() for a in item.breaks}))

    @property
    def points(self) -> int:
        """Number of points of the quadrature of shapes without kinks."""
        most = max(item.points for item in self.by_direction.values()) + _SPARE
        most += 0 if self.axis is None else _CURVED_POINTS
        return most if self.properties.is_uniform else most + TAPER_POINTS

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        return quadrature(points_of_a_part(self.points, len(self.breaks)), self.breaks)

    def _angles(self, place: float, derivative: int = 0) -> dict[str, Array]:
        """Return what a unit amplitude gives angle or strain, without 1/L, by direction."""
        return {
            direction: self.by_direction[direction].values(
                place, derivative + (direction != "twist")
            )
            for direction in DIRECTIONS
        }

    def _sum(self, direction: str, factors: Array, q: Sequence[Scalar]) -> Scalar:
        total = ops.scalar(0.0)
        for factor, k in zip(factors, self.ranges[direction], strict=True):
            total = total + float(factor) * q[k]
        return total if direction == "twist" else total / self.length

    def _section(self, place: float, q: Sequence[Scalar]) -> _Section:
        shapes = self._angles(place)
        value = {d: self._sum(d, shapes[d], q) for d in DIRECTIONS}
        strain = ops.vector(1.0 + value["stretch"], value["shear_y"], value["shear_z"])
        rotation, spins = _turned(value["y"], value["z"], value["twist"], self._has)
        if self.axis is not None:
            rotation = self.axis.rotation(place) @ rotation
        return _Section(rotation, strain, spins)

    @property
    def _has(self) -> tuple[bool, bool, bool]:
        return bool(self.ranges["y"]), bool(self.ranges["z"]), bool(self.ranges["twist"])

    def _weights(self, place: float) -> Array:
        """Return the weights that integrate over the nodes from 0 to a place, shape (nodes,)."""
        size = points_of_a_part(self.points, len(self.breaks))
        nodes, shares = quadrature(size)
        basis, found = legendre.legvander(2.0 * nodes - 1.0, size - 1), []
        for begin, end in pairwise((0.0, *self.breaks, 1.0)):
            part = min(max((place - begin) / (end - begin), 0.0), 1.0)
            integrals = shares @ legendre.legvander(2.0 * part * nodes - 1.0, size - 1) * part
            found.append((end - begin) * np.linalg.solve(basis.T, integrals))
        return np.concatenate(found)

    def _place(self, weights: Array, sections: Sequence[_Section]) -> tuple[Vec, dict[int, Vec]]:
        """Return a point of the axis and its derivatives from the sections at the nodes."""
        position = ops.vector(0.0, 0.0, 0.0)
        linear = {k: ops.vector(0.0, 0.0, 0.0) for k in range(len(self.coordinates))}
        for weight, node, section in zip(weights, self._nodes[0], sections, strict=True):
            position = position + float(weight) * (section.rotation @ section.strain)
            columns, shapes = section.columns(), self._angles(float(node))
            for direction in DIRECTIONS:
                for j, k in enumerate(self.ranges[direction]):
                    factor = float(weight * shapes[direction][j])
                    scaled = columns[direction] * factor
                    linear[k] = linear[k] + (
                        self.length * scaled if direction == "twist" else scaled
                    )
        return self.length * position, linear

    def _spins(self, place: float, section: _Section) -> dict[int, Vec]:
        """Return the angular velocities of a section by the coordinates, in its axes."""
        shapes = self._angles(place)
        found = {}
        for direction, spin in section.spins.items():
            scale = 1.0 if direction == "twist" else 1.0 / self.length
            for j, k in enumerate(self.ranges[direction]):
                found[k] = spin * (float(shapes[direction][j]) * scale)
        return found

    def _sections(self, q: Sequence[Scalar]) -> list[_Section]:
        return [self._section(float(node), q) for node in self._nodes[0]]

    def slices(self, q: Sequence[Scalar]) -> list[Slice]:
        """Return the mass at the points of the quadrature."""
        sections, found = self._sections(q), []
        for node, weight, section in zip(*self._nodes, sections, strict=True):
            position, linear = self._place(self._weights(float(node)), sections)
            numbers = self.properties.at(float(node))
            share: Scalar = float(weight)
            if not self.properties.is_uniform:
                mean = self.properties.mean("mass_per_length")
                share = share * numbers.mass_per_length / mean
            item = Slice(share, position, linear)
            if self._has_inertia:
                spins = self._spins(float(node), section)
                inertia = [float(weight) * (j * self.length) for j in _turning(numbers)]
                item = replace(item, rotation=section.rotation, angular=spins, inertia=inertia)
            found.append(item)
        return found

    def deflection(self, place: float, q: Sequence[Scalar]) -> Deflection:
        """Return where the section at ``place`` L stands."""
        section = self._section(place, q)
        position, linear = self._place(self._weights(place), self._sections(q))
        return Deflection(position, section.rotation, linear, self._spins(place, section))

    def elastic_forces(
        self, q: Sequence[Scalar], rates: Sequence[Scalar], damping: Scalar
    ) -> list[Scalar]:
        """Return elastic and damping forces on the coordinates [N or N m].

        Parameters
        ----------
        q, rates
            Amplitudes and their rates.
        damping
            Damping ratio of each mode of small amplitude, of a tapered beam by the means of its
            numbers [1].
        """
        column = ops.column(list(q))
        slope = ops.dense(ops.jacobian(self.energy(q), column))
        found = []
        for direction in DIRECTIONS:
            shapes = self.by_direction[direction]
            power = 3 if direction in ("y", "z") else 1
            polar = self.properties.mean("polar" if direction == "twist" else "mass_per_length")
            modulus = self.properties.mean(direction)
            for j, k in enumerate(self.ranges[direction]):
                stiff = float(shapes.stiffness[j]) * modulus / self.length**power
                resistance = 2.0 * damping * ops.sqrt(stiff * polar * self.length)
                found.append(-slope[k] - resistance * rates[k])
        return found

    def energy(self, q: Sequence[Scalar]) -> Scalar:
        """Return the strain energy [J]."""
        total = ops.scalar(0.0)
        for place, weight in zip(*self._nodes, strict=True):
            terms = self._strains(float(place), q)
            moduli = self.properties.at(float(place))
            own = [getattr(moduli, d) * t * t for d, t in terms.items()]
            total = total + 0.5 * float(weight) * sum(own, start=ops.scalar(0.0))
        return total * self.length

    def _strains(self, place: float, q: Sequence[Scalar]) -> dict[str, Scalar]:
        """Return curvatures and strains of a section that has coordinates for them, by direction.

        The curvature along z is that about y: negative where w'' is positive.
        """
        section, slopes = self._section(place, q), self._angles(place, 1)
        curved = ops.vector(0.0, 0.0, 0.0)
        for direction, spin in section.spins.items():
            curved = curved + spin * (self._sum(direction, slopes[direction], q) / self.length)
        if self.axis is not None:
            own = self.axis.vector
            turned = self.axis.rotation(place).T @ section.rotation
            curved = curved + turned.T @ own - own
        terms = {"twist": curved[0], "z": curved[1], "y": curved[2]}
        strain = section.strain - ops.vector(1.0, 0.0, 0.0)
        terms |= {name: strain[axis] for name, axis in _AXES.items()}
        return {direction: term for direction, term in terms.items() if self.ranges[direction]}

    def loads(self, place: float, q: Sequence[Scalar]) -> SectionLoads:
        """Return forces and moments in the section at ``place`` L, in the axes of the section."""
        moduli = self.properties.at(place)
        found = {d: getattr(moduli, d) * term for d, term in self._strains(place, q).items()}
        order = ("stretch", "shear_y", "shear_z", "twist", "z", "y")
        return SectionLoads(*(found.get(direction) for direction in order))

    def drawn(self, place: float) -> dict[str, Any]:
        """Return a point as plain data: shapes at the nodes, their weights, shapes at the point."""
        nodes = [self._drawn_shapes(float(node)) for node in self._nodes[0]]
        weights = [float(w) * self.length for w in self._weights(place)]
        found = {"nodes": nodes, "weights": weights, "end": self._drawn_shapes(place)}
        if self.axis is None:
            return found
        turns = [self.axis.rotation(float(x)) for x in (*self._nodes[0], place)]
        return found | {"turns": [[[r[i, j] for j in range(3)] for i in range(3)] for r in turns]}

    def _drawn_shapes(self, place: float) -> list[list[Any]]:
        rows: list[list[Any]] = []
        for direction, shapes in self._angles(place).items():
            row: list[Any] = [0.0] * len(self.coordinates)
            for j, k in enumerate(self.ranges[direction]):
                row[k] = float(shapes[j]) / (1.0 if direction == "twist" else self.length)
            rows.append(row)
        return rows


def _turning(numbers: Stiffness) -> tuple[Scalar, ...]:
    """Return the inertia of a section about its axes over length [kg m]."""
    return numbers.polar, numbers.rotary_z, numbers.rotary_y


def _turned(
    a: Scalar, b: Scalar, twist: Scalar, has: tuple[bool, bool, bool]
) -> tuple[Mat, dict[str, Vec]]:
    """Return the rotation of a section and ω by a, b and the twist, in its own axes."""
    nothing = ops.vector(0.0, 0.0, 0.0)
    spins = {"y": nothing, "z": nothing, "twist": ops.vector(1.0, 0.0, 0.0)}
    if not has[1] and not has[2]:
        return rotations.turn(3, a), spins | {"y": ops.vector(0.0, 0.0, 1.0)}
    if not has[0] and not has[2]:
        return rotations.turn(2, -b), spins | {"z": ops.vector(0.0, -1.0, 0.0)}
    y, z = -0.25 * b, 0.25 * a
    size = y * y + z * z
    scale = 1.0 / ((1.0 + size) * (1.0 + size))
    r, s = (1.0 - size) * scale, scale
    bend = rotations.matrix(
        [
            [1.0 - 8.0 * s * size, -4.0 * r * z, 4.0 * r * y],
            [4.0 * r * z, 1.0 - 8.0 * s * z * z, 8.0 * s * y * z],
            [-4.0 * r * y, 8.0 * s * y * z, 1.0 - 8.0 * s * y * y],
        ]
    )
    by_y = 4.0 * ops.vector(2.0 * s * z, r + 2.0 * s * y * y, 2.0 * s * y * z)
    by_z = 4.0 * ops.vector(-2.0 * s * y, 2.0 * s * y * z, r + 2.0 * s * z * z)
    turn = rotations.turn(1, twist) if has[2] else rotations.identity()
    spins["y"] = turn.T @ (0.25 * by_z)
    spins["z"] = turn.T @ (-0.25 * by_y)
    return bend @ turn, spins
