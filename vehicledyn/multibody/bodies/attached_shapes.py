"""Shapes of a beam that loads at some places give their kinks: static correction or attachment.

A force across the beam gives its shear force a jump, a torque that of the torque in a section.
Polynomials follow these slowly. With a truncated power (ξ - a)₊³ for bending and (ξ - a)₊ for twist
and stretch beside them, shapes span the static deflection under loads at ξ = a (Craig, Chang 1977,
AIAA Paper 77-405; "attachment modes").
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.multibody.bodies.beam_shapes import (
    Shapes,
    TruncatedPowers,
    assumed_shapes,
    clamped_polynomials,
    quadrature,
)

_DEPENDENT = 1e-8
"""Part of a shape that the others must leave of it."""
_STIFFEST = 1e10
"""Stiffness of the stiffest shape over the softest, beyond which rounding of it spoils the latter.

The bending of the part beyond a kink near the end is as stiff as its length to the power of -4.
"""


@lru_cache(maxsize=64)
def attached_shapes(count: int, order: int, places: tuple[float, ...]) -> Shapes:
    """Return shapes that are clamped at ξ = 0, of polynomials and a kink at each place.

    Where there are no more shapes than places inside the beam, they are polynomials.

    Parameters
    ----------
    count
        Number of shapes, kinks among them.
    order
        Order of the derivative whose square is the strain energy.
    places
        Where loads act, over the length.

    Raises
    ------
    InputError
        If places are too near to each other or to an end.
    """
    inside = tuple(sorted({place for place in places if 0.0 < place < 1.0}))
    plain = count - len(inside)
    if not inside or plain < 1:
        return assumed_shapes(count, order)
    polynomials = clamped_polynomials(plain, order)
    nothing = np.zeros((len(polynomials), len(inside)))
    shares = np.hstack([np.zeros((len(inside), plain)), np.eye(len(inside))])
    kinks = TruncatedPowers(np.array(inside), 2 * order - 1, shares)
    bare = Shapes(np.hstack([polynomials, nothing]), np.zeros(count), 0, kinks=kinks)
    nodes, weights = quadrature(plain + order + 1, inside)
    root = np.sqrt(weights)[:, None]
    _, mixed = np.linalg.qr(root * bare.at(nodes))
    left = np.abs(np.diag(mixed)) / np.linalg.norm(mixed, axis=0)
    if left[plain:].min() < _DEPENDENT:
        raise _too_near(inside[int(np.argmin(left[plain:]))])
    separate = np.linalg.inv(mixed)
    bent = root * (bare.at(nodes, order) @ separate)
    stiffness, vectors = np.linalg.eigh(bent.T @ bent)
    if stiffness[0] * _STIFFEST < stiffness[-1]:
        raise _too_near(inside[-1])
    turned = separate @ vectors
    turned = turned * np.sign(bare.values(1.0) @ turned)
    return replace(bare.mixed(turned), stiffness=stiffness, points=plain + order, slopes=count + 1)


def _too_near(place: float) -> InputError:
    return InputError(
        f"frames: {place:g} is too near to an end or to another frame for a shape of its own; "
        "move it, leave it out or take another 'basis'"
    )
