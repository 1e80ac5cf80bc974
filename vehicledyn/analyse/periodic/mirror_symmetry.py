"""Motions whose second half is the mirror image of the first, as that of a vehicle that hunts.

Where equations look the same in a mirror S, which turns signs of states and exchanges those of the
left and the right, f(S x) = S f(x), many an orbit is its own image half a period later:

    x(t + T/2) = S x(t)

It is closed by half of its motion, P = S φ_T/2, of which the whole one is the square. So are its
multipliers: that -1 of P, where orbits that are not their own image branch off, is 1 as well, but
orbits that are meet nothing singular there.

References
----------
Swift, Wiesenfeld (1984), Suppression of period doubling in symmetric systems,
Phys. Rev. Lett. 52(9), 705-708.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector

_LOOKS, _BESIDE = 32, 0.1
"""Points of an orbit at which a mirror is looked for, and how far beside them, part of the scales,
it is tried."""

_STILL, _ALIKE, _HOLDS = 1e-9, 1e-4, 1e-6
"""Parts of the scales by which a state may change in half a period and count as still, and miss
its image; part of the rates by which these may miss theirs."""

_SMALL = 1e-3
"""Part of the largest rate that counts as the size of each."""

_SIGNS = 1.0, -1.0


class BrokenMirrorError(NumericalError):
    """Equations that looked the same in a mirror do not on an orbit farther along the branch."""


@dataclass(frozen=True, eq=False)
class Mirror:
    """The map (S x)_i = factor_i x_order_i, its own inverse."""

    order: NDArray[np.intp]
    factors: Vector

    def equals(self, other: Mirror | None) -> bool:
        """Return whether another mirror is the same map."""
        return other is not None and all(
            np.array_equal(own, its)
            for own, its in ((self.order, other.order), (self.factors, other.factors))
        )

    def scaled(self, scales: Vector) -> Mirror:
        """Return the same for states that count in sizes, shape (n,)."""
        return Mirror(self.order, self.factors * scales[self.order] / scales)

    def image(self, states: Vector) -> Vector:
        """Return the images of states (..., n)."""
        return np.asarray(states[..., self.order] * self.factors)

    def rows(self, maps: Vector) -> Vector:
        """Return S M of maps M (..., n, m)."""
        return np.asarray(maps[..., self.order, :] * self.factors[:, None])

    def completed(self, half: Vector) -> Vector:
        """Return the states (2 count, n) of an orbit from the first half of them."""
        return np.concatenate([half, self.image(half)])

    def holds(
        self, field: AutonomousField, states: Vector, value: float, *, scales: Vector
    ) -> bool:
        """Return whether the rates at the images of states (count, n) are those of the rates.

        Of one that is small against others, in their scales, it is asked for in their size.
        """
        none = np.zeros((len(states), 0))
        rates, of_images = (
            field.evaluate(own, none, value).rates for own in (states, self.image(states))
        )
        sizes = np.abs(rates).max(axis=0)
        sizes = np.maximum(sizes, _SMALL * (sizes / scales).max() * scales)
        sizes = np.maximum(sizes, sizes[self.order])
        return bool((np.abs(of_images - self.image(rates)) <= _HOLDS * sizes).all())


def mirrored_mesh(mesh: Vector) -> Vector:
    """Return a mesh near another whose second half repeats the first; its number is even."""
    count = len(mesh) - 1
    even = np.interp(np.linspace(0.0, count, count + count % 2 + 1), np.arange(count + 1), mesh)
    middle = len(even) // 2
    half = 0.5 * even[: middle + 1] / even[middle]
    return np.concatenate([half[:-1], 0.5 + half])


def mirror_of(field: AutonomousField, orbit: Orbit, values: Sequence[float]) -> Mirror | None:
    """Return the mirror in which the second half of an orbit is the image of the first.

    None where it is not, or where the equations do not look the same in it, at the orbit and
    beside it, for some values of the parameter.

    Parameters
    ----------
    field
        The equations, without unknowns.
    orbit
        The orbit, or the small oscillation in which it begins.
    values
        Values of the parameter.
    """
    states, _ = orbit.sample(np.arange(_LOOKS) / _LOOKS)
    scales = orbit.scales()
    beside = np.random.default_rng(0).uniform(-_BESIDE, _BESIDE, states.shape)
    tried = np.concatenate([states, states + beside * scales])
    for is_exchanged in (False, True):
        mirror = _images(states / scales, is_exchanged=is_exchanged)
        if mirror is None:
            continue
        with suppress(NumericalError):
            if all(mirror.holds(field, tried, value, scales=scales) for value in values):
                return mirror
    return None


def _images(states: Vector, *, is_exchanged: bool) -> Mirror | None:
    """Return what leads from scaled states (count, n) to those half a period later.

    Of a small oscillation each state has its own opposite then, but also that of the other side,
    which is preferred where states shall be exchanged.
    """
    count, n = states.shape
    later = np.roll(states, -(count // 2), axis=0)
    order, factors = np.arange(n), np.ones(n)
    for k in range(n):
        missed = np.stack([np.abs(later[:, k, None] - sign * states) for sign in _SIGNS])
        missed = missed.max(axis=1)
        if missed[0, k] <= _STILL:
            continue
        others = np.where(np.arange(n) == k, np.inf, missed)
        for own in (others, missed) if is_exchanged else (missed[:, [k]], others):
            sign, j = np.unravel_index(np.argmin(own), own.shape)
            if own[sign, j] <= _ALIKE:
                order[k], factors[k] = k if own.shape[1] == 1 else j, _SIGNS[sign]
                break
        else:
            return None
    is_inverse = (order[order] == np.arange(n)).all() and (factors[order] == factors).all()
    return Mirror(order, factors) if is_inverse else None
