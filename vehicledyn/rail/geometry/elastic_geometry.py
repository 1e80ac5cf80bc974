"""Elastic contact at several places: patches from the interpenetration of wheel and rail.

Rigid contact leaps where profiles nearly conform; an elastic contact spreads there instead. A
wheel at a height below that of rigid contact interpenetrates its rail. Where and how strongly is
read from the overlap, as virtual penetration methods do, here through three moments only, so that
the same formulas can be written with symbols:

1. Normal overlap along the wheel's profile, p(y) = -f(y) cos γ(y), from the gap f of
   :mod:`vehicledyn.rail.geometry.contact_geometry` and the angle γ of the rail; l(y) is the length
   along the rail, dl = dy/cos γ.
2. A local minimum of f with largest overlap δ carries a patch. Deformation spreads: only where
   p > (1 - ε) δ, with ε = 0.55, do the bodies touch; two minima between which the overlap stays
   above the level of the deeper one are one patch.
3. With w = max(p - (1 - ε) δ, 0): S_0 = ∫ w dl, S_1 = ∫ w l dl, S_2 = ∫ w (l - l_0)² dl. The
   contact is at l_0 = S_1/S_0, and B = S_0 ε δ/(5 S_2) is its half sum of curvatures across: for
   w = ε δ - B l² both are exact.
4. Hertz's theory with A = cos γ/(2 r), B and the approach δ gives force and ellipse.
5. Each patch sinks the surfaces of the others by N/(π E* d) at the distance d, so that several
   carry less than each would alone; patches that nothing is left of are none.

A contact that moves quickly over a nearly conforming stretch thus moves as the middle of a patch
does, with a finite rate, and the force is continuous in all coordinates. Towards compiled
equations: on a grid fixed to the wheel all three moments are sums over places of the positive
part of a smooth function of the pose, so they have a continuous derivative but for the grid; the
heights z of both profiles come from uniform tables
(:class:`vehicledyn.rail.profiles.profile_pieces.QuinticTable`
with gathered coefficients). The largest overlap δ of a patch becomes a soft maximum, and the parts
of the grid that belong to tread, throat and flange are fixed windows in the place of minima.

References
----------
Kik, Piotrowski (1996), A fast, approximate method to calculate normal load at contact between
wheel and rail and creep forces during rolling: the share ε = 0.55 of the approach.
Ayasse, Chollet (2005), Determination of the wheel rail contact patch in semi-Hertzian
conditions, Vehicle System Dynamics 43(3), 161-172: replacing a patch by an ellipse.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.rail.geometry.contact_geometry import (
    MountedWheel,
    Pose,
    Rail,
    Silhouette,
    lowest_gap,
    silhouette,
    wheel_above,
)
from vehicledyn.rail.geometry.hertz import hertz
from vehicledyn.rail.profiles.profile_pieces import Floats

VIRTUAL_SHARE = 0.55
"""Share ε of the approach by which undeformed bodies overlap in the true patch [1]."""

_HALVINGS = 60
_SINKINGS = 40
_DEEPEST = 1e-3
_FEWEST = 3


@dataclass(frozen=True)
class Patch:
    """One elastic contact.

    ``place`` is the lateral coordinate on the wheel, (``x``, ``y``, ``z``) the point from the
    middle of the track, as in :class:`vehicledyn.rail.geometry.contact_geometry.GapMinima`,
    ``radius`` the rolling radius, ``approach`` the largest normal overlap [m]; ``angle`` the
    contact angle [rad]; ``curvature_x`` and ``curvature_y`` are the half sums A and B [1/m];
    ``force`` is normal [N], ``semi_axis_x`` and ``semi_axis_y`` are those of the ellipse [m].
    """

    place: float
    x: float
    y: float
    z: float
    radius: float
    angle: float
    approach: float
    curvature_x: float
    curvature_y: float
    force: float
    semi_axis_x: float
    semi_axis_y: float


def patches(wheel: MountedWheel, rail: Rail, pose: Pose, modulus: float) -> tuple[Patch, ...]:
    """Return the elastic contacts of a wheel with its rail, the deepest first.

    Parameters
    ----------
    wheel, rail
        The wheel and its rail.
    pose
        Place of the axle; its height decides how deep the wheel is.
    modulus
        E* of both bodies [N/m²].

    Returns
    -------
    tuple of Patch
        Empty for a lifted wheel.
    """
    outline = _outline(wheel, rail, pose)
    overlap, free, found = outline.overlap, outline.overlap > 0.0, []
    while free.any():
        deepest = int(np.argmax(np.where(free, overlap, -1.0)))
        level = (1.0 - VIRTUAL_SHARE) * overlap[deepest]
        part = _run((overlap > level) & free, deepest)
        free[_hill(overlap, part)] = False
        if part.stop - part.start >= _FEWEST:
            found.append(_patch(wheel, outline, part, deepest, modulus))
    return _beside_each_other(found, modulus)


def settled(
    wheel: MountedWheel, rail: Rail, pose: Pose, load: float, modulus: float
) -> tuple[float, tuple[Patch, ...]]:
    """Return the height of an axle at which its contacts carry a load, and the contacts.

    Only normal forces are counted, Σ N cos γ = load.

    Parameters
    ----------
    wheel, rail
        The wheel and its rail.
    pose
        Place of the axle; its height is not used.
    load
        Vertical force on the wheel, above zero [N].
    modulus
        E* of both bodies [N/m²].

    Raises
    ------
    InputError
        If the wheel is not above its rail, or the load presses it in by more than a millimetre.
    """
    gap, _ = lowest_gap(wheel, rail, pose)
    if np.isnan(gap):
        raise InputError("the wheel is not above its rail")
    high = pose.height - gap
    low = high - _DEEPEST
    if _carried(patches(wheel, rail, pose._replace(height=low), modulus)) < load:
        raise InputError(f"a load of {load:g} N presses the wheel into the rail by over 1 mm")
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if _carried(patches(wheel, rail, pose._replace(height=middle), modulus)) < load:
            high = middle
        else:
            low = middle
    return low, patches(wheel, rail, pose._replace(height=low), modulus)


def _beside_each_other(alone: list[Patch], modulus: float) -> tuple[Patch, ...]:
    """Return patches with what is left of their approaches, the deepest first."""
    if len(alone) < 2:
        return tuple(alone)
    place = np.array([(patch.y, patch.z) for patch in alone])
    apart = np.linalg.norm(place[:, None] - place[None], axis=2)
    np.fill_diagonal(apart, np.inf)
    whole = np.array([patch.approach for patch in alone])
    contacts = [hertz(patch.curvature_x, patch.curvature_y, modulus) for patch in alone]
    force = np.array([patch.force for patch in alone])
    left = whole
    for _ in range(_SINKINGS):
        left = np.maximum(whole - (force / apart).sum(axis=1) / (np.pi * modulus), 0.0)
        sunk = [float(contact.force(rest)) for contact, rest in zip(contacts, left, strict=True)]
        force = 0.5 * (force + np.array(sunk))
    found = []
    for patch, contact, rest in zip(alone, contacts, left, strict=True):
        if rest > 0.0:
            ellipse = contact.ellipse_at(rest)
            axes = float(ellipse.semi_axis_x), float(ellipse.semi_axis_y)
            found.append(
                replace(
                    patch, approach=float(rest), force=float(contact.force(rest)),
                    semi_axis_x=axes[0], semi_axis_y=axes[1],
                )
            )  # fmt: skip
    return tuple(sorted(found, key=lambda patch: -patch.approach))


def _carried(found: tuple[Patch, ...]) -> float:
    return float(sum(patch.force * np.cos(patch.angle) for patch in found))


class _Outline(NamedTuple):
    """A wheel over its rail: places on the wheel, outline, normal overlap, length and slope."""

    place: Floats
    seen: Silhouette
    overlap: Floats
    along: Floats
    slope: Floats


def _outline(wheel: MountedWheel, rail: Rail, pose: Pose) -> _Outline:
    scan = wheel_above(wheel, rail, pose)
    seen = silhouette(wheel, pose, *scan)
    surface, slope, _ = rail.surface.values(seen.y)
    known = np.isfinite(surface)
    seen = Silhouette(*(column[known] for column in seen))
    surface, slope = surface[known], slope[known]
    stretch = np.hypot(1.0, slope)
    steps = np.abs(np.diff(seen.y)) * 0.5 * (stretch[1:] + stretch[:-1])
    along = np.concatenate([[0.0], np.cumsum(steps)])
    return _Outline(scan[0][known], seen, (surface - seen.z) / stretch, along, slope)


def _run(true: NDArray[np.bool_], inside: int) -> slice:
    """Return the run of true values that holds a place."""
    false = np.flatnonzero(~true)
    before, after = false[false < inside], false[false > inside]
    return slice(
        int(before[-1]) + 1 if len(before) else 0, int(after[0]) if len(after) else len(true)
    )


def _hill(overlap: Floats, part: slice) -> slice:
    """Return a part with its flanks, down to the next valley on both sides."""
    first, last = part.start, part.stop - 1
    while first > 0 and overlap[first - 1] <= overlap[first]:
        first -= 1
    while last < len(overlap) - 1 and overlap[last + 1] <= overlap[last]:
        last += 1
    return slice(first, last + 1)


def _patch(
    wheel: MountedWheel, outline: _Outline, part: slice, deepest: int, modulus: float
) -> Patch:
    """Return the patch of a part of the outline, from its three moments."""
    approach = float(outline.overlap[deepest])
    weight = outline.overlap[part] - (1.0 - VIRTUAL_SHARE) * approach
    weight = weight * np.gradient(outline.along[part])
    along = outline.along[part]
    total = float(np.sum(weight))
    middle = float(np.sum(weight * along)) / total
    spread = float(np.sum(weight * (along - middle) ** 2))
    place, x, y, z, slope = (
        float(np.interp(middle, along, column[part]))
        for column in (outline.place, outline.seen.x, outline.seen.y, outline.seen.z, outline.slope)
    )
    angle = float(np.arctan(slope))
    radius = wheel.radius + float(wheel.table.height(np.array(place)))
    curvature_x = 0.5 * float(np.cos(angle)) / radius
    curvature_y = total * VIRTUAL_SHARE * approach / (5.0 * spread)
    contact = hertz(curvature_x, curvature_y, modulus)
    ellipse = contact.ellipse_at(approach)
    return Patch(
        place, x, y, z, radius, angle, approach, curvature_x, curvature_y,
        float(contact.force(approach)), float(ellipse.semi_axis_x), float(ellipse.semi_axis_y),
    )  # fmt: skip
