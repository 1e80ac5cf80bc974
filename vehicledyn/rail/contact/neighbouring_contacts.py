"""Elastic contacts of one wheel beside each other: each sinks the surfaces of the others.

A force N on a half-space sinks its surface by N/(π E* d) at the distance d. What is left of the
approaches δ of contacts, each found as if it were alone, satisfies

    N_i = k_i (δ_i - Σ_j N_j/(π E* d_ij))^(3/2),

k_i from Hertz's theory. Where contact passes from the tread to the gauge corner this takes a fifth
of an approach, and all of it for a small contact beside a large one.

References
----------
Johnson (1985), Contact Mechanics, chapter 3: the displacement beside a concentrated force.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from vehicledyn.rail.contact.elastic_patch import ElasticPatch
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

APPROACH_FLOOR = 1e-12
"""Added to approaches that others are related to [m]."""

_STEPS = (0.6, 0.7, 1.0)  # parts of the steps taken; the first one overshoots
_WIDTHS = 0.125  # of δ/B of both contacts, in squares of distances
_ROUNDING = 0.02  # part of an approach over which it goes to none


def neighbours(alone: Sequence[ElasticPatch], modulus: Scalar) -> tuple[ElasticPatch, ...]:
    """Return contacts of one wheel, each pressed in less by what the others yield.

    A force N sinks the surfaces by N/(π E* d) at a distance d. What is left of the approaches
    satisfies N_i = k_i (δ_i - Σ_j N_j/(π E* d_ij))^(3/2); it is found by a fixed number of steps,
    the first of which overshoots and is taken in part. Distances have a part of the widths of the
    contacts added, as windows may share one.
    """
    if len(alone) == 1:
        return tuple(alone)
    inverse = {pair: _compliance(alone, pair, modulus) for pair in _pairs(len(alone))}
    forces = [patch.force for patch in alone]
    left: list[Scalar] = []
    for share in _STEPS:
        left = [
            _left(patch, sum(inverse[min(i, j), max(i, j)] * forces[j] for j in _others(i, alone)))
            for i, patch in enumerate(alone)
        ]
        forces = [
            (1.0 - share) * force + share * patch.contact.force(rest * patch.approach)
            for patch, force, rest in zip(alone, forces, left, strict=True)
        ]
    return tuple(
        replace(patch, approach=rest * patch.approach)
        for patch, rest in zip(alone, left, strict=True)
    )


def _pairs(count: int) -> list[tuple[int, int]]:
    return list(itertools.combinations(range(count), 2))


def _others(i: int, alone: Sequence[ElasticPatch]) -> list[int]:
    return [j for j in range(len(alone)) if j != i]


def _compliance(alone: Sequence[ElasticPatch], pair: tuple[int, int], modulus: Scalar) -> Scalar:
    """Return 1/(π E* d) of two contacts [m/N]."""
    one, other = (alone[k] for k in pair)
    apart = one.along - other.along
    square = apart * apart + _WIDTHS * (one.spread + other.spread)
    return 1.0 / (np.pi * modulus * ops.sqrt(square))


def _left(patch: ElasticPatch, sunk: Scalar) -> Scalar:
    """Return which part of an approach is left, smoothly down to none, 1 for a lifted wheel [1]."""
    rest = 1.0 - sunk / (patch.approach + APPROACH_FLOOR)
    whole = 1.0 + np.sqrt(1.0 + _ROUNDING * _ROUNDING)
    return (rest + ops.sqrt(rest * rest + _ROUNDING * _ROUNDING)) * (1.0 / whole)
