"""Places on a wheel at which compiled equations look for contact, and their windows.

Places lie densely where contacts are sharp, where profiles come near to each other at a small
radius, and where one window passes into the next. Half way between two of them the overlap is
taken from its neighbours, which costs less than a place of its own.

A window holds the places of one possible contact. Two contacts of rigid profiles at (almost) the
same shift, between which the profiles are more than ``LEAST_BARRIER`` apart, can carry at once when
they are elastic: a window ends at the highest point between. What profiles bridge more closely is
one contact to an elastic wheel. Contacts with an angle of attack jump elsewhere: in a curve the
windows are those of all angles that wheels can have there. Two contacts in one window would pull
as one between them, in a direction of its own; such forces have no potential and feed vibrations.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.base.errors import InputError
from vehicledyn.rail.contact.contact_identity import identity_of
from vehicledyn.rail.geometry.contact_geometry import (
    MountedWheel,
    Pose,
    Rail,
    silhouette,
    wheel_above,
)
from vehicledyn.rail.profiles.profile_pieces import Floats

LEAST_BARRIER = 1e-5
"""Normal distance between two contacts above which they are windows of their own [m]."""

LEVER = 2.0
"""Least distance counted with of a wheel from where its vehicle is along the track [m]."""

FINEST, COARSEST = 5.5e-4, 2.5e-3
"""Bounds of the distance of places along the profile [m]."""

_APPROACH = 4e-5
_PLACES_A_CONTACT = 3.0
_REACH, _SHIFT_STEP = 0.025, 1e-4
_YAW_STEP, _LARGEST_YAW = 0.015, 0.09
_SAMPLE = 1e-4
_MARGIN, _BEYOND_TIP = 5e-3, 1e-3
_NEAR = 6e-5
_APART = 5e-3
_RAMP = 2.5e-3
_BESIDE_BORDER, _AT_BORDER, _GROWTH = 2.5e-3, 7e-4, 0.2
_BLUR = 1.5e-3
_LEAST_BEND = 1e-3
_HALF_WIDTH = 5e-4
_OF_RADIUS = 0.05


@dataclass(frozen=True)
class WheelGrid:
    """Places on the profile of a wheel, from the flange to the field side.

    Attributes
    ----------
    place, height, slope
        Lateral coordinate y, height z and dz/dy of the profile, shape (n,) [m, m, 1].
    along
        Length along the profile, zero at the first place, of the places and of the points half
        way between, shape (2 n - 1,) [m].
    width
        Length that each of these stands for, shape (2 n - 1,) [m].
    shares
        Part of each of these that belongs to each window, from the flange to the field side,
        shape (n_windows, 2 n - 1); the sum over the windows is 1.
    attack
        Largest angle of attack that the windows count with [rad].
    """

    place: Floats
    height: Floats
    slope: Floats
    along: Floats
    width: Floats
    shares: Floats
    attack: float = 0.0

    @property
    def middles(self) -> Floats:
        """Length along the profile in the middle of each window, shape (n_windows,) [m]."""
        weights = self.shares * self.width
        return np.asarray(weights @ self.along / weights.sum(axis=1))


class _Rolled(NamedTuple):
    """What a wheel without yaw and roll does on its rail: where it can be, and how closely.

    ``place`` holds where profiles come near to each other at some shift, ``bend`` the largest half
    sum of curvatures there, ``contacts`` the rigid contacts at rising shifts, ``barriers`` the
    places between contacts that jump.
    """

    place: Floats
    bend: Floats
    contacts: Floats
    barriers: tuple[float, ...]


_ROLLED: BoundedCache[str, _Rolled] = BoundedCache(32)
_YAWED: BoundedCache[tuple[str, float], list[float]] = BoundedCache(256)


def largest_attack(curvature: float, nearest: float = 0.0) -> float:
    """Return the angle of attack that wheels may have in a curve [rad].

    Axles stand square to their vehicle: a wheel has the angle at which the track turns from where
    the vehicle is tangential to it up to the wheel. That is a wheelbase away at most, where the
    rear axle stands radially; of two axles, the nearest other one gives it.

    Parameters
    ----------
    curvature
        Largest one of the track [1/m].
    nearest
        Distance of the nearest other axle [m].
    """
    return max(LEVER, nearest) * curvature


def wheel_grid(wheel: MountedWheel, rail: Rail, attack: float = 0.0) -> WheelGrid:
    """Return the places of a wheel that can meet a rail, near enough to each other for contacts.

    Parameters
    ----------
    wheel, rail
        The wheel and its rail.
    attack
        Largest angle of attack to count with; windows are those of all angles up to it [rad].

    Raises
    ------
    InputError
        If the wheel is above its rail at no lateral shift.
    """
    rolled = _rolled(wheel, rail)
    barriers = _borders(wheel, rail, rolled, attack)
    table = wheel.table
    tip = float(wheel.scan[0][np.argmax(wheel.scan[1])])
    first = max(table.begin, min(float(rolled.contacts.min()) - _MARGIN, tip - _BEYOND_TIP))
    last = min(table.end, float(rolled.contacts.max()) + _MARGIN)
    fine = np.linspace(first, last, int(np.ceil((last - first) / (0.1 * _SAMPLE))) + 1)
    height, _, _ = table.values(fine)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(fine), np.diff(height)))])
    number = _numbers(along, _distances(wheel, rolled, barriers, fine, along))
    count = int(np.ceil(number[-1]))
    number *= count / number[-1]
    place = np.interp(np.arange(count + 1.0), number, fine)
    z, slope, _ = table.values(place)
    lengths = np.interp(0.5 * np.arange(2 * count + 1), number, along)
    borders = np.interp(barriers, fine, along)
    shares = _shares(lengths, borders)
    return WheelGrid(place, z, slope, lengths, np.gradient(lengths), shares, attack)


def count_windows(wheel: MountedWheel, rail: Rail, attack: float) -> int:
    """Return how many windows the grid of a wheel has for an angle of attack [rad]."""
    return 1 + len(_borders(wheel, rail, _rolled(wheel, rail), attack))


def _rolled(wheel: MountedWheel, rail: Rail) -> _Rolled:
    """Return where a wheel without roll touches its rail, from far in to far out."""
    return _ROLLED.get(identity_of(wheel, rail), lambda: _roll(wheel, rail))


def _roll(wheel: MountedWheel, rail: Rail) -> _Rolled:
    y, z, slope = wheel.scan
    stretch = np.hypot(1.0, slope)
    contacts: list[int] = []
    bends = np.zeros_like(y)
    barriers: list[float] = []
    for shift in np.arange(-_REACH, _REACH, _SHIFT_STEP):
        gap = -z - rail.surface.height(wheel.half_distance + shift + y)
        if np.isnan(gap).all():
            continue
        k = int(np.nanargmin(gap))
        normal = np.where(np.isnan(gap), 1.0, (gap - gap[k]) / stretch)
        contacts.append(k)
        near = np.flatnonzero(normal < _NEAR)
        bends[near] = np.maximum(bends[near], _bends(y, normal, stretch, near))
        barriers += [float(y[top]) for top in _barriers(normal)]
    if not contacts:
        raise InputError("the wheel is not above its rail at any lateral shift")
    met = np.flatnonzero(bends)
    return _Rolled(y[met], bends[met], y[contacts], tuple(barriers))


def _borders(wheel: MountedWheel, rail: Rail, rolled: _Rolled, attack: float) -> tuple[float, ...]:
    """Return where windows end, for all angles of attack up to one."""
    barriers = list(rolled.barriers)
    largest = min(attack, _LARGEST_YAW)
    steps = np.arange(_YAW_STEP, largest + 1e-9, _YAW_STEP)
    own = identity_of(wheel, rail)
    for yaw in np.union1d(steps, [largest] if largest > 0.0 else []).tolist():
        barriers += _YAWED.get((own, yaw), partial(_barriers_at, wheel, rail, yaw))
    return _gathered(barriers)


def _barriers_at(wheel: MountedWheel, rail: Rail, yaw: float) -> list[float]:
    """Return where barriers are on a wheel with an angle of attack."""
    found = []
    for shift in np.arange(-_REACH, _REACH, 2.0 * _SHIFT_STEP):
        pose = Pose(shift, wheel.radius, 0.0, yaw)
        y, z, slope = wheel_above(wheel, rail, pose)
        seen = silhouette(wheel, pose, y, z, slope)
        gap = seen.z - rail.surface.height(seen.y)
        if np.isnan(gap).all():
            continue
        normal = (gap - np.nanmin(gap)) / np.hypot(1.0, slope)
        normal = np.where(np.isnan(normal), 1.0, normal)
        found += [float(y[top]) for top in _barriers(normal)]
    return found


def _barriers(normal: Floats) -> list[int]:
    """Return the highest places between neighbouring minima that are low and far apart enough."""
    inner = normal[1:-1]
    lower = (inner < normal[:-2]) & (inner <= normal[2:]) & (inner < _NEAR)
    minima = 1 + np.flatnonzero(lower)
    found = []
    for low, high in itertools.pairwise(minima):
        top = int(low + np.argmax(normal[low : high + 1]))
        if normal[top] - max(normal[low], normal[high]) > LEAST_BARRIER:
            found.append(top)
    return found


def _gathered(barriers: list[float]) -> tuple[float, ...]:
    """Return the middle of each group of barriers; groups are some millimetres apart."""
    if not barriers:
        return ()
    ordered = np.sort(barriers)
    groups = np.split(ordered, 1 + np.flatnonzero(np.diff(ordered) > _APART))
    return tuple(float(np.median(group)) for group in groups)


def _bends(y: Floats, normal: Floats, stretch: Floats, places: NDArray[np.intp]) -> Floats:
    """Return half sums of curvatures, of either sign, over a quarter of a millimetre both ways."""
    step = np.maximum(1, np.round(_HALF_WIDTH / ((y[1] - y[0]) * stretch[places])).astype(int))
    before, after = places - step, places + step
    inner = (before >= 0) & (after < len(y))
    before, after = np.where(inner, before, places), np.where(inner, after, places)
    length = step * (y[1] - y[0]) * stretch[places]
    bend = 0.5 * (normal[after] - 2.0 * normal[places] + normal[before]) / length**2
    return np.where(inner, np.maximum(np.abs(bend), _LEAST_BEND), _LEAST_BEND)


def _distances(
    wheel: MountedWheel, rolled: _Rolled, barriers: tuple[float, ...], fine: Floats, along: Floats
) -> Floats:
    """Return the distance that places may have [m].

    It is a part of the width of contacts there, and of the radius of the wheel's profile: beside a
    contact that jumps, an elastic one reaches where no rigid one is.
    """
    wanted = np.sqrt(_APPROACH / rolled.bend) * 2.0 / _PLACES_A_CONTACT
    _, slope, bend = wheel.table.values(fine)
    radius = (1.0 + slope**2) ** 1.5 / np.maximum(np.abs(bend), _LEAST_BEND)
    narrow = np.minimum(np.interp(fine, rolled.place, wanted), _OF_RADIUS * radius)
    for border in np.interp(barriers, fine, along):
        beyond = np.maximum(np.abs(along - border) - _BESIDE_BORDER, 0.0)
        narrow = np.minimum(narrow, _AT_BORDER + _GROWTH * beyond)
    coarse = np.log(np.clip(narrow, FINEST, COARSEST))
    # Blurred along the profile, so that neighbours differ little.
    even = np.arange(0.0, along[-1], _SAMPLE)
    half = round(_BLUR / _SAMPLE)
    padded = np.pad(np.interp(even, along, coarse), 2 * half, mode="edge")
    kernel = np.exp(-0.5 * (np.arange(-2 * half, 2 * half + 1) / half) ** 2)
    blurred = np.convolve(padded, kernel / kernel.sum(), mode="valid")
    return np.asarray(np.exp(np.interp(along, even, blurred)))


def _numbers(along: Floats, distances: Floats) -> Floats:
    """Return the number of a place as a function of the length, ∫ dl / distance [1]."""
    density = 1.0 / distances
    steps = 0.5 * (density[1:] + density[:-1]) * np.diff(along)
    return np.concatenate([[0.0], np.cumsum(steps)])


def _shares(along: Floats, borders: Floats) -> Floats:
    """Return the part of each point in each window; neighbours share a few millimetres."""
    ramps = [np.ones_like(along)]
    for border in borders:
        u = np.clip(0.5 + 0.5 * (along - border) / _RAMP, 0.0, 1.0)
        ramps.append(u * u * (3.0 - 2.0 * u))
    ramps.append(np.zeros_like(along))
    return np.array([a - b for a, b in itertools.pairwise(ramps)])
