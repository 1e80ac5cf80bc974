"""Motion of the points of deformable bodies, as links that stand at them and their mass need it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from vehicledyn.multibody.joints.joint_type import Axes
from vehicledyn.symbolic import ops

if TYPE_CHECKING:
    from vehicledyn.multibody.model.deformation import Columns, Deflection, Slice
    from vehicledyn.multibody.model.tree import Tree
    from vehicledyn.symbolic.ops import Scalar, Vec

T = TypeVar("T")


class DeformedMotion(ABC):
    """What a motion of links knows of the deformable ones among them."""

    tree: Tree
    _q: dict[str, Scalar]
    _qd: dict[str, Scalar]

    @abstractmethod
    def link_axes(self, link: int) -> Axes:
        """Return the axes of a link's joint in the link's axes; none without a joint."""

    @abstractmethod
    def _acceleration(self, name: str) -> Scalar:
        """Return the acceleration of a coordinate."""

    @abstractmethod
    def _once(self, what: str, link: int, build: Callable[[], T]) -> T:
        """Return what is built once for a link."""

    def deflection(self, link: int) -> Deflection:
        """Return where a link at a station stands on its parent."""

        def build() -> Deflection:
            station = self.tree.links[link].station
            if station is None:
                raise ValueError(f"link {link} stands at no point of a deformable body")
            return station.flexibility.deflection(station.place, self.amplitudes(link))

        return self._once("deflection", link, build)

    def slices(self, link: int) -> list[Slice]:
        """Return the mass of the deformable body of a link as points."""

        def build() -> list[Slice]:
            body = self.tree.links[link].flexibility
            return [] if body is None else body.slices(self.amplitudes(link))

        return self._once("slices", link, build)

    def amplitudes(self, link: int) -> list[Scalar]:
        """Return the coordinates of the deformable body of a link, or at whose point it stands."""
        return [self._q[name] for name in self.deforming(link)]

    def amplitude_rates(self, link: int) -> list[Scalar]:
        """Return their rates."""
        return [self._qd[name] for name in self.deforming(link)]

    def amplitude_accelerations(self, link: int) -> list[Scalar]:
        """Return their second derivatives."""
        return [ops.scalar(self._acceleration(name)) for name in self.deforming(link)]

    def deforming(self, link: int) -> tuple[str, ...]:
        """Return the names of these coordinates."""
        item = self.tree.links[link]
        body = item.station.flexibility if item.station else item.flexibility
        return () if body is None else body.coordinates

    def link_motions(self, link: int) -> list[tuple[str, Axes]]:
        """Return the coordinates that move a link on its parent, with axes in the link's axes."""
        item = self.tree.links[link]
        if item.joint is not None:
            return [(item.joint.name, self.link_axes(link))]
        if item.station is None:
            return []

        def build() -> list[tuple[str, Axes]]:
            found, turn = self.deflection(link), self.deflection(link).rotation.T
            return [
                (
                    name,
                    Axes(
                        found.angular.get(k),
                        turn @ found.linear[k] if k in found.linear else None,
                    ),
                )
                for k, name in enumerate(self.deforming(link))
                if k in found.angular or k in found.linear
            ]

        return self._once("motions", link, build)

    def grown(self, columns: Columns, link: int) -> tuple[Vec, Vec]:
        """Return Σ c_k q̇_k of columns c(q) over the coordinates of a deformation, and Σ ċ_k q̇_k."""
        rates = self.amplitude_rates(link)
        total = ops.vector(0.0, 0.0, 0.0)
        for k, vector in columns.items():
            total = total + vector * rates[k]
        places = ops.column(self.amplitudes(link))
        return total, ops.dense(ops.derivative(total, places, ops.column(rates)))

    def point_motion(self, link: int) -> tuple[tuple[Vec, Vec], tuple[Vec, Vec]]:
        """Return velocity and its growth of a station's point, and angular velocity and its own."""

        def build() -> tuple[tuple[Vec, Vec], tuple[Vec, Vec]]:
            found = self.deflection(link)
            return self.grown(found.linear, link), self.grown(found.angular, link)

        return self._once("point motion", link, build)

    def accelerated(self, columns: Columns, link: int) -> Vec:
        """Return Σ c_k q̈_k of columns over the coordinates of a deformation."""
        total = ops.vector(0.0, 0.0, 0.0)
        for k, value in enumerate(self.amplitude_accelerations(link)):
            if k in columns and not value.is_zero():
                total = total + columns[k] * value
        return total

    def slice_turns(self, link: int) -> list[tuple[Vec, Vec]]:
        """Return relative angular velocity and its growth of these points, in their axes."""
        return self._once(
            "slice turn", link, lambda: [self.grown(s.angular, link) for s in self.slices(link)]
        )

    def slice_motions(self, link: int) -> list[tuple[Vec, Vec]]:
        """Return ṗ and p̈ at zero q̈ of the points that carry the mass of a deformable body."""

        def build() -> list[tuple[Vec, Vec]]:
            body, rates = self.tree.links[link].flexibility, self.amplitude_rates(link)
            known = None if body is None else body.growths(self.amplitudes(link), rates)
            if known is None:
                return [self.grown(item.linear, link) for item in self.slices(link)]
            found = []
            for item, growth in zip(self.slices(link), known, strict=True):
                moving = ops.vector(0.0, 0.0, 0.0)
                for k, column in item.linear.items():
                    moving = moving + column * rates[k]
                found.append((moving, growth))
            return found

        return self._once("slice motion", link, build)
