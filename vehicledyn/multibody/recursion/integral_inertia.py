"""Inertia of a deformable body whose displacements are linear in some amplitudes, by integrals.

A point stands at p = x + Σ φ_k a_k and accelerates by a + β p + 2 ω × ṗ + Σ φ_k ä_k. Force, torque
and forces on the amplitudes are sums of products ∫ f g dm of the functions 1, x, y, z and the
components of the φ_k, which are taken once: about a dozen operations for each pair of amplitudes,
however many points the body has (Shabana 2013, Dynamics of Multibody Systems, chapter 5).

The first amplitudes are the coordinates; others follow them, with derivatives that are a factor or
two times numbers each. What acts on these acts on the coordinates through the derivatives.

Where displacements have terms of second order, ½ Σ Ψ_kl q_k q_l, products of 1, x, y and z with the
Ψ_kl are added, ∂p/∂q_k is φ_k + Σ Ψ_kl q_l, and products of Ψ with φ and Ψ, of higher order, are
left out; nothing follows the coordinates then.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.model.deformation import Integrals, TiedAmplitude
from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.recursion.deformed_inertia import DeformedInertia
from vehicledyn.multibody.recursion.inertia import Inertia
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec
from vehicledyn.symbolic.weighted_sums import weighted_sum

Array = NDArray[np.float64]
_NEGLIGIBLE = 1e-13
"""Product over the root of those of its functions with themselves that is rounding."""


@dataclass(frozen=True)
class IntegralInertia(DeformedInertia):
    """Inertia of a body by its inertia integrals."""

    @cached_property
    def _integrals(self) -> Integrals:
        found = self.body.products
        if found is None:
            raise ValueError("the displacements of the body are not linear in amplitudes")
        return found

    @cached_property
    def _products(self) -> Array:
        found = self._integrals.products
        sizes = np.sqrt(np.abs(np.diag(found)))
        return np.where(np.abs(found) > _NEGLIGIBLE * np.outer(sizes, sizes), found, 0.0)

    @cached_property
    def _followers(self) -> list[TiedAmplitude]:
        k, link = self.kinematics, self.link
        return self.body.followers(k.amplitudes(link), k.amplitude_rates(link))

    @cached_property
    def _factors(self) -> list[tuple[int, Scalar]]:
        """Factors of all followers, each with the amplitude it belongs to."""
        n = len(self.body.coordinates)
        return [(k, factor) for k, f in enumerate(self._followers, n) for factor in f.factors]

    @cached_property
    def _shares(self) -> Array:
        """Derivatives of the followers over their factors, shape (factors, coordinates)."""
        found = [item.shares for item in self._followers]
        return np.vstack([np.zeros((0, len(self.body.coordinates))), *found])

    @cached_property
    def _amplitudes(self) -> list[Scalar]:
        """Length of the places, then all amplitudes."""
        followers = [item.value for item in self._followers]
        return [self._integrals.length, *self.kinematics.amplitudes(self.link), *followers]

    @cached_property
    def _rates(self) -> list[Scalar]:
        return [*self.kinematics.amplitude_rates(self.link), *(f.rate for f in self._followers)]

    @cached_property
    def _accelerations(self) -> list[Scalar]:
        own = self.kinematics.amplitude_accelerations(self.link)
        found = [
            f.growth + _sum_of(f.factors, [weighted_sum(row, own) for row in f.shares])
            for f in self._followers
        ]
        return [*own, *found]

    @property
    def _count(self) -> range:
        return range(len(self.body.coordinates) + len(self._followers))

    def _on_coordinates(self, loads: Sequence[Scalar]) -> list[Scalar]:
        """Return what loads on all amplitudes are on the coordinates."""
        n = len(self.body.coordinates)
        passed = [factor * loads[k] for k, factor in self._factors]
        return [loads[k] + weighted_sum(self._shares[:, k], passed) for k in range(n)]

    def _block(self, row: int, column: int) -> Array:
        """Return ∫ f gᵀ dm of vectors of functions: x for -1, φ_k for k; shape (3, 3)."""
        first, second = (4 + 3 * k if k >= 0 else 1 for k in (row, column))
        return self._products[first : first + 3, second : second + 3]

    def _first(self, k: int) -> Array:
        """Return ∫ φ_k dm, or ∫ x dm for -1; x is a place over the length."""
        start = 4 + 3 * k if k >= 0 else 1
        return self._products[0, start : start + 3]

    @cached_property
    def _second_order(self) -> Array | None:
        found = self.body.second_order
        if found is None:
            return None
        return np.where(np.abs(found) > _NEGLIGIBLE * np.abs(found).max(), found, 0.0)

    @cached_property
    def _grown(self) -> list[list[list[Scalar]]] | None:
        """Σ ∫ f Ψ_kl dm q_l of each mode k, by the functions 1, x, y, z and the axis."""
        second = self._second_order
        if second is None:
            return None
        return [
            [
                [weighted_sum(second[k, :, f, i], self._amplitudes[1:]) for i in range(3)]
                for f in range(4)
            ]
            for k in self._count
        ]

    @cached_property
    def _pushed(self) -> list[Vec]:
        """∫ ∂p/∂q_k dm of each mode."""
        found = [ops.vector(*self._first(k)) for k in self._count]
        if self._grown is None:
            return found
        return [
            first + ops.vector(*grown[0]) for first, grown in zip(found, self._grown, strict=True)
        ]

    @cached_property
    def _moment(self) -> Vec:
        """∫ p dm."""
        found = ops.vector(
            *(
                weighted_sum([self._first(k)[i] for k in (-1, *self._count)], self._amplitudes)
                for i in range(3)
            )
        )
        for grown, q in zip(self._grown or (), self._amplitudes[1:], strict=False):
            found = found + 0.5 * q * ops.vector(*grown[0])
        return found

    def _moved(self, factors: Sequence[Scalar]) -> Vec:
        """Return Σ ∫ ∂p/∂q_k dm times a factor each."""
        if self._grown is None:
            return ops.vector(
                *(weighted_sum([self._first(k)[i] for k in self._count], factors) for i in range(3))
            )
        found = ops.vector(0.0, 0.0, 0.0)
        for pushed, factor in zip(self._pushed, factors, strict=True):
            found = found + factor * pushed
        return found

    def _growth(self, rates: Sequence[Scalar]) -> tuple[Vec, Vec]:
        """Return ∫ p̈ dm and ∫ x × p̈ dm at zero q̈."""
        force = torque = ops.vector(0.0, 0.0, 0.0)
        second = self._second_order
        if second is not None:
            for k, rate in enumerate(rates):
                rows = [
                    [weighted_sum(second[k, :, f, i], rates) for i in range(3)] for f in range(4)
                ]
                force = force + rate * ops.vector(*rows[0])
                torque = torque + rate * _axial(rows[1:])
        return force, torque

    @cached_property
    def _with(self) -> list[list[list[Scalar]]]:
        """∫ p ∂p/∂q_kᵀ dm of each mode, entries by row and column."""
        if self._grown is None:
            return self._straight
        return [
            [[own[i][j] + grown[1 + i][j] for j in range(3)] for i in range(3)]
            for own, grown in zip(self._straight, self._grown, strict=True)
        ]

    @cached_property
    def _straight(self) -> list[list[list[Scalar]]]:
        """∫ (x + Σ φ_l a_l) φ_kᵀ dm of each amplitude, entries by row and column."""
        found = []
        for k in self._count:
            blocks = [self._block(other, k) for other in (-1, *self._count)]
            found.append(
                [
                    [weighted_sum([b[i, j] for b in blocks], self._amplitudes) for j in range(3)]
                    for i in range(3)
                ]
            )
        return found

    @cached_property
    def _second(self) -> Mat:
        """∫ p pᵀ dm = ∫ p xᵀ dm + Σ a_k ∫ p φ_kᵀ dm, and ½ Σ q_k q_l ∫ (x Ψ_klᵀ + Ψ_kl xᵀ) dm."""
        factors, length = self._amplitudes, self._integrals.length
        rows: list[list[Scalar]] = []
        for i in range(3):
            row: list[Scalar] = []
            for j in range(3):
                if j < i:
                    row.append(rows[j][i])
                    continue
                still = weighted_sum(
                    [self._block(k, -1)[i, j] for k in (-1, *self._count)], factors
                )
                total = still * length
                for k in self._count:
                    total = total + self._straight[k][i][j] * factors[1 + k]
                    if self._grown is not None:
                        own = self._grown[k]
                        total = total + 0.5 * factors[1 + k] * (own[1 + i][j] + own[1 + j][i])
                row.append(total)
            rows.append(row)
        return rotations.matrix(rows)

    @cached_property
    def _points(self) -> Mat:
        """Inertia of the points about the origin, with the deformation frozen."""
        p = self._second
        about = (p[1, 1] + p[2, 2], p[0, 0] + p[2, 2], p[0, 0] + p[1, 1])
        return rotations.symmetric(about, [-p[0, 1], -p[0, 2], -p[1, 2]])

    @cached_property
    def rigid(self) -> Inertia:
        """Inertia with the deformation frozen."""
        more, scale = self.body.turning.entry, self._integrals.scale
        own = rotations.matrix([[more(i, j) for j in range(3)] for i in range(3)])
        return Inertia(ops.scalar(self.body.mass), scale * self._moment, scale * self._points + own)

    def unit_wrench(self, k: int) -> JointWrench:
        """Return what the frame must transmit for a unit acceleration of a coordinate."""
        own = ops.vector(*(self.body.turning.entry(i, 3 + k) for i in range(3)))
        force, torque = self._pushed[k], _axial(self._with[k])
        for share, (more, twist) in zip(self._shares[:, k], self._followed, strict=True):
            if share:
                force, torque = force + float(share) * more, torque + float(share) * twist
        scale = self._integrals.scale
        return JointWrench(scale * force, scale * torque + own)

    @cached_property
    def _followed(self) -> list[tuple[Vec, Vec]]:
        """Force and torque that a unit share in each factor needs."""
        return [
            (factor * ops.vector(*self._first(k)), factor * _axial(self._with[k]))
            for k, factor in self._factors
        ]

    def _product(self, k: int, other: int) -> float:
        """Return ∫ φ_k φ_other dm of two amplitudes, zero for one that is rounding."""
        found = float(np.trace(self._block(k, other)))
        size = np.sqrt(np.trace(self._block(k, k)) * np.trace(self._block(other, other)))
        return found if abs(found) > _NEGLIGIBLE * size else 0.0

    @cached_property
    def _coupled(self) -> list[list[Scalar]]:
        """Force on each follower, times a factor, for a unit acceleration of a coordinate."""
        n, factors = len(self.body.coordinates), self._factors
        between = [[f * self._product(i, j) * g for j, g in factors] for i, f in factors]
        return [
            [weighted_sum(self._shares[:, k], row) + f * self._product(i, k) for k in range(n)]
            for (i, f), row in zip(factors, between, strict=True)
        ]

    def entry(self, k: int, other: int) -> Scalar:
        """Return the entry of the mass matrix between two coordinates of the deformation."""
        total = ops.scalar(self._product(k, other))
        total = total + weighted_sum(self._shares[:, k], [row[other] for row in self._coupled])
        direct = [factor * self._product(k, i) for i, factor in self._factors]
        total = total + weighted_sum(self._shares[:, other], direct)
        return self._integrals.scale * total + self.body.turning.entry(3 + k, 3 + other)

    @cached_property
    def wrench(self) -> tuple[Vec, Vec]:
        """Force and torque about the origin that the motion needs [N, N m]."""
        k, link, scale = self.kinematics, self.link, self._integrals.scale
        base, beta, omega = k.link_acceleration(link), k.beta(link), k.link_angular_velocity(link)
        rates, second = self._rates, self._accelerations
        force = beta @ self._moment
        force = force + 2.0 * ops.cross(omega, self._moved(rates)) + self._moved(second)
        grown = self._growth(rates)
        force = force + grown[0]
        moving = [
            [_sum_of([w[i][j] for w in self._with], rates) for j in range(3)] for i in range(3)
        ]
        spun = self._points @ k.link_angular_acceleration(link)
        torque = ops.cross(self._moment, base) + spun
        torque = torque + ops.cross(omega, self._points @ omega)
        # 2 ∫ p × (ω × ṗ) dm = 2 (tr(R) ω - Rᵀ ω) with R = ∫ p ṗᵀ dm.
        trace = moving[0][0] + moving[1][1] + moving[2][2]
        torque = torque + 2.0 * (trace * omega - rotations.matrix(moving).T @ omega)
        for index, value in enumerate(second):
            if not ops.scalar(value).is_zero():
                torque = torque + value * _axial(self._with[index])
        torque = scale * (torque + grown[1]) + self.turning_torque
        return self.body.mass * base + scale * force, torque

    def energies(self, gravity: Vec) -> tuple[Scalar, Scalar]:
        """Return kinetic energy and potential energy in the gravity field [J]."""
        k, link, rigid = self.kinematics, self.link, self.rigid
        omega, base, rates = (
            k.link_angular_velocity(link),
            k.link_velocity(link),
            k.amplitude_rates(link),
        )
        kinetic = 0.5 * self.body.mass * ops.dot(base, base)
        kinetic = kinetic + ops.dot(base, ops.cross(omega, rigid.moment))
        kinetic = kinetic + 0.5 * ops.dot(omega, rigid.matrix @ omega)
        for index, rate in enumerate(rates):
            unit = self.unit_wrench(index)
            kinetic = kinetic + rate * (ops.dot(base, unit.force) + ops.dot(omega, unit.torque))
            for other, factor in enumerate(rates):
                kinetic = kinetic + 0.5 * rate * factor * self.entry(index, other)
        centre = k.position_in(-1, link, (1.0 / self.body.mass) * rigid.moment)
        return kinetic, -self.body.mass * ops.dot(gravity, centre)

    def forces(self) -> list[Scalar]:
        """Return the force on each coordinate of the deformation that the motion needs."""
        kinematics, link, spun = self.kinematics, self.link, self.spun
        base, beta = kinematics.link_acceleration(link), kinematics.beta(link)
        omega = kinematics.link_angular_velocity(link)
        loads = []
        for k in self._count:
            total = ops.scalar(weighted_sum(self._first(k), [base[i] for i in range(3)]))
            if self._grown is not None:
                total = total + _sum_of(self._grown[k][0], [base[i] for i in range(3)])
            for i in range(3):
                for j in range(3):
                    total = total + beta[j, i] * self._with[k][i][j]
            crossed = [_crossed(self._block(other, k)) for other in self._count]
            for i in range(3):
                total = total + 2.0 * omega[i] * weighted_sum([c[i] for c in crossed], self._rates)
            own = [float(np.trace(self._block(k, other))) for other in self._count]
            for factor, value in zip(own, self._accelerations, strict=True):
                if not ops.scalar(value).is_zero():
                    total = total + factor * value
            loads.append(total)
        return [
            self._integrals.scale * load + self.body.turning.product(3 + k, spun)
            for k, load in enumerate(self._on_coordinates(loads))
        ]


def _crossed(block: Array) -> Array:
    """Return ∫ f × g dm from ∫ f gᵀ dm."""
    return np.array(
        [block[1, 2] - block[2, 1], block[2, 0] - block[0, 2], block[0, 1] - block[1, 0]]
    )


def _axial(rows: Sequence[Sequence[Scalar]]) -> Vec:
    """Return the same of entries that may be symbols."""
    return ops.vector(rows[1][2] - rows[2][1], rows[2][0] - rows[0][2], rows[0][1] - rows[1][0])


def _sum_of(values: Sequence[Scalar], factors: Sequence[Scalar]) -> Scalar:
    total = ops.scalar(0.0)
    for value, factor in zip(values, factors, strict=True):
        total = total + value * factor
    return total
