"""A straight beam of assumed modes: its points, its mass and its elastic forces.

With ξ = x/L and shapes φ_k, the axis deflects by v = Σ φ_k q_k along y and by w along z, is
stretched by s and its sections twist by ϑ. The point x of the axis stands at

    p = (x + s - ∫ (1 - √(1 - v'² - w'²)) dx, v, w),

whose foreshortening lets axial forces stiffen or buckle the beam. A section turns by the shortest
rotation that brings the first axis to the tangent (√(1 - v'² - w'²), v', w') and then by the twist
about it. Foreshortening and curvatures are taken to the sixth power of the slopes in the energies.
Sections have no inertia across the axis and stay at right angles to it (Euler, Bernoulli).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.beam_properties import TAPER_POINTS, Properties
from vehicledyn.multibody.bodies.beam_shapes import Shapes, quadrature
from vehicledyn.multibody.bodies.section_loads import SectionLoads
from vehicledyn.multibody.bodies.section_rotation import section_rotation
from vehicledyn.multibody.bodies.shortening import Shortening, inertia_products, summed
from vehicledyn.multibody.bodies.strain_energy import axial_energy, coupling_energy, steep_energy
from vehicledyn.multibody.model.deformation import (
    Deflection,
    Flexibility,
    Integrals,
    Slice,
    TiedAmplitude,
    TurningInertia,
    about_first_axis,
)
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

Array = NDArray[np.float64]
Stiffening: TypeAlias = Literal["shortening", "axial_force", "none"]
"""How axial forces act on bending: by the shortening of the axis, by an energy, not at all."""

DIRECTIONS = ("y", "z", "twist", "stretch")
_AXES = (1, 2, None, 0)
"""Along which axis each displaces the first axis of the beam."""
_ROUNDING = 1e-13
_SHEAR = 3
"""Order of the derivative of the deflection that the shear force goes with."""


@dataclass(frozen=True, eq=False)
class ModalBeam(Flexibility):
    """A straight beam along the first axis of its frame, clamped to it at x = 0.

    ``by_direction`` are the shapes of each of :data:`DIRECTIONS`. With the ``stiffening``
    "axial_force" points are displaced to first order and the axial force E A s' adds the energy
    ½ ∫ E A s' (v'² + w'²) dx.
    """

    name: str
    length: Scalar
    properties: Properties
    by_direction: dict[str, Shapes]
    stiffening: Stiffening = "shortening"

    @cached_property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates, direction by direction."""
        return tuple(
            f"{self.name}.{direction}_{k + 1}"
            for direction in DIRECTIONS
            for k in range(self.by_direction[direction].count)
        )

    @cached_property
    def ranges(self) -> dict[str, range]:
        """Indices of the coordinates of each direction."""
        found, start = {}, 0
        for direction in DIRECTIONS:
            count = self.by_direction[direction].count
            found[direction] = range(start, start + count)
            start += count
        return found

    @property
    def mass(self) -> Scalar:
        """Mass [kg]."""
        return self.properties.mean("mass_per_length") * self.length

    @property
    def turning(self) -> TurningInertia:
        """Inertia of the sections about the axis, which the twist adds to."""
        whole, twist = self.properties.mean("polar") * self.length, self.by_direction["twist"]
        own = self.ranges["twist"]
        if not self.properties.is_uniform:
            return self._tapered_axial(whole)
        points, weights = self.nodes
        means = sum(w * twist.values(x) for x, w in zip(points, weights, strict=True))
        return about_first_axis(
            whole,
            {k: whole * float(means[j]) for j, k in enumerate(own)},
            {(k, k): whole for k in own},
        )

    def _tapered_axial(self, whole: Scalar) -> TurningInertia:
        twist, items = self.by_direction["twist"], self.ranges["twist"]
        coupling: dict[int, Scalar] = dict.fromkeys(items, 0.0)
        own: dict[tuple[int, int], Scalar] = {(k, i): 0.0 for k in items for i in items}
        for x, weight in self.properties.weighted("polar", twist.points):
            shape = dict(zip(items, twist.values(x), strict=True))
            part = weight * self.length
            for k, value in shape.items():
                coupling[k] = coupling[k] + part * float(value)
                for i, other in shape.items():
                    own[k, i] = own[k, i] + part * float(value * other)
        return about_first_axis(whole, coupling, own)

    @property
    def points(self) -> int:
        """Points of the quadrature, in each part between kinks of shapes.

        They integrate shapes and the moment of the shortening exactly.
        """
        most = max(item.points for item in self.by_direction.values())
        return most if self.properties.is_uniform else most + TAPER_POINTS

    @cached_property
    def breaks(self) -> tuple[float, ...]:
        """Places at which shapes have kinks, ascending."""
        return tuple(sorted({a for item in self.by_direction.values() for a in item.breaks}))

    @property
    def nodes(self) -> tuple[Array, Array]:
        """Places and weights of the quadrature."""
        return quadrature(self.points, self.breaks)

    def slices(self, q: Sequence[Scalar]) -> list[Slice]:
        """Return the mass at the points of a Gauss quadrature."""
        points, weights = self.nodes
        drawn, found = self._drawn_back(q, [ops.scalar(0.0)] * len(q)), []
        for index, (x, weight) in enumerate(zip(points, weights, strict=True)):
            position, linear = self._axis(float(x), q, drawn[index] if drawn else None)
            share: Scalar = float(weight)
            if not self.properties.is_uniform:
                own = self.properties.at(float(x)).mass_per_length
                share = share * own / self.properties.mean("mass_per_length")
            found.append(Slice(share, position, linear))
        return found

    def carried(self, place: Scalar, q: Sequence[Scalar]) -> tuple[Vec, dict[int, Vec]]:
        """Return where the axis is at a place that varies, with its derivatives, to first order."""
        moved = [ops.scalar(0.0)] * 3
        linear: dict[int, Vec] = {}
        for axis, direction in enumerate(("stretch", "y", "z")):
            shapes = self.by_direction[direction].anywhere(place)
            for shape, k in zip(shapes, self.ranges[direction], strict=True):
                moved[axis] = moved[axis] + shape * q[k]
                linear[k] = ops.vector(*(shape if i == axis else 0.0 for i in range(3)))
        return ops.vector(place * self.length + moved[0], moved[1], moved[2]), linear

    @cached_property
    def _shortening(self) -> Shortening | None:
        """How bending draws the mass back; None where that is left out."""
        bends = {d: self.by_direction[d] for d in ("y", "z") if self.ranges[d]}
        if self.stiffening != "shortening" or not bends:
            return None
        return Shortening(bends, {d: self.ranges[d] for d in bends}, len(self.coordinates))

    def _drawn_back(self, q: Sequence[Scalar], rates: Sequence[Scalar]) -> list[TiedAmplitude]:
        """Return what the slices are drawn back by, nothing where that is left out."""
        if self._shortening is None:
            return []
        reach = self._shortening.reach(self.nodes[0])
        followers = self.followers(q, rates)
        return [summed(row, followers) for row in reach]

    @cached_property
    def products(self) -> Integrals | None:
        """Inertia integrals of a uniform beam."""
        if not self.properties.is_uniform:
            return None
        shapes = [self.by_direction[direction] for direction in DIRECTIONS]
        points = self.nodes
        item = self._shortening
        reach = np.zeros((len(points[0]), 0)) if item is None else item.reach(points[0])
        return Integrals(inertia_products(shapes, _AXES, reach, points), self.mass, self.length)

    def followers(self, q: Sequence[Scalar], rates: Sequence[Scalar]) -> list[TiedAmplitude]:
        """Return what draws the mass back, slope by slope."""
        item = self._shortening
        return [] if item is None else item.followers(q, rates, self.length)

    @property
    def recast(self) -> tuple[Flexibility, Array] | None:
        """The beam with slopes in place of amplitudes: the shortening couples them by products."""
        if self.products is None or self._shortening is None:
            return None
        turn, by_direction = np.eye(len(self.coordinates)), dict(self.by_direction)
        for direction, own in self._shortening.ranges.items():
            by_direction[direction], turn[own.start : own.stop, own.start : own.stop] = (
                self._shortening.by_slopes(direction)
            )
        return replace(self, by_direction=by_direction), turn

    def growths(self, q: Sequence[Scalar], rates: Sequence[Scalar]) -> list[Vec]:
        """Return p̈ of the slices at zero q̈: what the shortening grows by."""
        drawn = [item.growth for item in self._drawn_back(q, rates)]
        return [ops.vector(item, 0.0, 0.0) for item in drawn or [0.0] * len(self.nodes[0])]

    def _axis(
        self, place: float, q: Sequence[Scalar], drawn_back: TiedAmplitude | None
    ) -> tuple[Vec, dict[int, Vec]]:
        """Return where a point of the axis stands, with its derivatives."""
        across = {"y": ops.scalar(0.0), "z": ops.scalar(0.0)}
        along = place * self.length
        linear: dict[int, Vec] = {}
        for j, k in enumerate(self.ranges["stretch"]):
            shape = float(self.by_direction["stretch"].values(place)[j])
            along = along + shape * q[k]
            linear[k] = ops.vector(shape, 0.0, 0.0)
        pulls: dict[int, Scalar] = {}
        if drawn_back is not None:
            along = along + drawn_back.value
            for factor, row in zip(drawn_back.factors, drawn_back.shares, strict=True):
                for index in map(int, np.flatnonzero(row)):
                    pulls[index] = pulls.get(index, 0.0) + float(row[index]) * factor
        for axis, direction in enumerate(("y", "z"), 1):
            values = self.by_direction[direction].values(place)
            for j, k in enumerate(self.ranges[direction]):
                across[direction] = across[direction] + float(values[j]) * q[k]
                moved = [pulls.get(k, 0.0), 0.0, 0.0]
                moved[axis] = float(values[j])
                linear[k] = ops.vector(*moved)
        return ops.vector(along, across["y"], across["z"]), linear

    def deflection(self, place: float, q: Sequence[Scalar]) -> Deflection:
        """Return where the section at ``place`` L stands."""
        item = self._shortening
        drawn = None if item is None else item.drawn_back(place, q, self.length)
        position, linear = self._axis(place, q, drawn)
        slopes = [ops.scalar(0.0)] * 3
        given: dict[int, tuple[int, Scalar]] = {}
        for index, direction in enumerate(("y", "z", "twist")):
            order = 0 if direction == "twist" else 1
            values = self.by_direction[direction].values(place, order)
            for j, k in enumerate(self.ranges[direction]):
                share = float(values[j]) / (self.length if order else 1.0)
                slopes[index] = slopes[index] + share * q[k]
                given[k] = (index, share)
        rotation, turned = section_rotation(slopes, has=[bool(self.ranges[d]) for d in DIRECTIONS])
        angular = {k: turned[index] * share for k, (index, share) in given.items()}
        return Deflection(position, rotation, linear, angular)

    def elastic_forces(
        self, q: Sequence[Scalar], rates: Sequence[Scalar], damping: Scalar
    ) -> list[Scalar]:
        """Return elastic and damping forces on the coordinates [N or N m].

        Parameters
        ----------
        q, rates
            Amplitudes and their rates.
        damping
            Damping ratio of each mode [1]; of a tapered beam, whose modes mix the shapes, of each
            shape by itself.
        """
        found: list[Scalar] = []
        for direction in DIRECTIONS:
            word = "polar" if direction == "twist" else "mass_per_length"
            inertia = self.properties.mean(word) * self.length
            matrix = self._springs(direction)
            for j, k in enumerate(self.ranges[direction]):
                resistance = 2.0 * damping * ops.sqrt(matrix[j, j] * inertia)
                pull = self._pull(matrix, j, [q[i] for i in self.ranges[direction]])
                found.append(-pull - resistance * rates[k])
        coupling = self._couplings(q)
        if not coupling:
            return found
        slope = ops.dense(ops.jacobian(sum(coupling), ops.column(list(q))))
        return [force - slope[k] for k, force in enumerate(found)]

    def _springs(self, direction: str) -> dict[tuple[int, int], Scalar]:
        """Return the stiffness of the modes of a direction, of pairs only where they couple."""
        bends = direction in ("y", "z")
        power, shapes = 3 if bends else 1, self.by_direction[direction]
        if self.properties.is_uniform:
            modulus = getattr(self.properties.start, direction) / self.length**power
            return {(j, j): float(f) * modulus for j, f in enumerate(shapes.stiffness)}
        count = range(shapes.count)
        found: dict[tuple[int, int], Scalar] = {(i, j): 0.0 for i in count for j in count}
        for x, weight in self.properties.weighted(direction, shapes.points):
            values = shapes.values(x, 2 if bends else 1)
            found = {
                (i, j): before + weight * float(values[i] * values[j]) / self.length**power
                for (i, j), before in found.items()
            }
        return found

    @staticmethod
    def _pull(matrix: Mapping[tuple[int, int], Scalar], j: int, q: Sequence[Scalar]) -> Scalar:
        total = ops.scalar(0.0)
        for (row, i), stiffness in matrix.items():
            if row == j:
                total = total + stiffness * q[i]
        return total

    def _couplings(self, q: Sequence[Scalar]) -> list[Scalar]:
        def along(direction: str, place: float, derivative: int) -> Scalar:
            return self._along(direction, place, q, derivative)

        found = []
        counts = [len(self.ranges[d]) for d in ("y", "z", "twist")]
        if all(counts):
            points = self.points + max(counts)
            found.append(
                coupling_energy(
                    along, self.properties, points, self.length,
                    is_steep=self._shortening is not None,
                )
            )  # fmt: skip
        elif self._shortening is not None:
            bends, places = list(self._shortening.shapes), self._shortening.places
            found.append(steep_energy(along, bends, self.properties, places, self.length))
        if self.stiffening == "axial_force":
            found.append(axial_energy(along, self.properties, 2 * self.points, self.length))
        return found

    def energy(self, q: Sequence[Scalar]) -> Scalar:
        """Return the strain energy [J]."""
        total = sum(self._couplings(q), start=ops.scalar(0.0))
        for direction, items in self.ranges.items():
            own = [q[k] for k in items]
            for (i, j), stiffness in self._springs(direction).items():
                total = total + 0.5 * stiffness * own[i] * own[j]
        return total

    def loads(self, place: float, q: Sequence[Scalar]) -> SectionLoads:
        """Return forces and moments in the section at ``place`` L.

        Moments are E I times the curvature; shear forces are the rates of the moments along x.
        """

        def load(direction: str, order: int, sign: float = 1.0) -> Scalar | None:
            if not self.ranges[direction]:
                return None
            modulus = sign * getattr(self.properties.at(place), direction) / self.length**order
            found = modulus * self._along(direction, place, q, order)
            if order == _SHEAR and not self.properties.is_uniform:
                slope = sign * self.properties.slope(direction, place) / self.length**order
                found = found + slope * self._along(direction, place, q, order - 1)
            return found

        return SectionLoads(
            axial=load("stretch", 1),
            shear_y=load("y", 3, -1.0),
            shear_z=load("z", 3, -1.0),
            torque=load("twist", 1),
            moment_y=load("z", 2, -1.0),
            moment_z=load("y", 2),
        )

    def _along(self, direction: str, place: float, q: Sequence[Scalar], derivative: int) -> Scalar:
        values = self.by_direction[direction].values(place, derivative)
        return _weighted(values, [q[k] for k in self.ranges[direction]])

    def drawn(self, place: float) -> dict[str, Any]:
        """Return a point of the axis as plain data."""
        count = len(self.coordinates)
        linear = [[0.0] * count for _ in range(3)]
        turned: list[list[Any]] = [[0.0] * count for _ in range(3)]
        for row, direction in enumerate(("stretch", "y", "z")):
            for j, k in enumerate(self.ranges[direction]):
                linear[row][k] = float(self.by_direction[direction].values(place)[j])
        for j, k in enumerate(self.ranges["twist"]):
            turned[0][k] = float(self.by_direction["twist"].values(place)[j])
        for row, sign, direction in ((2, 1.0, "y"), (1, -1.0, "z")):
            slopes = self.by_direction[direction].values(place, 1)
            for j, k in enumerate(self.ranges[direction]):
                turned[row][k] = sign * float(slopes[j]) / self.length
        position, item = [place * self.length, 0.0, 0.0], self._shortening
        straight = {"quadratic": [[0.0] * count for _ in range(count)]}
        back = straight if item is None else item.drawn(place, self.length)
        return {"position": position, "linear": linear, "slopes": turned, **back}


def _weighted(factors: Sequence[float] | Array, values: Sequence[Scalar]) -> Scalar:
    total = ops.scalar(0.0)
    for factor, value in zip(factors, values, strict=True):
        if abs(factor) > _ROUNDING:
            total = total + float(factor) * value
    return total
