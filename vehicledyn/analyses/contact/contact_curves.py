"""Contact at close shifts: where it jumps, and curves for pictures that end there."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.rail.geometry.gauge_fit import climbed_side
from vehicledyn.rail.geometry.wheelset_geometry import (
    Jump,
    WheelsetOnTrack,
    WheelsetPosition,
    find_jumps,
    mirrored,
    stand,
)
from vehicledyn.rail.profiles.profile_pieces import Floats
from vehicledyn.results.tables.contact_table import SIDES, ContactCurves

_STEP = 1e-4  # m, the distance of close shifts and amplitudes
_MOST = 400
_BESIDE = 1e-6  # m, of shifts on both sides of a jump
_FAR, _STEEP = 5e-4, 0.02  # m and rad from one place of a curve to the next
_HALVINGS = 7


def standings(
    wheelset: WheelsetOnTrack, shifts: Iterable[float], yaw: float
) -> tuple[list[WheelsetPosition], list[str]]:
    """Return how the wheelset stands at each shift it can stand at, and what is said of others.

    Raises
    ------
    InputError
        If it can stand at none.
    """
    known: dict[float, WheelsetPosition] = {}
    found, lost = [], []
    for shift in shifts:
        try:
            position = known.get(-shift) or stand(wheelset, shift, yaw)
        except InputError as error:
            lost.append(str(error))
            continue
        found.append(mirrored(position) if -shift in known else position)
        side = climbed_side(wheelset, shift)
        if side is not None:
            lost.append(
                f"at a lateral shift of {1e3 * shift:.3f} mm the {side} flange has climbed its "
                "rail: the wheelset derails"
            )
        if _is_symmetric(wheelset, yaw):
            known[shift] = position
    if not found:
        raise InputError(lost[0])
    return found, lost


def close_standings(
    wheelset: WheelsetOnTrack, asked: Sequence[WheelsetPosition]
) -> tuple[list[WheelsetPosition], list[Jump]]:
    """Return how the wheelset stands from the first to the last shift asked, closely, and jumps.

    Each jump has a shift close before and one close behind it.
    """
    first, last, yaw = asked[0].lateral, asked[-1].lateral, asked[0].yaw
    known = {position.lateral: position for position in asked}
    count = min(int(np.ceil((last - first) / _STEP - 1e-9)), _MOST)
    grid = np.linspace(first, last, count + 1).tolist() if count else [first]
    near = np.array(sorted(known))
    wanted = [shift for shift in grid if np.abs(near - shift).min() > _BESIDE]
    if wanted:
        known |= {s.lateral: s for s in standings(wheelset, _by_distance(wanted), yaw)[0]}
    jumps = _jumps(wheelset, [known[shift] for shift in sorted(known)])
    more = {j.lateral + d for j in jumps for d in (-_BESIDE, _BESIDE)} - known.keys()
    for _ in range(_HALVINGS + 1):
        if more:
            known |= {s.lateral: s for s in standings(wheelset, _by_distance(more), yaw)[0]}
        more = _halves([known[shift] for shift in sorted(known)], jumps)
    return [known[shift] for shift in sorted(known)], jumps


def _halves(standing: Sequence[WheelsetPosition], jumps: Sequence[Jump]) -> set[float]:
    """Return shifts midway where a contact goes far, or turns much, without a jump."""
    halves = set()
    for before, after in pairwise(standing):
        for side in SIDES:
            first, last = getattr(before, side), getattr(after, side)
            far = abs(last.place[0] - first.place[0]) > _FAR
            steep = abs(np.arctan(last.slope[0]) - np.arctan(first.slope[0])) > _STEEP
            leaps = any(
                j.side == side and before.lateral < j.lateral < after.lateral for j in jumps
            )
            if (far or steep) and not leaps and after.lateral - before.lateral > 2.0 * _BESIDE:
                halves.add(0.5 * (before.lateral + after.lateral))
    return halves


def curves(
    wheelset: WheelsetOnTrack,
    standing: Sequence[WheelsetPosition],
    amplitudes: Floats,
    conicities: dict[str, Floats],
) -> ContactCurves:
    """Return what pictures draw against shift and amplitude."""
    place = np.array([[getattr(s, side).place[0] for side in SIDES] for s in standing])
    slope = np.array([[getattr(s, side).slope[0] for side in SIDES] for s in standing])
    left, right = wheelset.left_wheel, wheelset.right_wheel
    radii = [w.radius + w.table.height(place[:, k]) for k, w in enumerate((left, right))]
    return ContactCurves(
        shift=np.array([s.lateral for s in standing]),
        place=place,
        angle=np.arctan(slope),
        radius_difference=radii[0] - radii[1],
        amplitude=amplitudes,
        conicity=conicities["conicity"],
        conicity_with_roll=conicities["conicity_with_roll"],
    )


def amplitude_grid(asked: Floats) -> Floats:
    """Return close amplitudes from the smallest to the largest asked, shape (n,) [m]."""
    if len(asked) < 2:
        return asked
    low, high = float(asked.min()), float(asked.max())
    return np.linspace(low, high, min(int(np.ceil((high - low) / _STEP - 1e-9)), _MOST) + 1)


def _by_distance(shifts: Iterable[float]) -> list[float]:
    """Return shifts by their distance from none, so that mirror images follow each other."""
    return sorted(shifts, key=abs)


def _jumps(wheelset: WheelsetOnTrack, standing: list[WheelsetPosition]) -> list[Jump]:
    """Return the jumps; those of a symmetric wheelset are looked for on one side only."""
    if not _is_symmetric(wheelset, standing[0].yaw):
        return find_jumps(wheelset, standing)
    by_shift = {abs(s.lateral): mirrored(s) if s.lateral < 0.0 else s for s in standing}
    if standing[0].lateral < 0.0 < standing[-1].lateral:
        by_shift.setdefault(0.0, stand(wheelset, 0.0))
    positive = find_jumps(wheelset, [by_shift[shift] for shift in sorted(by_shift)])
    other = {"left": "right", "right": "left"}
    negative = [Jump(-jump.lateral, other[jump.side], jump.places[::-1]) for jump in positive]
    return sorted(
        jump
        for jump in (*positive, *negative)
        if standing[0].lateral <= jump.lateral <= standing[-1].lateral
    )


def _is_symmetric(wheelset: WheelsetOnTrack, yaw: float) -> bool:
    return wheelset.is_symmetric and yaw == 0.0 and wheelset.curvature == 0.0
