"""Polynomials of one mesh interval: values and slopes at Gauss points, integrals, differences.

Representation points are equidistant, i/m for i = 0..m; collocation points are those of Gauss
and Legendre, which make the orbit accurate to order 2m at the mesh points.

References
----------
de Boor, Swartz (1973), Collocation at Gaussian points, SIAM J. Numer. Anal. 10(4).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.kernel.engine import Vector


@dataclass(frozen=True)
class Basis:
    """Matrices of a degree m on the interval [0, 1].

    ``points`` (m,) and ``weights`` (m,) of Gauss; ``value`` and ``slope`` (m, m + 1) from
    representation to Gauss points; ``highest`` (m + 1,) gives the m-th derivative.
    """

    degree: int
    points: Vector
    weights: Vector
    value: Vector
    slope: Vector
    highest: Vector

    def values_at(self, places: Vector) -> Vector:
        """Return the matrix from representation points to places in [0, 1]."""
        return _lagrange(np.linspace(0.0, 1.0, self.degree + 1), places)

    def gauss_values_at(self, places: Vector) -> Vector:
        """Return the matrix from Gauss points to places in [0, 1]."""
        return _lagrange(self.points, places)


def basis(degree: int) -> Basis:
    """Return the matrices of a degree."""
    points, weights = np.polynomial.legendre.leggauss(degree)
    points, weights = 0.5 * (points + 1.0), 0.5 * weights
    nodes = np.linspace(0.0, 1.0, degree + 1)
    powers = np.vander(nodes, increasing=True)
    coefficients = np.linalg.inv(powers)  # column i: polynomial that is 1 at node i
    exponents = np.arange(1, degree + 1)
    slopes = np.zeros((degree, degree + 1))
    slopes[:, 1:] = exponents * points[:, None] ** (exponents - 1)
    return Basis(
        degree,
        points,
        weights,
        _lagrange(nodes, points),
        slopes @ coefficients,
        coefficients[degree] * float(np.prod(np.arange(1, degree + 1))),
    )


def _lagrange(nodes: Vector, places: Vector) -> Vector:
    """Return the values of the Lagrange polynomials, shape (n_places, n_nodes)."""
    count = len(nodes)
    values = np.ones((count, len(places)))
    for k in range(count - 1):
        others = nodes[k + (k >= np.arange(count))]  # the k-th node other than each
        factor = places - others[:, None]
        factor /= (nodes - others)[:, None]
        values *= factor
    return np.ascontiguousarray(values.T)
