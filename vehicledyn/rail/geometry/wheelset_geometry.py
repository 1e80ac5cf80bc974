"""Contact geometry of a rigid wheelset on two rails: roll and height follow from the shift.

A wheelset that touches both rails has two places left, its lateral shift and its yaw. Height and
roll are those at which the lowest gap of each side is zero. The difference of the lowest gaps
grows steadily with the roll, so it has one zero.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.base.step_memory import Memory
from vehicledyn.rail.geometry.contact_geometry import (
    GapMinima,
    MountedWheel,
    Pose,
    Rail,
    lowest_gap,
    roll_rate,
    touching_points,
)

_LARGEST_ROLL = 0.2
_ROLL_ACCURACY = 1e-13
_SHIFT_ACCURACY = 1e-6
_JUMP = 2e-4
_COARSEST = 2.5e-4
_STEPS = 60
_CORRECTIONS = 6
_COARSE, _FINE = 1e-9, 1e-11


@dataclass(frozen=True)
class WheelsetOnTrack:
    """Two wheels on one axle and the rails below them; each as its own side sees it.

    ``memory`` knows how it stands at some shifts.
    """

    left_wheel: MountedWheel
    right_wheel: MountedWheel
    left_rail: Rail
    right_rail: Rail
    curvature: float = 0.0
    memory: Memory = field(default_factory=Memory, compare=False, repr=False)

    @property
    def is_symmetric(self) -> bool:
        """Whether both sides are mirror images of each other."""
        wheels, rails = (self.left_wheel, self.right_wheel), (self.left_rail, self.right_rail)
        return (
            wheels[0].profile is wheels[1].profile
            and wheels[0].radius == wheels[1].radius
            and wheels[0].half_distance == wheels[1].half_distance
            and rails[0].profile is rails[1].profile
            and rails[0].origin == rails[1].origin
        )


class WheelsetPosition(NamedTuple):
    """A wheelset that stands on both rails.

    ``lateral`` is positive to the left, ``yaw`` about the upward axis, ``roll`` positive when
    the left side is up [m, rad]; ``height`` is that of the middle of the axle over the highest
    points of the rails [m]. ``left`` and ``right`` hold the minima of the gap of each side.
    """

    lateral: float
    yaw: float
    roll: float
    height: float
    left: GapMinima
    right: GapMinima


class Jump(NamedTuple):
    """A lateral shift at which a contact jumps: side, and places on the wheel it joins [m]."""

    lateral: float
    side: str
    places: tuple[float, float]


def stand(wheelset: WheelsetOnTrack, lateral: float, yaw: float = 0.0) -> WheelsetPosition:
    """Return how a wheelset stands on both rails at a lateral shift and yaw.

    Parameters
    ----------
    wheelset
        Wheels and rails.
    lateral
        Shift to the left of the middle of the axle [m].
    yaw
        Angle about the upward axis [rad].

    Raises
    ------
    InputError
        If there is no roll at which both wheels are above their rails and touch them.
    """
    find = partial(_standing, wheelset, lateral, yaw)
    return wheelset.memory.recall_or_raise("stand", (lateral, yaw), find, InputError)


def _standing(wheelset: WheelsetOnTrack, lateral: float, yaw: float) -> WheelsetPosition:
    roll = _approximate_roll(wheelset, lateral, yaw)
    for _ in range(_CORRECTIONS):
        pose = Pose(lateral, 0.0, roll, yaw, wheelset.curvature)
        left, right = _touches(wheelset, pose)
        rest = float(left.gap[0] - right.gap[0])
        if abs(rest) < _FINE:
            break
        roll -= rest / (_rate_of(left, pose) + _rate_of(right, pose.mirrored()))
    height = -0.5 * float(left.gap[0] + right.gap[0])
    return WheelsetPosition(
        lateral,
        yaw,
        roll,
        height,
        left._replace(gap=left.gap + height, z=left.z + height),
        right._replace(gap=right.gap + height, z=right.z + height),
    )


def stand_level(wheelset: WheelsetOnTrack, lateral: float, yaw: float = 0.0) -> WheelsetPosition:
    """Return where the lowest gaps are while the wheelset is kept from rolling.

    Both wheels are lowered on their own, as EN 15302 does for the rolling radius difference;
    ``height`` is the mean of both sides.

    Raises
    ------
    InputError
        If a wheel is not above its rail.
    """
    left, right = _touches(wheelset, Pose(lateral, 0.0, 0.0, yaw, wheelset.curvature))
    for side, touch in (("left", left), ("right", right)):
        if len(touch.gap) == 0:
            raise InputError(f"{_at(lateral)} the {side} wheel is not above its rail")
    heights = [float(touch.gap[0]) for touch in (left, right)]
    return WheelsetPosition(
        lateral,
        yaw,
        0.0,
        -0.5 * (heights[0] + heights[1]),
        left._replace(gap=left.gap - heights[0], z=left.z - heights[0]),
        right._replace(gap=right.gap - heights[1], z=right.z - heights[1]),
    )


def find_jumps(wheelset: WheelsetOnTrack, standing: Sequence[WheelsetPosition]) -> list[Jump]:
    """Return the shifts, between those given, at which a contact leaps to another place.

    Halving the interval, down to a micrometre, distinguishes a jump from a fast but steady
    motion, which then agrees with the rates at both ends.
    """
    known = {position.lateral: position for position in standing}

    def between(before: WheelsetPosition, after: WheelsetPosition) -> WheelsetPosition:
        lateral = 0.5 * (before.lateral + after.lateral)
        if lateral not in known:
            known[lateral] = stand(wheelset, lateral, before.yaw)
        return known[lateral]

    jumps = []
    for before, after in pairwise(standing):
        for side in ("left", "right"):
            jumps += _jumps_between(wheelset, before, after, side, between)
    return sorted(jumps)


def mirrored(standing: WheelsetPosition) -> WheelsetPosition:
    """Return how a symmetric wheelset without yaw stands at the opposite shift."""
    return WheelsetPosition(
        -standing.lateral,
        -standing.yaw,
        -standing.roll,
        standing.height,
        standing.right,
        standing.left,
    )


def _jumps_between(
    wheelset: WheelsetOnTrack,
    before: WheelsetPosition,
    after: WheelsetPosition,
    side: str,
    between: Callable[[WheelsetPosition, WheelsetPosition], WheelsetPosition],
) -> list[Jump]:
    step = after.lateral - before.lateral
    first, last = _place(before, side), _place(after, side)
    if abs(last - first) < _JUMP:
        return []
    if step <= _SHIFT_ACCURACY:
        return [Jump(0.5 * (before.lateral + after.lateral), side, (first, last))]
    if step <= _COARSEST:
        rates = [_rate(wheelset, standing, side) for standing in (before, after)]
        expected = 0.5 * step * (rates[0] + rates[1])
        if abs(last - first - expected) < 0.25 * abs(expected) + 0.5 * _JUMP:
            return []
    middle = between(before, after)
    return [
        *_jumps_between(wheelset, before, middle, side, between),
        *_jumps_between(wheelset, middle, after, side, between),
    ]


def _rate(wheelset: WheelsetOnTrack, standing: WheelsetPosition, side: str) -> float:
    """Return how fast the contact moves over the wheel as the wheelset shifts to the left [1].

    Both slopes stay equal: z_w'' ds = z_r'' (ds + dy), roll and yaw left out.
    """
    outwards = 1.0 if side == "left" else -1.0
    wheel = wheelset.left_wheel if side == "left" else wheelset.right_wheel
    rail = wheelset.left_rail if side == "left" else wheelset.right_rail
    touch: GapMinima = getattr(standing, side)
    of_wheel = -float(wheel.table.values(touch.place[:1])[2][0])
    of_rail = float(rail.surface.values(touch.y[:1])[2][0])
    return outwards * of_rail / (of_wheel - of_rail) if of_wheel != of_rail else np.inf


def _place(standing: WheelsetPosition, side: str) -> float:
    return float(getattr(standing, side).place[0])


def _touches(wheelset: WheelsetOnTrack, pose: Pose) -> tuple[GapMinima, GapMinima]:
    return (
        touching_points(wheelset.left_wheel, wheelset.left_rail, pose),
        touching_points(wheelset.right_wheel, wheelset.right_rail, pose.mirrored()),
    )


def _approximate_roll(wheelset: WheelsetOnTrack, lateral: float, yaw: float) -> float:
    """Return the roll at which both sides have the same lowest gap, by Newton's method.

    Where contact leaps as the wheelset rolls, the rate leaps too; should that lead astray, the
    interval that holds the zero is halved.
    """
    low, high = -_LARGEST_ROLL, _LARGEST_ROLL
    roll = 0.0
    for _ in range(_STEPS):
        rest, rate = _difference(wheelset, lateral, yaw, roll)
        if abs(rest) < _COARSE:
            return roll
        low, high = (low, roll) if rest > 0.0 else (roll, high)
        wanted = roll - rest / rate
        roll = wanted if low < wanted < high else 0.5 * (low + high)
        if high - low < _ROLL_ACCURACY:
            break
    if min(roll + _LARGEST_ROLL, _LARGEST_ROLL - roll) < 1e-6:
        raise InputError(f"{_at(lateral)} the wheelset falls over: its roll exceeds 0.2 rad")
    return roll


def _rate_of(touch: GapMinima, pose: Pose) -> float:
    return roll_rate(pose, float(touch.y[0]), float(touch.z[0]), float(touch.slope[0]))


def _difference(
    wheelset: WheelsetOnTrack, lateral: float, yaw: float, roll: float
) -> tuple[float, float]:
    """Return the difference of the lowest gaps of both sides, and its rate with the roll [m]."""
    pose = Pose(lateral, 0.0, roll, yaw, wheelset.curvature)
    left = lowest_gap(wheelset.left_wheel, wheelset.left_rail, pose)
    right = lowest_gap(wheelset.right_wheel, wheelset.right_rail, pose.mirrored())
    for side, found in (("left", left), ("right", right)):
        if np.isnan(found[0]):
            raise InputError(f"{_at(lateral)} the {side} wheel is not above its rail")
    return left[0] - right[0], left[1] + right[1]


def _at(lateral: float) -> str:
    return f"at a lateral shift of {1e3 * lateral:.3f} mm"
