"""Inertia integrals of a deformed structure, from its mass matrix and its modes.

A point stands at p = x + Σ φ_k q_k. All inertia of such a body, of any attitude and deformation,
follows from the products ∫ f g dm of the functions 1, x, y, z and the components of the φ_k: mass,
static moments, inertia tensor to second order in q, and the couplings of rotation and deformation
(Shabana 2013, Dynamics of Multibody Systems, chapter 5; Wallrapp 1994, Mech. Struct. Mach. 22(3)).
The mass of a displacement is the mean of those along x, y and z in the mass matrix, which are equal
in solids. What a mass matrix holds beyond it at zero deformation, such as rotary inertia of nodes
and of the sections of beams, is a constant matrix of the angular velocity and the amplitudes'
rates: linear vibrations are those of the matrices exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.finite_elements.model import rigid_motions
from vehicledyn.multibody.bodies.finite_elements.reduction import ComponentModes

Array = NDArray[np.float64]
_ROUNDING = 1e-13
_UNLIKE = 1e-12
_FIRST = 4
"""Place of the first component of a mode among the functions 1, x, y, z, φ_1x, φ_1y, ..."""


@dataclass(frozen=True, eq=False)
class InertiaIntegrals:
    """Products of the functions 1, x, y, z, φ_1x, φ_1y, φ_1z, φ_2x, ... over the mass.

    Parameters
    ----------
    products
        ∫ f g dm, shape (4 + 3 n, 4 + 3 n) [kg, kg m, ...].
    turning
        What the kinetic energy ½ (ω, q̇)ᵀ T (ω, q̇) has beyond that, shape (3 + n, 3 + n).
    second
        ∫ f Ψ_kl dm of 1, x, y and z with the second derivatives Ψ_kl of the displacements, which
        are those of geometric stiffening, shape (n, n, 4, 3); None without.
    """

    products: Array
    turning: Array
    second: Array | None = None

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return float(self.products[0, 0])

    @property
    def count(self) -> int:
        """Number of modes."""
        return (len(self.products) - _FIRST) // 3

    def lowest(self, count: int) -> InertiaIntegrals:
        """Return the integrals with the first modes alone."""
        size, turned = _FIRST + 3 * count, 3 + count
        second = None if self.second is None else self.second[:count, :count]
        return InertiaIntegrals(self.products[:size, :size], self.turning[:turned, :turned], second)

    @property
    def are_of_points(self) -> bool:
        """Whether points of positive mass have the products.

        Data that take the inertia of sections for that of points may have some that none have.
        """
        sizes = np.linalg.eigvalsh(self.products)
        return bool(sizes[0] > -_UNLIKE * sizes[-1])

    @cached_property
    def points(self) -> Array:
        """Values of the functions at points of equal mass that have the same integrals.

        Shape (n_points, 4 + 3 n), the first column ones: with the products C about the centre of
        mass, C = B Bᵀ, and any orthogonal Q whose first row is constant, (centre | B) Q has them.
        """
        centre = self.products[0] / self.mass
        sizes, vectors = np.linalg.eigh(self.products - self.mass * np.outer(centre, centre))
        found = sizes > _ROUNDING * sizes[-1]
        roots = vectors[:, found] * np.sqrt(sizes[found])
        whole = np.column_stack([np.sqrt(self.mass) * centre, roots])
        count = whole.shape[1]
        values: Array = (whole @ _cosines(count)).T * np.sqrt(count / self.mass)
        values[:, 0] = 1.0
        return values


def inertia_integrals(modes: ComponentModes) -> InertiaIntegrals:
    """Return the integrals of a structure with its modes, about the frame of the body."""
    model, count = modes.model, modes.shapes.shape[1]
    rows, places = model.translations, model.places - modes.origin
    own = [modes.shapes[rows[:, axis], k] for k in range(count) for axis in range(3)]
    functions = np.column_stack([np.ones(len(places)), places, *own])
    products = np.zeros((functions.shape[1],) * 2)
    for axis in range(3):
        part = model.mass[rows[:, axis]][:, rows[:, axis]]
        products += functions.T @ (part @ functions) / 3.0
    node_of = [model.index[int(n)] for n in model.rows[:, 0]]
    motions = np.column_stack([rigid_motions(places[node_of], model.rows), modes.shapes])
    exact = motions.T @ (model.mass @ motions)
    products = _shifted(products, _first_moments(exact))
    return InertiaIntegrals(products, beyond(exact[3:, 3:], products))


def beyond(exact: Array, products: Array) -> Array:
    """Return what a matrix of (ω, q̇) without deformation holds beyond the products."""
    turning = exact - at_rest(products)
    turning[np.abs(turning) < _ROUNDING * np.sqrt(_sizes(exact))] = 0.0
    return np.asarray(0.5 * (turning + turning.T))


def _first_moments(exact: Array) -> Array:
    """Return ∫ f dm from the mass matrix of rigid motions and modes."""
    mass = np.trace(exact[:3, :3]) / 3.0
    # A rotation about x moves y by -z and z by y, and so on: each moment stands there twice.
    moments = [
        0.5 * (exact[(k + 2) % 3, 3 + (k + 1) % 3] * -1.0 + exact[(k + 1) % 3, 3 + (k + 2) % 3])
        for k in range(3)
    ]
    return np.array([mass, *moments, *exact[:3, 6:].T.ravel()])


def _shifted(products: Array, moments: Array) -> Array:
    """Return the products of functions that constants are added to, so that ∫ f dm are given."""
    shift = (moments - products[0]) / products[0, 0]
    shift[0] = 0.0
    found = products + np.outer(shift, products[0]) + np.outer(products[0], shift)
    return np.asarray(found + products[0, 0] * np.outer(shift, shift))


def at_rest(products: Array) -> Array:
    """Return the matrix of (ω, q̇) in the kinetic energy without deformation."""
    count = (len(products) - _FIRST) // 3
    moved = np.zeros((3, 3 + count, len(products)))
    for axis, (first, second) in enumerate(((1, 2), (2, 0), (0, 1))):
        # ω × x: a rotation about an axis moves the next one along the one after.
        moved[second, axis, 1 + first] += 1.0
        moved[first, axis, 1 + second] -= 1.0
    for k in range(count):
        for axis in range(3):
            moved[axis, 3 + k, _FIRST + 3 * k + axis] = 1.0
    return np.asarray(sum(part @ products @ part.T for part in moved))


def _sizes(matrix: Array) -> Array:
    diagonal = np.abs(np.diag(matrix))
    return np.outer(diagonal, diagonal)


def _cosines(count: int) -> Array:
    """Return the orthogonal matrix of the discrete cosine transform, its first row constant."""
    k, j = np.arange(count)[:, None], np.arange(count)[None, :]
    found = np.sqrt(2.0 / count) * np.cos(np.pi * (j + 0.5) * k / count)
    found[0] = 1.0 / np.sqrt(count)
    return np.asarray(found)
