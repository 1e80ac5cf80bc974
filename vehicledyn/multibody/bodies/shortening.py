"""How a bent axis shortens, by its slopes at a few places.

A point at ξ is drawn back by u = -L ∫ (1 - √(1 - e)) dξ from 0 to ξ, where e = v'² + w'² is the
square of the slope, to its sixth power: 1 - √(1 - e) = e/2 + e²/8 + e³/16. The slopes are known at
some places and what they shorten by is integrated as the polynomial through these. The places are
those of a Gauss quadrature, of Radau's with a place at the clamped end, where the slope is zero:
∫ u dξ and ∫ ξ u dξ are exact for e/2 of polynomials, and with them what axial and centrifugal
forces do to bending. In place of all pairs of shapes there are then as many slopes as shapes, and
one or a few more.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.beam_shapes import Shapes, quadrature
from vehicledyn.multibody.model.deformation import TiedAmplitude
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.weighted_sums import weighted_sum

Array = NDArray[np.float64]
SERIES = (0.5, 0.125, 0.0625)
"""1 - √(1 - e) by powers of e."""
_FLAT = 1e-9
"""Slope at the start, over the largest, of shapes that are clamped there."""
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Shortening:
    """The shortening by the shapes of one or both planes of bending.

    ``ranges`` are the coordinates of each plane among ``count`` ones.
    """

    shapes: Mapping[str, Shapes]
    ranges: Mapping[str, range]
    count: int

    @cached_property
    def _nodes(self) -> tuple[Array, bool]:
        """Places of the slopes, and whether the start, which has none, is one more."""
        start, end = (
            max(np.abs(own.values(x, 1)).max() for own in self.shapes.values()) for x in (0.0, 1.0)
        )
        if start > _FLAT * end:
            return quadrature(max(own.points for own in self.shapes.values()))[0], False
        degree = max(own.slopes or own.points - 1 for own in self.shapes.values())
        found = legendre.legroots([0.0] * degree + [1.0, 1.0])
        return 0.5 * (1.0 + np.sort(found.real)[1:]), True

    @cached_property
    def places(self) -> tuple[Array, Array]:
        """Places of the slopes and the weights of a quadrature of what vanishes without slope."""
        return self._nodes[0], self.reach(np.ones(1))[0]

    @cached_property
    def slopes(self) -> dict[str, Array]:
        """φ_k' of each plane at the places, shape (places, shapes)."""
        made = {}
        for plane, own in self.shapes.items():
            found = own.at(self._nodes[0], 1)
            kept = np.abs(found) > _ROUNDING * np.abs(found).max()
            made[plane] = np.asarray(np.where(kept, found, 0.0), dtype=np.float64)
        return made

    def reach(self, ends: Array) -> Array:
        """Return integrals up to each end of the polynomials that are one at a place each."""
        nodes, has_start = self._nodes
        known = np.concatenate([[0.0], nodes]) if has_start else nodes
        through = np.linalg.inv(legendre.legvander(2.0 * known - 1.0, len(known) - 1))
        summed = legendre.legint(through, scl=0.5, lbnd=-1.0)
        found = np.asarray(legendre.legval(2.0 * ends - 1.0, summed).T, dtype=np.float64)
        return found[:, 1:] if has_start else found

    def by_slopes(self, plane: str) -> tuple[Shapes, Array]:
        """Return shapes whose amplitudes are slopes at some of the places, and T of these, T q.

        The places are those that tell the shapes apart best.
        """
        from scipy.linalg import qr

        own = self.shapes[plane]
        _, _, order = qr(self.slopes[plane].T, mode="economic", pivoting=True)
        turned = self.slopes[plane][np.sort(order[: own.count])]
        return own.mixed(np.linalg.inv(turned)), turned

    def followers(
        self,
        q: Sequence[Scalar],
        rates: Sequence[Scalar],
        length: Scalar,
        series: Sequence[float] = SERIES,
    ) -> list[TiedAmplitude]:
        """Return -L (1 - √(1 - e)) of each place as amplitudes.

        Parameters
        ----------
        q, rates
            All coordinates of the beam and their rates.
        length
            L [m].
        series
            Factors of e, e² and e³.
        """
        first, second, third = series
        rows = {d: np.zeros((len(self._nodes[0]), self.count)) for d in self.shapes}
        for plane, own in rows.items():
            own[:, self.ranges[plane]] = self.slopes[plane]
        found = []
        for place in zip(*rows.values(), strict=True):
            leans = [weighted_sum(row, q) / length for row in place]
            turning = [weighted_sum(row, rates) for row in place]
            e, pace, swept = ops.scalar(0.0), ops.scalar(0.0), ops.scalar(0.0)
            for lean, own_rate in zip(leans, turning, strict=True):
                e, pace = e + lean * lean, pace + lean * own_rate
                swept = swept + own_rate * own_rate
            steeper = 2.0 * first + e * (4.0 * second + 6.0 * third * e)
            growing = 8.0 * second + 24.0 * third * e
            found.append(
                TiedAmplitude(
                    -length * e * (first + e * (second + third * e)),
                    [-steeper * lean for lean in leans],
                    np.array(place),
                    -steeper * pace,
                    -(steeper * swept + growing * pace * pace) / length,
                )
            )
        return found

    def drawn_back(self, place: float, q: Sequence[Scalar], length: Scalar) -> TiedAmplitude:
        """Return what a place is drawn back by; e/2 is integrated exactly."""
        size = self.count
        metric = np.zeros((size, size))
        for plane, own in self.shapes.items():
            metric[np.ix_(self.ranges[plane], self.ranges[plane])] = own.shortening(place)
        pulls = [weighted_sum(row, q) / length for row in metric]
        total, still = ops.scalar(0.0), [ops.scalar(0.0)] * size
        for pull, value in zip(pulls, q, strict=True):
            total = total - 0.5 * pull * value
        steep = self.followers(q, still, length, (0.0, *SERIES[1:]))
        return summed(
            [1.0, *self.reach(np.array([place]))[0]],
            [TiedAmplitude(total, [-p for p in pulls], np.eye(size), still[0], still[0]), *steep],
        )

    def drawn(self, place: float, length: Scalar) -> dict[str, Any]:
        """Return the same as plain data.

        It is qᵀ ``quadratic`` q and, with the slopes ``steep`` of each plane, shape
        (planes, places, coordinates), ``drawn_back`` times e²/8 + e³/16 of each place.
        """
        size = range(self.count)
        quadratic: list[list[Any]] = [[0.0 for _ in size] for _ in size]
        steep: list[list[list[Any]]] = []
        for plane, own in self.shapes.items():
            metric, items = own.shortening(place), self.ranges[plane]
            for j, k in enumerate(items):
                for i, other in enumerate(items):
                    quadratic[k][other] = -0.5 * float(metric[j, i]) / length
            rows: list[list[Any]] = []
            for slopes in self.slopes[plane]:
                row: list[Any] = [0.0 for _ in size]
                for j, k in enumerate(items):
                    row[k] = float(slopes[j]) / length
                rows.append(row)
            steep.append(rows)
        reach = [-float(share) * length for share in self.reach(np.array([place]))[0]]
        return {"quadratic": quadratic, "steep": steep, "drawn_back": reach}


def summed(weights: Sequence[float] | Array, followers: Sequence[TiedAmplitude]) -> TiedAmplitude:
    """Return a sum of followers times a weight each."""
    nothing = ops.scalar(0.0)
    value, rate, growth = nothing, nothing, nothing
    for weight, item in zip(weights, followers, strict=True):
        share = float(weight)
        value, rate = value + share * item.value, rate + share * item.rate
        growth = growth + share * item.growth
    factors = [
        float(w) * f for w, item in zip(weights, followers, strict=True) for f in item.factors
    ]
    return TiedAmplitude(value, factors, np.vstack([f.shares for f in followers]), rate, growth)


def inertia_products(
    shapes: Sequence[Shapes],
    axes: Sequence[int | None],
    reach: Array,
    points: tuple[Array, Array],
) -> Array:
    """Return the inertia integrals of a beam of unit mass and length.

    Parameters
    ----------
    shapes, axes
        Shapes of each direction, and the axis along which they displace points, if they do.
    reach
        What the followers displace the points by, along the first axis, shape (points, followers).
    points
        Places and weights of the quadrature.
    """
    x, weights = points
    columns = [np.array([np.ones_like(x), x, 0.0 * x, 0.0 * x])]
    for item, axis in zip(shapes, axes, strict=True):
        for values in item.at(x).T:
            columns.append(np.array([values if k == axis else 0.0 * x for k in range(3)]))
    columns += [np.array([values, 0.0 * x, 0.0 * x]) for values in reach.T]
    functions = np.vstack(columns)
    return np.asarray((functions * weights) @ functions.T)
